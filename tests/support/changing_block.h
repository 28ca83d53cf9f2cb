/* Settings with a block whose kind changes with their number: for tests of what storage makes of them. */
#ifndef REFLUX_TESTS_CHANGING_BLOCK_H
#define REFLUX_TESTS_CHANGING_BLOCK_H

#include "storage_bench.h"

static const struct block_kind wide_kind, narrow_kind;
#define MADE_UP_KINDS_TOO &wide_kind, &narrow_kind
#include "made_up_kinds.h"

/* Two kinds that share ids, as different things, and none, in turn; in each the number of the settings. */
struct wide_settings {
    float table[2][2];
    uint16_t last;
};
struct narrow_settings {
    float last;
};
static const struct block_parameter wide_parameters[] = {
    {1, BLOCK_FLOAT, 0, 2, 2, "table", "-", "", 0, 1e6f, 0},
    {2, BLOCK_U16, offsetof(struct wide_settings, last), 1, 1, "last", "-", "", 0, 65535, 0},
};
static const struct block_parameter narrow_parameters[] = {
    {1, BLOCK_FLOAT, 0, 1, 1, "last", "-", "", 0, 1e6f, 0},
};
static const struct block_kind wide_kind = {
    .name = "wide",
    .stage = STAGE_ESTIMATE,
    .parameter = wide_parameters,
    .parameters = 2,
    .settings_bytes = sizeof(struct wide_settings),
    .bytes = made_up_bytes,
    .check = made_up_check,
    .configure = made_up_configure,
    .step = made_up_rest,
};
static const struct block_kind narrow_kind = {
    .name = "narrow",
    .stage = STAGE_ESTIMATE,
    .parameter = narrow_parameters,
    .parameters = 1,
    .settings_bytes = sizeof(struct narrow_settings),
    .bytes = made_up_bytes,
    .check = made_up_check,
    .configure = made_up_configure,
    .step = made_up_rest,
};

static void block_of(struct config *c, uint32_t number)
{
    char text[40];
    snprintf(text, sizeof text, "%u,%u", (unsigned)number, (unsigned)number + 1u);
    if (number % 3 == 2)
        return;
    bench_set(c, "block2.kind", number % 3 ? "wide" : "narrow");
    if (number % 3) {
        bench_set(c, "block2.table.2", text);
        bench_set(c, "block2.table.1", text);
    }
    *strchr(text, ',') = '\0';
    bench_set(c, "block2.last", text);
}
#endif

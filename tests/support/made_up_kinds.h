/* Kinds of blocks that no product has, beside those of the firmware: for tests of their settings. Included in one file of a
 * test, it stands in for app/kinds.c. */
#ifndef REFLUX_TESTS_MADE_UP_KINDS_H
#define REFLUX_TESTS_MADE_UP_KINDS_H

#include <string.h>

#include "block/block.h"
#include "kinds/decoupler/decoupler.h"
#include "kinds/feedforward/feedforward.h"
#include "kinds/pid/pid.h"
#include "kinds/two_position/two_position.h"

struct gmv_settings {
    float lambda;
    float table[3][3];
    uint16_t order;
    uint8_t adapt;
};

struct column_settings {
    float stage[48][8];
};

struct weights_settings {
    uint16_t order[2][3];
    uint8_t signs[4];
};

struct made_up_state {
    float gain;
};

static const struct block_parameter gmv_parameters[] = {
    {1, BLOCK_FLOAT, offsetof(struct gmv_settings, lambda), 1, 1, "lambda", "fraction",
     "weight of the moves", 0.0f, 10.0f, 0.1f},
    {2, BLOCK_FLOAT, offsetof(struct gmv_settings, table), 3, 3, "table", "-", "a matrix", -1e3f,
     1e3f, 0.0f},
    {3, BLOCK_U16, offsetof(struct gmv_settings, order), 0, 0, "order", "-", "of the model", 1, 8,
     2},
    {4, BLOCK_WORD, offsetof(struct gmv_settings, adapt), 1, 1, "adapt", "off|on",
     "whether it learns", 0, 0, 1},
};

static const struct block_parameter column_parameters[] = {
    {1, BLOCK_FLOAT, 0, 48, 8, "stage", "-", "what is known of a stage", -1e6f, 1e6f, 0.0f},
};

/* Some ids are those of the first kind, for something else. */
static const struct block_parameter weights_parameters[] = {
    {2, BLOCK_U16, offsetof(struct weights_settings, order), 2, 3, "order", "-", "of each", 0, 8,
     2},
    {3, BLOCK_WORD, offsetof(struct weights_settings, signs), 1, 4, "signs", "minus|plus",
     "of each", 0, 0, 1},
};

static uint32_t made_up_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct made_up_state);
}

static enum err made_up_check(const struct block_setup *setup, struct block_fault *fault)
{
    (void)setup;
    (void)fault;
    return ERR_OK;
}

/* A table that was pasted by half has rows of nothing. */
static enum err gmv_check(const struct block_setup *setup, struct block_fault *fault)
{
    const struct gmv_settings *s = setup->settings;
    for (unsigned i = 0; i < 3; i++) {
        if (s->table[i][i] == 0.0f) {
            *fault = (struct block_fault){.field = "table",
                                          .wanted = "a matrix whose diagonal has no 0"};
            return ERR_RANGE;
        }
    }
    return ERR_OK;
}

static enum err made_up_configure(void *state, const struct block_setup *setup, bool retune)
{
    (void)setup;
    (void)retune;
    *(struct made_up_state *)state = (struct made_up_state){.gain = 1.0f};
    return ERR_OK;
}

static void made_up_rest(void *state, struct block_io *io)
{
    (void)state;
    (void)io;
}

#define MADE_UP_KIND(title, rows, type, checks) MADE_UP_KIND_OF(title, rows, type, checks, 2)
#define MADE_UP_KIND_OF(title, rows, type, checks, most)                                           \
    {                                                                                              \
        .name = title, .stage = STAGE_CONTROL, .parameter = (rows),                                \
        .parameters = sizeof(rows) / sizeof((rows)[0]),                                            \
        .settings_bytes = (sizeof(type) + 3) / 4 * 4, .members_most = (most), .inputs_most = 2,    \
        .points_most = 2, .bytes = made_up_bytes, .check = (checks),                               \
        .configure = made_up_configure, .step = made_up_rest, .back_calculate = made_up_rest,      \
        .follow = made_up_rest, .shift = made_up_rest                                              \
    }

static const struct block_kind gmv_kind =
    MADE_UP_KIND("gmv", gmv_parameters, struct gmv_settings, gmv_check);
static const struct block_kind column_kind =
    MADE_UP_KIND("column", column_parameters, struct column_settings, made_up_check);
static const struct block_kind weights_kind =
    MADE_UP_KIND_OF("weights", weights_parameters, struct weights_settings, made_up_check, 3);

const struct block_kind *const block_kinds[] = {
    &pid_kind,         &two_position_kind, &decoupler_kind, &feedforward_kind,
    &gmv_kind,         &column_kind,       &weights_kind,
#ifdef MADE_UP_KINDS_TOO /* more of them */
    MADE_UP_KINDS_TOO,
#endif
};
const uint8_t block_kind_count = sizeof block_kinds / sizeof block_kinds[0];

#endif

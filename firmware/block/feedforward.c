#include "block/feedforward.h"

#include <string.h>

#include "signal/check.h"

struct feedforward_settings feedforward_default_config(void)
{
    return (struct feedforward_settings){.out_lo = -1.0f, .out_hi = 1.0f};
}

#define AT(field) (uint8_t) offsetof(struct feedforward_settings, field)

static const struct {
    const char *field, *wanted;
    float lo, hi;
    /* Offset of a float in struct feedforward_settings. */
    uint8_t offset;
} ranges[] = {
    {"gain", "-100 to 100", -100.0f, 100.0f, AT(gain)},
    {"lead", "0 to 1e6 s", 0.0f, 1e6f, AT(lead_s)},
    {"lag", "0 to 1e6 s", 0.0f, 1e6f, AT(lag_s)},
    {"dead", "0 to 1e6 s", 0.0f, 1e6f, AT(dead_time_s)},
    {"reference", "-1 to 2", -1.0f, 2.0f, AT(reference)},
    {"lo", "-2 to 2", -2.0f, 2.0f, AT(out_lo)},
    {"hi", "-2 to 2", -2.0f, 2.0f, AT(out_hi)},
};

enum err feedforward_validate(const struct feedforward_settings *config, float h_s,
                              const char **field, const char **wanted)
{
    const char *unused;
    field = field ? field : &unused;
    wanted = wanted ? wanted : &unused;
    *field = "";
    *wanted = "0.001 to 1e5 s";
    enum err of_interval = check_interval(h_s);
    if (of_interval)
        return of_interval;
    for (size_t i = 0; i < sizeof(ranges) / sizeof(ranges[0]); i++) {
        *field = ranges[i].field;
        *wanted = ranges[i].wanted;
        float value;
        memcpy(&value, (const uint8_t *)config + ranges[i].offset, sizeof value);
        enum err err = check_range(value, ranges[i].lo, ranges[i].hi);
        if (err)
            return err;
    }
    *field = "lead";
    *wanted = "at most 100 times (lag_s + step interval)";
    if (config->lead_s / (config->lag_s + h_s) > LEAD_LAG_MAX_RATIO)
        return ERR_RANGE;
    *field = "dead";
    *wanted = "at most 100000 step intervals";
    if (dead_time_bytes(config->dead_time_s, h_s) == 0)
        return ERR_RANGE;
    *field = "hi";
    *wanted = "above out_lo, to 2";
    return num_lt(num_from_float(config->out_lo), num_from_float(config->out_hi)) ? ERR_OK
                                                                                  : ERR_RANGE;
}

size_t feedforward_bytes(const struct feedforward_settings *config, float h_s)
{
    if (feedforward_validate(config, h_s, NULL, NULL))
        return 0;
    return dead_time_bytes(config->dead_time_s, h_s);
}

enum err feedforward_init(struct feedforward *ff, const struct feedforward_settings *config,
                          float h_s, num_t *ring, size_t bytes)
{
    enum err err = feedforward_validate(config, h_s, NULL, NULL);
    if (err)
        return err;
    struct feedforward made = {
        .gain = coefficient_from_float(config->gain),
        .reference = num_from_float(config->reference),
        .lo = num_from_float(config->out_lo),
        .hi = num_from_float(config->out_hi),
    };
    err = dead_time_init(&made.delay, config->dead_time_s, h_s, ring, bytes);
    if (err)
        return err;
    err = lead_lag_init(&made.shape, config->lead_s, config->lag_s, h_s);
    if (err)
        return err;
    *ff = made;
    feedforward_reset(ff, ff->reference);
    return ERR_OK;
}

enum err feedforward_retune(struct feedforward *ff, const struct feedforward_settings *config,
                            float h_s)
{
    enum err err = lead_lag_retune(&ff->shape, config->lead_s, config->lag_s, h_s);
    if (err)
        return err;
    ff->gain = coefficient_from_float(config->gain);
    return ERR_OK;
}

num_t *feedforward_place_ring(struct feedforward *ff, num_t *ring)
{
    return dead_time_place(&ff->delay, ring);
}

num_t feedforward_output(const struct feedforward *ff)
{
    return ff->output;
}

/* The gain comes last, because shaping the disturbance and not the product keeps its resolution when the gain is
 * small. */
static num_t amplified(const struct feedforward *ff, num_t shaped)
{
    struct accumulator u = {0};
    accumulator_add_product(&u, ff->gain, shaped);
    return num_clamp(accumulator_get(&u), ff->lo, ff->hi);
}

void feedforward_reset(struct feedforward *ff, num_t d)
{
    num_t deviation = num_sub(d, ff->reference);
    dead_time_reset(&ff->delay, deviation);
    lead_lag_reset(&ff->shape, deviation);
    ff->output = amplified(ff, deviation);
}

num_t feedforward_step(struct feedforward *ff, num_t d)
{
    num_t delayed = dead_time_step(&ff->delay, num_sub(d, ff->reference));
    ff->output = amplified(ff, lead_lag_step(&ff->shape, delayed));
    return ff->output;
}

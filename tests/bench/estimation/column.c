#include "column.h"

#include <string.h>

#include "splitter.h"

/* 10 to the hour, critically damped. */
#define LAMBDA  (10.0f / 3600.0f)
#define NOISE_K 0.1f

static struct composition truth;
static real_t profile[COLUMN_STATES_MAX];
static struct column_inputs inputs;
static uint32_t seed;

static real_t moving(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (real_t)(int32_t)seed / 2147483648.0f;
}

/* From the 37 stages of the table to any number, on straight lines. */
static void stretch(const float *from, size_t stages)
{
    for (size_t s = 0; s < stages; s++) {
        real_t at = (real_t)s * (real_t)(SPLITTER_STAGES - 1) / (real_t)(stages - 1);
        size_t low = (size_t)at < SPLITTER_STAGES - 2 ? (size_t)at : SPLITTER_STAGES - 2;
        real_t part = at - (real_t)low;
        for (size_t j = 0; j < 2; j++)
            profile[2 * s + j] = (1 - part) * from[2 * low + j] + part * from[2 * low + 2 + j];
    }
}

static bool make(struct composition *c, size_t stages)
{
    const struct column_table_text text = {.version = COLUMN_TABLE_VERSION,
                                           .size = SPLITTER_SIZE,
                                           .checksum = SPLITTER_SUM,
                                           .value = splitter_table};
    struct column_fault fault;
    memset(c, 0, sizeof *c);
    if (column_table_read(&text, &c->table, &fault) != ERR_OK)
        return false;
    stretch(c->table.profile, stages);
    c->table.profile = profile;
    c->table.config.feed_stage =
        1 + (c->table.config.feed_stage - 1) * (stages - 1) / (SPLITTER_STAGES - 1);
    c->table.config.stages = stages;
    c->inputs = c->table.nominal;
    c->h = BENCH_STEP_S;
    return column_init(&c->column, &c->table.config, &fault) == ERR_OK;
}

/* Numbers from 1. Where the profile is nearly straight: between others the estimate is far from the truth. */
static bool is_truncated(size_t stage)
{
    return (stage >= 6 && stage <= 11) || (stage >= 21 && stage <= 25);
}

static void add_sensors(struct composition *c)
{
    static const uint8_t at[BENCH_SENSORS] = {5, 14, 26, 33};
    c->sensors = BENCH_SENSORS;
    for (uint8_t k = 0; k < BENCH_SENSORS; k++) {
        struct composition_sensor *s = &c->sensor[k];
        s->stage = (uint8_t)((at[k] - 1u) * (c->table.config.stages - 1) / (SPLITTER_STAGES - 1));
        s->component = k < 2 ? 1 : 0;
        s->moves = true;
        s->kp = 2 * LAMBDA;
        s->ki = LAMBDA * LAMBDA;
        s->time = 1 / LAMBDA;
    }
}

bool bench_begin(struct composition *estimator, size_t stages, enum composition_method method,
                 enum bench_truncated truncated)
{
    seed = 1;
    if (!make(&truth, stages) || !make(estimator, stages))
        return false;
    inputs = truth.inputs;
    composition_begin(&truth);
    truth.h = 3600;
    for (unsigned k = 0; k < 100; k++)
        if (composition_predict(&truth) != ERR_OK)
            return false;
    truth.h = BENCH_STEP_S;
    memcpy(profile, truth.x, sizeof profile);
    struct composition *c = estimator;
    add_sensors(c);
    c->method = (uint8_t)method;
    c->between = truncated == BETWEEN_BY_THE_MEAN ? COLUMN_BETWEEN_MEAN : COLUMN_BETWEEN_LINE;
    for (unsigned k = 0; k < SENSORS_MAX; k++)
        c->sensor[k].noise2 = NOISE_K * NOISE_K;
    c->model2 = 0.01f * 0.01f / 3600;
    c->weight = BENCH_STEP_S / 1800.0f;
    for (size_t s = 0; s < stages; s++)
        c->truncated[s] = truncated != ALL_STAGES && is_truncated(s + 1);
    composition_begin(c);
    return true;
}

void bench_next(struct composition *estimator, float *t)
{
    truth.inputs.feed_flow = inputs.feed_flow * (1 + 0.01f * moving());
    truth.inputs.reflux_flow = inputs.reflux_flow * (1 + 0.01f * moving());
    truth.inputs.heat = inputs.heat * (1 + 0.01f * moving());
    truth.inputs.feed_temperature = inputs.feed_temperature + moving();
    estimator->inputs = truth.inputs;
    /* A truth that fails begins anew; the estimator is asked whether it has a solution by the caller. */
    (void)composition_predict(&truth);
    for (uint8_t k = 0; k < estimator->sensors; k++) {
        t[k] = truth.column.temperature[estimator->sensor[k].stage] + NOISE_K * moving();
        estimator->sensor[k].there = true;
    }
}

real_t bench_off(const real_t *x)
{
    real_t most = 0;
    for (size_t i = 0; i < truth.column.n_fractions; i++)
        most = real_abs(x[i] - truth.x[i]) > most ? real_abs(x[i] - truth.x[i]) : most;
    return most;
}

#include "column.h"

#include <string.h>

#include "splitter.h"

/* 10 to the hour, critically damped. */
#define LAMBDA  (10.0f / 3600.0f)
#define NOISE_K 0.1f

static struct composition_block truth;
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

static bool make(struct composition_block *c, size_t stages)
{
    const struct column_table_text text = {.version = COLUMN_TABLE_VERSION,
                                           .size = SPLITTER_SIZE,
                                           .checksum = SPLITTER_SUM,
                                           .value = splitter_table};
    struct column_fault fault;
    memset(c, 0, sizeof *c);
    if (column_table_read(&text, &c->model.table, &fault) != ERR_OK)
        return false;
    stretch(c->model.table.profile, stages);
    c->model.table.profile = profile;
    c->model.table.config.feed_stage =
        1 + (c->model.table.config.feed_stage - 1) * (stages - 1) / (SPLITTER_STAGES - 1);
    c->model.table.config.stages = stages;
    c->model.inputs = c->model.table.nominal;
    c->model.h = BENCH_STEP_S;
    return column_init(&c->model.column, &c->model.table.config, &fault) == ERR_OK;
}

/* Numbers from 1. Where the profile is nearly straight: between others the estimate is far from the truth. */
static bool is_truncated(size_t stage)
{
    return (stage >= 6 && stage <= 11) || (stage >= 21 && stage <= 25);
}

static void add_sensors(struct composition_block *c)
{
    static const uint8_t at[BENCH_SENSORS] = {5, 14, 26, 33};
    c->sensors.n = BENCH_SENSORS;
    for (uint8_t k = 0; k < BENCH_SENSORS; k++) {
        struct composition_sensor *s = &c->sensors.sensor[k];
        s->stage =
            (uint8_t)((at[k] - 1u) * (c->model.table.config.stages - 1) / (SPLITTER_STAGES - 1));
        s->component = k < 2 ? 1 : 0;
        s->moves = true;
        s->kp = 2 * LAMBDA;
        s->ki = LAMBDA * LAMBDA;
        s->time = 1 / LAMBDA;
    }
}

bool bench_begin(struct composition_block *estimator, size_t stages, enum composition_method method,
                 enum bench_truncated truncated)
{
    seed = 1;
    if (!make(&truth, stages) || !make(estimator, stages))
        return false;
    inputs = truth.model.inputs;
    whole_begin(&truth);
    truth.model.h = 3600;
    for (unsigned k = 0; k < 100; k++)
        if (composition_model_predict(&truth.model) != ERR_OK)
            return false;
    truth.model.h = BENCH_STEP_S;
    memcpy(profile, truth.model.x, sizeof profile);
    struct composition_block *c = estimator;
    add_sensors(c);
    c->sensors.method = (uint8_t)method;
    c->model.is_linear = method == METHOD_KALMAN;
    c->model.between = truncated == BETWEEN_BY_THE_MEAN ? COLUMN_BETWEEN_MEAN : COLUMN_BETWEEN_LINE;
    for (unsigned k = 0; k < SENSORS_MAX; k++)
        c->sensors.sensor[k].noise2 = NOISE_K * NOISE_K;
    c->sensors.model2 = 0.01f * 0.01f / 3600;
    c->watch.weight = BENCH_STEP_S / 1800.0f;
    for (size_t s = 0; s < stages; s++)
        c->model.truncated[s] = truncated != ALL_STAGES && is_truncated(s + 1);
    whole_begin(c);
    return true;
}

void bench_next(struct composition_block *estimator, float *t)
{
    truth.model.inputs.feed_flow = inputs.feed_flow * (1 + 0.01f * moving());
    truth.model.inputs.reflux_flow = inputs.reflux_flow * (1 + 0.01f * moving());
    truth.model.inputs.heat = inputs.heat * (1 + 0.01f * moving());
    truth.model.inputs.feed_temperature = inputs.feed_temperature + moving();
    estimator->model.inputs = truth.model.inputs;
    /* A truth that fails begins anew; the estimator is asked whether it has a solution by the caller. */
    if (composition_model_predict(&truth.model) != ERR_OK)
        whole_begin(&truth);
    for (uint8_t k = 0; k < estimator->sensors.n; k++) {
        t[k] =
            truth.model.column.temperature[estimator->sensors.sensor[k].stage] + NOISE_K * moving();
        estimator->sensors.sensor[k].present = true;
    }
}

real_t bench_off(const real_t *x)
{
    real_t most = 0;
    for (size_t i = 0; i < truth.model.column.n_fractions; i++)
        most = real_abs(x[i] - truth.model.x[i]) > most ? real_abs(x[i] - truth.model.x[i]) : most;
    return most;
}

#include "commission/analysis_job.h"

#include "commission/analysis.h"
#include "commission/analysis_structure.h"
#include "commission/commission_state.h"
#include "commission/direction.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"
#include "interact/direction.h"

#include <string.h>

/* Relative error of any gain, because a first-order model is not the plant. */
#define GAIN_FLOOR REAL_C(0.005)
#define MEMBERS    24u          /* plants drawn, for which the settings must be sound */
#define STEP       REAL_C(0.05) /* of the predicted setpoint steps, fraction of span */

/* Largest numbers of an element of the plant, below the bounds in interact/plant.h: a slow shape or an integrator
 * (lti/shape.h) may have larger ones. With gain, lags and their product reduced by one factor the response is the same as far as
 * the tests saw it. */
#define LAG_MOST    REAL_C(9e5) /* s; a zero and a dead time too */
#define SQUARE_MOST (LAG_MOST * LAG_MOST)
#define DAMPING_LOW REAL_C(0.02)

static real_t put_shape(struct interact_plant *plant, uint8_t j, uint8_t n, struct shape s)
{
    REFLUX_ASSERT(j < INTERACT_MAX && n < INTERACT_MAX);
    real_t part = REAL_C(1.0);
    if (s.lag_s > LAG_MOST)
        part = LAG_MOST / s.lag_s;
    if (part * s.square_s2 > SQUARE_MOST)
        part = SQUARE_MOST / s.square_s2;
    real_t square_s2 = part * s.square_s2, lag_s = part * s.lag_s;
    real_t damped_s = REAL_C(2.0) * DAMPING_LOW * real_sqrt(square_s2);
    if (lag_s < damped_s)
        lag_s = damped_s;
    plant->element[j][n] =
        (struct fopdt){.gain = part * s.gain,
                       .dead_time_s = real_clamp(s.dead_time_s, REAL_C(0.0), LAG_MOST),
                       .time_constant_s = lag_s};
    plant->shape[j][n] = (struct interact_shape){
        .square_s2 = square_s2, .zero_s = real_clamp(s.zero_s, -LAG_MOST, LAG_MOST)};
    return part;
}

static void take_element(struct analysis *a, uint8_t j, uint8_t n, const struct element *e)
{
    real_t part = put_shape(&a->plant, j, n, e->found.shape);
    a->plant.gain_sd[j][n] = part * e->found.sd[SHAPE_GAIN];
    a->flags[j][n] = e->flags;
}

/* The input of the analysis drives an inner loop, so its elements are no longer those that were found. */
static bool drives_inner_loop(const struct analysis *a, uint8_t n)
{
    for (uint8_t k = 0; k < a->pairs.n; k++)
        if (a->pairs.input[k] == n && analysis_inner_of(a, k) != INTERACT_NONE)
            return true;
    return false;
}

/* Draws a row of a plant that the true one may be: struct robust_config. */
static void draw_row(const void *context, uint16_t member, uint8_t j, struct interact_plant *plant)
{
    REFLUX_ASSERT(j < INTERACT_MAX);
    const struct commission *c = context;
    const struct analysis *a = &c->work->analysis;
    real_t error[INTERACT_MAX] = {REAL_C(0.0)};
    if (j == 0)
        *plant = a->plant;
    if (member + 1u == a->left_out)
        member = MEMBERS;
    for (uint8_t n = 0; n < a->plant.inputs; n++) {
        struct shape s;
        if (drives_inner_loop(a, n))
            continue;
        const struct shape_found *f = &c->work->element[j][c->analysis_job.column[n]].found;
        shape_found_draw(f, (uint32_t)j * INTERACT_MAX + n, member, &s);
        (void)put_shape(plant, j, n, s);
        error[n] = s.gain - f->shape.gain;
    }
    if (!(a->plant.along_sd[j] > REAL_C(0.0)))
        return;
    direction_correct(&a->plant, j, REAL_C(0.0), error);
    for (uint8_t n = 0; n < a->plant.inputs; n++)
        plant->element[j][n].gain = a->plant.element[j][n].gain + error[n];
}

/* Notes the measurement that the settings pair with input[k], which is column n of the analysis. */
static void note_given(struct commission *c, const struct config *config, uint8_t k, uint8_t n)
{
    for (unsigned p = 0; p < CONFIG_PAIRS && config->test.pairs == TEST_PAIRS_GIVEN; p++) {
        const struct pair_config *pair = &config->pair[p];
        if (!pair->measurement[0] ||
            config_find_mv(config, pair->mv) != inputs_get(&c->inputs, k)->output)
            continue;
        uint8_t i = config_find_measurement(config, pair->measurement);
        for (uint8_t j = 0; j < outputs_count(&c->outputs); j++)
            if (outputs_measurement(&c->outputs, j) == i)
                c->work->analysis.given[j] = (uint8_t)(n + 1u);
    }
}

void analysis_job_begin(struct commission *c, const struct config *config, real_t h_s)
{
    struct analysis *a = &c->work->analysis;
    memset(&a->plant, 0, sizeof a->plant);
    memset(a->given, 0, sizeof a->given);
    a->plant.outputs = outputs_count(&c->outputs);
    uint8_t n = 0;
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++) {
        if (inputs_get(&c->inputs, k)->skipped)
            continue;
        for (uint8_t j = 0; j < outputs_count(&c->outputs); j++)
            take_element(a, j, n, &c->work->element[j][k]);
        note_given(c, config, k, n);
        c->analysis_job.column[n++] = k;
    }
    a->plant.inputs = n;
    direction_condition(c, GAIN_FLOOR);
    c->analysis_job.config =
        (struct analysis_config){.h_s = h_s,
                                 .confidence = config->test.confidence,
                                 .floor = GAIN_FLOOR,
                                 .step = STEP,
                                 .probe = config->test.probe,
                                 .loops_max = CONFIG_LOOPS,
                                 .last = inputs_round(&c->inputs) >= config->test.rounds,
                                 .members = MEMBERS,
                                 .draw = draw_row,
                                 .context = c,
                                 .noise_sd = outputs_noise(&c->outputs)};
    c->analysis_job.begun = false;
    c->analysis_job.error = n == 0 ? ERR_EMPTY : ERR_OK;
}

bool analysis_job_piece(struct commission *c)
{
    if (c->analysis_job.error)
        return false;
    enum err err = c->analysis_job.begun
                       ? analysis_step(&c->work->analysis)
                       : analysis_begin(&c->work->analysis, &c->analysis_job.config);
    if (err && err != ERR_BUSY)
        c->analysis_job.error = err;
    bool more = err == ERR_BUSY || (!c->analysis_job.begun && !err);
    c->analysis_job.begun = true;
    return more;
}

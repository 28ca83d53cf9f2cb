#include "commission/analysis_job.h"

#include "commission/analysis.h"
#include "commission/commission_state.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"

#include <string.h>

/* Relative error of any gain, because a first-order model is not the plant. */
#define GAIN_FLOOR REAL_C(0.005)
#define STEP       REAL_C(0.05) /* of the predicted setpoint steps, fraction of span */

/* Takes the beginning of a response that is not a lag's. The whole element gets its dead time, too, and lasts as long as
 * before. */
static void take_early(const struct element *e, struct fopdt *whole, struct beginning *begins)
{
    *begins = (struct beginning){0};
    if (!(e->early_slope > REAL_C(0.0)) || !(real_abs(whole->gain) > REAL_C(0.0)))
        return;
    real_t takes_s = whole->time_constant_s + whole->dead_time_s;
    begins->time_constant_s = real_abs(whole->gain) / e->early_slope;
    begins->dead_time_s = e->early_dead_s;
    if (whole->dead_time_s > e->early_dead_s) {
        whole->dead_time_s = e->early_dead_s;
        whole->time_constant_s = takes_s - e->early_dead_s;
    }
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
        for (uint8_t j = 0; j < outputs_count(&c->outputs); j++) {
            const struct identified *e = &c->work->element[j][k].fit;
            a->plant.element[j][n] = (struct fopdt){.gain = e->gain,
                                                    .dead_time_s = e->dead_time_s,
                                                    .time_constant_s = e->time_constant_s};
            a->plant.gain_sd[j][n] = e->gain_sd;
            a->flags[j][n] = e->flags;
            take_early(&c->work->element[j][k], &a->plant.element[j][n], &a->beginning[j][n]);
        }
        note_given(c, config, k, n);
        c->analysis_job.column[n++] = k;
    }
    a->plant.inputs = n;
    c->analysis_job.config =
        (struct analysis_config){.h_s = h_s,
                                 .confidence = config->test.confidence,
                                 .floor = GAIN_FLOOR,
                                 .step = STEP,
                                 .loops_max = CONFIG_LOOPS,
                                 .last = inputs_round(&c->inputs) >= config->test.rounds,
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

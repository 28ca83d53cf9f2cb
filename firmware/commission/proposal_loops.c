#include "commission/proposal_loops.h"

#include "base/assertion.h"
#include "commission/analysis_job.h"
#include "commission/analysis_structure.h"
#include "commission/commission_state.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"
#include "exchange/plan.h"

#include <string.h>

const struct tested_input *proposal_input(const struct commission *c, uint8_t k)
{
    REFLUX_ASSERT(k < c->work->analysis.pairs.n);
    uint8_t input = c->work->analysis.pairs.input[k];
    return inputs_get(&c->inputs, analysis_job_input(&c->analysis_job, input));
}

const char *proposal_measurement_name(const struct commission *c, const struct config *config,
                                      uint8_t k)
{
    REFLUX_ASSERT(k < c->work->analysis.pairs.n);
    const struct analysis *a = &c->work->analysis;
    return config->measurement[outputs_measurement(&c->outputs, a->pairs.output[k])].name;
}

const char *proposal_output_name(const struct commission *c, const struct config *config, uint8_t k)
{
    return config->mv[proposal_input(c, k)->output].name;
}

uint8_t proposal_loop(const struct commission *c, const struct config *config, uint8_t k)
{
    const char *drives = proposal_output_name(c, config, k);
    if (analysis_inner_of(&c->work->analysis, k) != INTERACT_NONE) {
        uint8_t inner = proposal_inner_loop(c, config, k);
        if (inner == PLAN_NONE)
            return PLAN_NONE;
        drives = config->loop[inner].name;
    }
    return proposal_find_loop(config, proposal_measurement_name(c, config, k), drives);
}

const char *proposal_inner_name(const struct commission *c, const struct config *config, uint8_t k)
{
    uint8_t inner = analysis_inner_of(&c->work->analysis, k);
    return inner == INTERACT_NONE
               ? ""
               : config->measurement[outputs_measurement(&c->outputs, inner)].name;
}

uint8_t proposal_find_loop(const struct config *config, const char *pv, const char *out)
{
    for (uint8_t i = 0; pv[0] && i < CONFIG_LOOPS; i++)
        if (config->loop[i].name[0] && strcmp(config->loop[i].pv, pv) == 0 &&
            strcmp(config->loop[i].out, out) == 0)
            return i;
    return PLAN_NONE;
}

uint8_t proposal_inner_loop(const struct commission *c, const struct config *config, uint8_t k)
{
    return proposal_find_loop(config, proposal_inner_name(c, config, k),
                              proposal_output_name(c, config, k));
}

void proposal_decouple_alone(struct config *config, uint8_t i)
{
    for (uint8_t k = 0; i < DECOUPLER_MAX && k < DECOUPLER_MAX; k++)
        config->decoupler[i][k] = config->decoupler[k][i] = i == k ? 1.0f : 0.0f;
}

static bool is_taken(const struct config *config, const char *name)
{
    return config_find_mv(config, name) != PLAN_NONE || config_find_loop(config, name) != PLAN_NONE;
}

void proposal_name_loop(struct config *config, uint8_t i, const char *pv, const char *out)
{
    REFLUX_ASSERT(i < CONFIG_LOOPS);
    char name[CHANNEL_NAME_SIZE] = {0};
    strncpy(name, pv, sizeof name - 1);
    /* There are more letters than names that could be taken. */
    for (char letter = 'A'; letter <= 'Z' && is_taken(config, name); letter++) {
        memset(name, 0, sizeof name);
        name[0] = letter;
        name[1] = '_';
        strncpy(name + 2, out, sizeof name - 3);
    }
    memcpy(config->loop[i].name, name, sizeof name);
}

struct loop_config proposal_settings(const struct tuning *t, real_t derivative_filter)
{
    return (struct loop_config){
        .own.gain = (float)t->gain,
        .own.ti_s = (float)t->ti_s,
        .own.td_s = (float)t->td_s,
        .own.n = (float)derivative_filter,
        .own.b = 1.0f,
        .own.out_hi = 1.0f,
        .own.action = t->action == TUNING_DIRECT ? LOOP_DIRECT : LOOP_REVERSE,
        .sp_track = 1,
        .divisor = 1,
    };
}

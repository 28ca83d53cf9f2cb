#include "commission/proposal.h"

#include "commission/by_relay.h"
#include "commission/commission_state.h"
#include "commission/proposal_loops.h"
#include "commission/proposal_structure.h"
#include "commission/startup_results.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"
#include "exchange/plan.h"

#include <string.h>

static bool is_tested_output(const struct commission *c, const struct config *config,
                             const char *name)
{
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++) {
        const struct tested_input *in = inputs_get(&c->inputs, k);
        if (!in->skipped && strcmp(config->mv[in->output].name, name) == 0)
            return true;
    }
    return false;
}

/* Removes loops on tested outputs, loops that drive such loops, and feedforwards onto those outputs. */
static void make_room(const struct commission *c, struct config *config)
{
    bool drops = true;
    for (unsigned depth = 0; drops && depth < CONFIG_LOOPS; depth++) {
        drops = false;
        for (uint8_t i = 0; i < CONFIG_LOOPS; i++) {
            struct loop_config *l = &config->loop[i];
            bool inner = config_find_loop(config, l->out) != PLAN_NONE ||
                         config_find_mv(config, l->out) != PLAN_NONE;
            if (!l->name[0] || (inner && !is_tested_output(c, config, l->out)))
                continue;
            for (uint8_t k = 0; k < CONFIG_ALARMS; k++)
                if (config->alarm[k].side == ALARM_DEVIATION &&
                    strcmp(config->alarm[k].on, l->name) == 0)
                    config->alarm[k].on[0] = '\0';
            memset(l->name, 0, sizeof l->name);
            proposal_decouple_alone(config, i);
            drops = true;
        }
    }
    for (uint8_t k = 0; k < CONFIG_FEEDFORWARDS; k++)
        if (is_tested_output(c, config, config->feedforward[k].to))
            config->feedforward[k].from[0] = '\0';
}

/* Writes the settings of the loop of a relay test, and nothing else. */
static enum err write_relay(const struct commission *c, struct config *config)
{
    uint8_t i = proposal_loop(c, config, 0);
    if (i == PLAN_NONE)
        return ERR_UNKNOWN;
    by_relay_write(&c->by_relay, &config->loop[i]);
    return ERR_OK;
}

enum err proposal_write(const struct commission *c, struct config *config)
{
    const struct analysis *a = &c->work->analysis;
    if (!commission_has_proposal(c) || !commission_has_results(c))
        return ERR_STATE;
    if (!outputs_are_those_of(&c->outputs, config))
        return ERR_CONFLICT;
    if (by_relay_is_latest(&c->by_relay))
        return write_relay(c, config);
    make_room(c, config);
    uint8_t place[CONFIG_LOOPS];
    uint8_t n = 0;
    bool decoupled = a->decoupler == DECOUPLER_USED;
    unsigned places = decoupled ? DECOUPLER_MAX : CONFIG_LOOPS; /* the matrix has the first loops */
    for (uint8_t i = 0; i < places && n < a->pairs.n; i++)
        if (!config->loop[i].name[0])
            place[n++] = i;
    if (n < a->pairs.n)
        return ERR_FULL;
    for (uint8_t k = 0; k < n; k++)
        proposal_decouple_alone(config, place[k]);
    for (uint8_t k = 0; k < n; k++) {
        struct loop_config *l = &config->loop[place[k]];
        const char *pv = proposal_measurement_name(c, config, k);
        const char *out = proposal_output_name(c, config, k);
        *l = proposal_settings(&a->loops.tuning[k], a->loops.derivative_filter);
        l->decouple = decoupled;
        strncpy(l->pv, pv, sizeof l->pv - 1);
        strncpy(l->out, out, sizeof l->out - 1);
        proposal_name_loop(config, place[k], pv, out);
        for (uint8_t j = 0; j < n && decoupled; j++)
            config->decoupler[place[k]][place[j]] = (float)a->d.value[k][j];
    }
    return proposal_add_structure(c, config, place);
}

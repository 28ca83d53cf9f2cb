#include "commission/proposal_structure.h"

#include "commission/analysis_structure.h"
#include "commission/commission_state.h"
#include "commission/proposal_loops.h"
#include "exchange/plan.h"

#include <string.h>

static uint8_t free_loop(const struct config *config)
{
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++)
        if (!config->loop[i].name[0])
            return i;
    return PLAN_NONE;
}

static enum err add_inner(const struct commission *c, struct config *config, uint8_t k,
                          struct loop_config *outer)
{
    const struct analysis *a = &c->work->analysis;
    const char *pv = proposal_inner_name(c, config, k), *out = proposal_output_name(c, config, k);
    uint8_t i = free_loop(config);
    if (i == PLAN_NONE)
        return ERR_FULL;
    struct loop_config *l = &config->loop[i];
    *l = proposal_settings(layout_inner_tuning(&a->layout, k), a->loops.derivative_filter);
    strncpy(l->pv, pv, sizeof l->pv - 1);
    strncpy(l->out, out, sizeof l->out - 1);
    proposal_name_loop(config, i, pv, out);
    proposal_decouple_alone(config, i);
    memcpy(outer->out, l->name, sizeof outer->out);
    outer->decouple =
        0; /* it is a part of the plant by itself, and drives no manipulated variable */
    return ERR_OK;
}

/* Adds a feedforward; its output is 0 at the operating point. */
static void add_feed(const struct commission *c, struct config *config, const struct feed *f)
{
    const struct tested_input *in = proposal_input(c, f->way.from);
    const struct mv_config *o = &config->mv[in->output];
    uint8_t i = 0;
    while (i < CONFIG_FEEDFORWARDS && config->feedforward[i].from[0])
        i++;
    /* The element would read a measurement of that name instead. */
    if (i == CONFIG_FEEDFORWARDS || config_find_measurement(config, o->name) != PLAN_NONE)
        return;
    struct ff_config *ff = &config->feedforward[i];
    *ff = (struct ff_config){.gain = (float)f->way.gain,
                             .lead_s = (float)f->way.lead_s,
                             .lag_s = (float)f->way.lag_s,
                             .dead_s = (float)f->way.dead_s,
                             .reference = o->lo + (float)in->test_base * (o->hi - o->lo),
                             .lo = -1.0f,
                             .hi = 1.0f};
    strncpy(ff->from, o->name, sizeof ff->from - 1);
    strncpy(ff->to, proposal_output_name(c, config, f->way.to), sizeof ff->to - 1);
}

enum err proposal_add_structure(const struct commission *c, struct config *config,
                                const uint8_t *place)
{
    const struct analysis *a = &c->work->analysis;
    for (uint8_t k = 0; k < a->pairs.n; k++) {
        if (analysis_inner_of(a, k) == INTERACT_NONE)
            continue;
        enum err err = add_inner(c, config, k, &config->loop[place[k]]);
        if (err)
            return err;
    }
    struct feed feeds[CONFIG_FEEDFORWARDS];
    uint8_t n = analysis_feeds(a, feeds);
    for (uint8_t k = 0; k < n; k++)
        add_feed(c, config, &feeds[k]);
    return ERR_OK;
}

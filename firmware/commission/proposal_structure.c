#include "exchange/config.h"

#include "commission/commission_internal.h"
#include "commission/proposal_structure.h"

#include <string.h>

#define ROOM_SHARE REAL_C(0.8)

const char *proposal_inner_name(const struct commission *c, const struct config *config, uint8_t k)
{
    uint8_t inner = analysis_inner_of(&c->work->analysis, k);
    return inner == INTERACT_NONE ? "" : config->measurement[c->measurement[inner]].name;
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
    *l = proposal_settings(&a->inner_tuning[k], a->loops.derivative_filter);
    strncpy(l->pv, pv, sizeof l->pv - 1);
    strncpy(l->out, out, sizeof l->out - 1);
    proposal_name_loop(config, i, pv, out);
    proposal_decouple_alone(config, i);
    memcpy(outer->out, l->name, sizeof outer->out);
    outer->decouple =
        0; /* it is a part of the plant by itself, and drives no manipulated variable */
    return ERR_OK;
}

/* At the operating point it calls for nothing. */
static void add_feed(const struct commission *c, struct config *config, const struct feed *f)
{
    const struct analysis *a = &c->work->analysis;
    const struct tested_input *in = &c->input[c->column[a->pairs.input[f->way.from]]];
    const struct mv_config *o = &config->mv[in->output];
    uint8_t i = 0;
    while (i < CONFIG_FEEDFORWARDS && config->feedforward[i].from[0])
        i++;
    /* A measurement of that name would be taken instead. */
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

/* The outer loop's output is a setpoint: inside the inner measurement's limit and span, and no farther than the
 * manipulated variable can follow, at rest and at once. */
static void keep_in_reach(const struct commission *c, const struct supervisor *s, uint8_t k,
                          real_t limit, struct adoption_loop *outer)
{
    const struct analysis *a = &c->work->analysis;
    const struct tested_input *in = &c->input[c->column[a->pairs.input[k]]];
    const struct mv_config *o = &s->plan->config.mv[in->output];
    uint8_t j = a->pairs.input[k];
    real_t lo = (o->min - o->lo) / (o->hi - o->lo), hi = (o->max - o->lo) / (o->hi - o->lo);
    real_t held = num_to_float(s->mv[in->output].manual);
    real_t room = held - lo < hi - held ? held - lo : hi - held;
    real_t a_step = real_abs(c->work->element[analysis_inner_of(a, k)][c->column[j]].fit.gain);
    real_t moved = a->inner_tuning[k].gain; /* of the manipulated variable for a setpoint of 1 */
    if (a_step * moved < REAL_C(1.0))
        moved = REAL_C(1.0) / a_step; /* without a gain infinite, and there is no room */
    real_t reach = room / moved;
    real_t y = num_to_float(s->measurement[c->measurement[analysis_inner_of(a, k)]].value);
    real_t span = y < REAL_C(0.5) ? y : REAL_C(1.0) - y;
    reach = reach < limit ? reach : limit;
    reach = ROOM_SHARE * (reach < span ? reach : span);
    if (outer->predicted.moved * real_abs(outer->step) > reach * outer->size) {
        real_t step = reach * outer->size / outer->predicted.moved;
        if (!(step > STEP_NEVER)) /* no room at all, or the wrong side of a limit */
            step = STEP_NEVER;
        outer->step = outer->step < REAL_C(0.0) ? -step : step;
    }
}

enum err proposal_prepare_inner(struct commission *c, const struct supervisor *s,
                                const struct config *config)
{
    const struct analysis *a = &c->work->analysis;
    struct adoption *t = &c->adoption;
    for (uint8_t k = 0; k < a->pairs.n; k++) {
        uint8_t inner = analysis_inner_of(a, k);
        if (inner == INTERACT_NONE)
            continue;
        uint8_t i = proposal_inner_loop(c, config, k);
        if (i == PLAN_NONE || t->n + t->n_inner >= CONFIG_LOOPS)
            return ERR_UNKNOWN;
        t->loop[t->n + t->n_inner++] = (struct adoption_loop){.loop = i, .size = a->config.step};
        real_t limit = commission_limit(&config->measurement[c->measurement[inner]]);
        keep_in_reach(c, s, k, limit, &t->loop[k]);
    }
    return ERR_OK;
}

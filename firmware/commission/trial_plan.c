#include "commission/trial_plan.h"

#include "base/assertion.h"
#include "base/error.h"
#include "commission/adoption.h"
#include "commission/analysis_job.h"
#include "commission/analysis_structure.h"
#include "commission/channels.h"
#include "commission/commission_state.h"
#include "commission/direction.h"
#include "commission/proposal_loops.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"

#define STEP_IN_NOISE REAL_C(8.0)
#define STEP_LEAST    REAL_C(0.01) /* fraction of span */
#define STEP_SHARE    REAL_C(0.25) /* of the test limit */
#define STEP_MOST     REAL_C(0.5)
#define ROOM_SHARE    REAL_C(0.8)
#define OTHERS_SHARE  REAL_C(0.7) /* share of a limit that a step may use of other measurements */
#define WINDOW_MOST   10000u
#define WAY_MARGIN    REAL_C(0.05) /* of span, from its ends */
#define STEP_NEVER    REAL_C(1e-4) /* of span: smallest step of a setpoint */
#define PROBE_SHARE                                                                                \
    REAL_C(0.5) /* least share of its step that a loop may be left with for its probe */
#define GAIN_MOST REAL_C(100.0) /* of a controller: signal/pid.h */

/* Returns the largest setpoint step of loop k for which, by the model, every input stays within its room and every
 * other measurement within its limit. more: factor on the moves of the inputs; others: largest error of another loop, in units of the
 * step. */
static real_t step_by_model(const struct commission *c, const struct supervisor *s, uint8_t k,
                            real_t more, real_t others)
{
    REFLUX_ASSERT(k < c->work->analysis.pairs.n);
    const struct analysis *a = &c->work->analysis;
    const struct trial_mark *by = &a->tried[k];
    real_t most = REAL_C(1.0);
    for (uint8_t l = 0; l < a->pairs.n; l++) {
        if (analysis_inner_of(a, l) != INTERACT_NONE)
            continue; /* keep_in_reach() */
        uint8_t j = proposal_input(c, l)->output;
        real_t room = ROOM_SHARE * commission_room(s, j, num_to_float(s->mv[j].manual));
        if (more * by->moved[l] * most > room * a->config.step)
            most = room * a->config.step / (more * by->moved[l]);
    }
    for (uint8_t l = 0; l < a->pairs.n; l++) {
        real_t limit = OTHERS_SHARE * adoption_channel(&c->adoption, l)->limit;
        if (l != k && others * most > limit)
            most = limit / others;
    }
    for (uint8_t j = a->pairs.n; j < adoption_channels(&c->adoption); j++) {
        const struct adoption_channel *m = adoption_channel(&c->adoption, j);
        uint8_t output = m->output;
        real_t goes = REAL_C(0.0), limit = OTHERS_SHARE * m->limit;
        for (uint8_t l = 0; l < a->pairs.n; l++)
            goes += a->plant.element[output][a->pairs.input[l]].gain * by->input[l];
        if (real_abs(goes) * most > limit * a->config.step)
            most = limit * a->config.step / real_abs(goes);
    }
    return most;
}

/* Largest share of its room that an input uses in the step of loop k, where the inputs are still as far away as the steps before
 * have taken them. That is so where they act nearly alike: they come back as slowly as they went. */
NOT_INLINE static real_t room_used(const struct commission *c, const struct supervisor *s,
                                   uint8_t k, real_t step)
{
    const struct analysis *a = &c->work->analysis;
    real_t most = REAL_C(0.0);
    for (uint8_t l = 0; l < a->pairs.n; l++) {
        if (analysis_inner_of(a, l) != INTERACT_NONE)
            continue;
        uint8_t j = proposal_input(c, l)->output;
        real_t room = commission_room(s, j, num_to_float(s->mv[j].manual));
        real_t moves = step * a->tried[k].input[l];
        for (uint8_t before = 0; before < k; before++)
            moves += adoption_loop(&c->adoption, before)->step * a->tried[before].input[l];
        if (real_abs(moves) > most * room * a->config.step)
            most = real_abs(moves) / (room * a->config.step);
    }
    return most;
}

/* Way of a step: towards the middle of the span, or the other one where inputs act nearly alike and have no room left for it. */
static real_t choose_way(const struct commission *c, const struct supervisor *s, uint8_t k,
                         real_t y, real_t step)
{
    real_t way = y > REAL_C(0.5) ? -step : step;
    if (!direction_gains_are_large(&c->work->analysis))
        return way;
    real_t used = room_used(c, s, k, way);
    bool fits = y - way > WAY_MARGIN && y - way < REAL_C(1.0) - WAY_MARGIN;
    return used > REAL_C(1.0) && fits && room_used(c, s, k, -way) < used ? -way : way;
}

/* Returns the step of a loop of which its margin probe allows `most`: shorter, or as it is without the probe where too little would be
 * left of it. */
static real_t fit_probe(struct trial_probe *p, real_t step, real_t most)
{
    if (!p->planned || most >= step)
        return step;
    p->planned = most >= PROBE_SHARE * step;
    return p->planned ? most : step;
}

/* Plans the margin probe of loop k, and returns its step. */
static real_t plan_probe(struct commission *c, const struct supervisor *s,
                         const struct config *config, uint8_t k, real_t step)
{
    struct analysis *a = &c->work->analysis;
    struct trial_probe *p = &a->probe[k];
    p->planned = p->moved > REAL_C(0.0) && (real_t)config->test.probe > REAL_C(0.0) &&
                 a->config.probe * a->loops.tuning[k].gain <= GAIN_MOST;
    return fit_probe(p, step, step_by_model(c, s, k, p->moved, p->others));
}

/* Chooses the setpoint step of a loop: above the noise, inside the limit, and no larger than the model allows for inputs and
 * other measurements. */
static real_t choose_step(struct commission *c, const struct supervisor *s,
                          const struct config *config, uint8_t k)
{
    const struct adoption_channel *m = adoption_channel(&c->adoption, k);
    real_t step = STEP_IN_NOISE * m->noise_sd;
    if (step < STEP_LEAST)
        step = STEP_LEAST;
    if (step < STEP_SHARE * m->limit)
        step = STEP_SHARE * m->limit;
    if (step > STEP_MOST * m->limit)
        step = STEP_MOST * m->limit;
    real_t most = step_by_model(c, s, k, REAL_C(1.0), c->work->analysis.tried[k].others);
    if (step > most)
        step = most;
    if (step < STEP_NEVER)
        step = STEP_NEVER;
    step = plan_probe(c, s, config, k, step);
    return choose_way(c, s, k, num_to_float(s->measurement[m->measurement].value), step);
}

/* Adds a measurement, by its index in the tests. */
static void take_channel(struct commission *c, const struct config *config, uint8_t output)
{
    uint8_t i = outputs_measurement(&c->outputs, output);
    struct adoption_channel m = {.measurement = i,
                                 .output = output,
                                 .noise_sd = outputs_noise(&c->outputs)[output],
                                 .limit = commission_limit(&config->measurement[i])};
    adoption_add_channel(&c->adoption, &m);
}

/* Adds all measurements that were tested: those of the loops first, in their order. */
static void take_channels(struct commission *c, const struct config *config)
{
    const struct analysis *a = &c->work->analysis;
    uint32_t held = 0;
    for (uint8_t k = 0; k < a->pairs.n; k++) {
        take_channel(c, config, a->pairs.output[k]);
        held |= 1u << a->pairs.output[k];
    }
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++)
        if (!(held >> j & 1u))
            take_channel(c, config, j);
}

/* Reduces the step of an outer loop, whose output is a setpoint: inside the inner measurement's limit and span, and within
 * reach of the manipulated variable, at once and at rest. */
static void keep_in_reach(struct commission *c, const struct supervisor *s, uint8_t k, real_t limit)
{
    const struct analysis *a = &c->work->analysis;
    const struct adoption_loop *outer = adoption_loop(&c->adoption, k);
    const struct tested_input *in = proposal_input(c, k);
    uint8_t inner = analysis_inner_of(a, k);
    uint8_t i = analysis_job_input(&c->analysis_job, a->pairs.input[k]);
    real_t room = commission_room(s, in->output, num_to_float(s->mv[in->output].manual));
    real_t a_step = real_abs(c->work->element[inner][i].found.shape.gain);
    real_t moved = layout_inner_tuning(&a->layout, k)
                       ->gain; /* of the manipulated variable for a setpoint of 1 */
    if (a_step * moved < REAL_C(1.0))
        moved = REAL_C(1.0) / a_step; /* without a gain infinite, and there is no room */
    real_t reach = room / moved;
    real_t y = num_to_float(s->measurement[outputs_measurement(&c->outputs, inner)].value);
    real_t span = y < REAL_C(0.5) ? y : REAL_C(1.0) - y;
    reach = reach < limit ? reach : limit;
    reach = ROOM_SHARE * (reach < span ? reach : span);
    if (outer->predicted.moved * real_abs(outer->step) > reach * outer->size) {
        real_t step = reach * outer->size / outer->predicted.moved;
        if (!(step > STEP_NEVER)) /* no room at all, or the wrong side of a limit */
            step = STEP_NEVER;
        adoption_set_step(&c->adoption, k, outer->step < REAL_C(0.0) ? -step : step);
    }
    struct trial_probe *p = &c->work->analysis.probe[k];
    real_t step = real_abs(outer->step), raised = outer->predicted.moved * p->moved;
    step = fit_probe(p, step,
                     raised * step > reach * outer->size ? reach * outer->size / raised : step);
    adoption_set_step(&c->adoption, k, outer->step < REAL_C(0.0) ? -step : step);
}

/* Adds the inner loops behind the pairs, and limits setpoint steps to those that they can follow. */
static enum err prepare_inner(struct commission *c, const struct supervisor *s,
                              const struct config *config)
{
    const struct analysis *a = &c->work->analysis;
    for (uint8_t k = 0; k < a->pairs.n; k++) {
        uint8_t inner = analysis_inner_of(a, k);
        if (inner == INTERACT_NONE)
            continue;
        struct adoption_loop l = {.loop = proposal_inner_loop(c, config, k),
                                  .size = a->config.step};
        if (l.loop == PLAN_NONE || adoption_add_loop(&c->adoption, &l, true) != ERR_OK)
            return ERR_UNKNOWN;
        uint8_t i = outputs_measurement(&c->outputs, inner);
        keep_in_reach(c, s, k, commission_limit(&config->measurement[i]));
    }
    return ERR_OK;
}

enum err proposal_prepare_trial(struct commission *c, const struct supervisor *s,
                                const struct config *config)
{
    const struct analysis *a = &c->work->analysis;
    if (!outputs_are_those_of(&c->outputs, config))
        return ERR_CONFLICT;
    uint32_t back = inputs_half_least(&c->inputs), window = back;
    if (window < config->test.window)
        window = config->test.window;
    if (window < STEADY_BLOCKS)
        window = STEADY_BLOCKS;
    if (window > WINDOW_MOST)
        window = WINDOW_MOST;
    adoption_prepare(&c->adoption, window, back);
    adoption_probe_with(&c->adoption, a->probe);
    take_channels(c, config);
    for (uint8_t k = 0; k < a->pairs.n; k++) {
        struct adoption_loop l = {.loop = proposal_loop(c, config, k),
                                  .output = proposal_input(c, k)->output,
                                  .predicted = a->predicted[k],
                                  .left = a->tried[k].left,
                                  .size = a->config.step};
        l.predicted.iae = a->tried[k].iae;
        l.duration_s = ADOPTION_DURATION * l.predicted.settled_s;
        if (l.duration_s > a->horizon_s)
            l.duration_s = a->horizon_s;
        l.step = choose_step(c, s, config, k);
        if (l.loop == PLAN_NONE || adoption_add_loop(&c->adoption, &l, false) != ERR_OK)
            return ERR_UNKNOWN;
    }
    return prepare_inner(c, s, config);
}

#include "commission/direction.h"

#include <string.h>

#include "base/assertion.h"
#include "commission/certainty.h"
#include "commission/channels.h"
#include "commission/commission_state.h"
#include "commission/direction_sum.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"
#include "interact/direction.h"

#define DIRECTION_LAMBDA REAL_C(10.0) /* relative gain from which inputs act nearly alike */
#define SHARE_LEAST      REAL_C(0.02) /* of the largest: a smaller one moves nothing */
#define FIRST_SHARE      REAL_C(0.5)  /* of a limit, that the first step may use by the model */
#define HALF_TIMES       REAL_C(1.5) /* of the time until everything is over: the rest is for the mean */
#define PEAK_INSTANTS    16u         /* at which the predicted response is looked at */
#define PEAK_LAGS        REAL_C(4.0) /* longest response that is looked at, in lags */
#define DIRECTION_NOISE  REAL_C(2.0) /* times the noise multiple: a clear response */
#define FLAGS_NO_SUM     (IDENTIFIED_RAMP | CERTAINTY_OPEN_FLAGS)

bool direction_gains_are_large(const struct analysis *a)
{
    for (uint8_t k = 0; k < a->pairs.n; k++)
        if (a->pair_lambda[k] > DIRECTION_LAMBDA)
            return true;
    return false;
}

static bool acts_alike(const struct analysis *a)
{
    uint8_t least = a->plant.inputs < a->plant.outputs ? a->plant.inputs : a->plant.outputs;
    unsigned doubts = certainty_doubts(&a->certainty);
    bool no_pairs = a->verdict == PAIRING_SINGULAR || a->verdict == PAIRING_IMPOSSIBLE;
    if (doubts &
        DOUBT_SIGN) /* an input that has not been seen by itself needs larger steps first */
        return false;
    if ((no_pairs && a->rank < least) || (doubts & (DOUBT_DETERMINANT | DOUBT_RANK)) != 0u)
        return true;
    return direction_gains_are_large(a);
}

bool direction_is_wanted(const struct commission *c)
{
    const struct analysis *a = &c->work->analysis;
    if (inputs_has_direction(&c->inputs) || inputs_count(&c->inputs) >= CHANNEL_MAX ||
        a->plant.inputs < 2u || a->plant.outputs < 2u || !acts_alike(a))
        return false;
    for (uint8_t j = 0; j < a->plant.outputs; j++)
        for (uint8_t i = 0; i < a->plant.inputs; i++)
            if (a->flags[j][i] & FLAGS_NO_SUM)
                return false;
    return true;
}

void direction_line_up(struct commission *c)
{
    const struct analysis *a = &c->work->analysis;
    real_t most = REAL_C(0.0);
    uint8_t largest = 0;
    memset(c->work->share, 0, sizeof c->work->share);
    for (uint8_t i = 0; i < a->plant.inputs; i++)
        if (real_abs(a->weakest[i]) > real_abs(most)) {
            most = a->weakest[i];
            largest = c->analysis_job.column[i];
        }
    for (uint8_t i = 0; i < a->plant.inputs; i++) {
        real_t share = a->weakest[i] / most;
        if (real_abs(share) >= SHARE_LEAST)
            c->work->share[c->analysis_job.column[i]] = share;
    }
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++)
        memset(&c->work->element[j][inputs_count(&c->inputs)], 0, sizeof c->work->element[0][0]);
    inputs_line_up_direction(&c->inputs, largest);
}

/* Largest response of output j to a level of 1, by the model and twice its error. */
static real_t largest_response(const struct commission *c, uint8_t j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    real_t longest_s = direction_over_s(c, j, PEAK_LAGS), variance = REAL_C(0.0);
    real_t most = REAL_C(0.0);
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++) {
        real_t sd = c->work->share[k] * c->work->element[j][k].found.sd[SHAPE_GAIN];
        variance += sd * sd;
    }
    for (unsigned n = 1; n <= PEAK_INSTANTS; n++) {
        real_t t_s = longest_s * (real_t)n / (real_t)PEAK_INSTANTS;
        real_t at = real_abs(direction_response(c, j, t_s));
        most = at > most ? at : most;
    }
    return most + REAL_C(2.0) * real_sqrt(variance);
}

/* Room of all inputs to both sides, for a share of 1. A step that is given for an input is the largest it makes. */
static real_t room_of_inputs(const struct commission *c, const struct supervisor *s)
{
    real_t most = AMPLITUDE_MOST;
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++) {
        const struct tested_input *in = inputs_get(&c->inputs, k);
        const struct mv_config *o = &s->plan->config.mv[in->output];
        real_t share = real_abs(c->work->share[k]);
        real_t room = commission_room(s, in->output, in->test_base);
        real_t given = o->start_up.step / (o->hi - o->lo);
        if (given > REAL_C(0.0) && given < room)
            room = given;
        if (most * share > room)
            most = room / share;
    }
    return most;
}

/* First amplitude: as large as the limits allow by the model, and a clear response at most. */
static real_t first_amplitude(const struct commission *c, const struct experiment_config *x)
{
    real_t a = x->amplitude_max, stands_out = REAL_C(0.0);
    for (uint8_t j = 0; j < x->outputs; j++) {
        real_t ends = direction_end(c, j), most = largest_response(c, j);
        real_t room = x->limit[j] - real_abs(origin_left(&c->origin, j));
        real_t noise_sd = outputs_noise(&c->outputs)[j];
        if (!(most * a < FIRST_SHARE * room))
            a = room > REAL_C(0.0) ? FIRST_SHARE * room / most : REAL_C(0.0);
        if (real_abs(ends) > stands_out * noise_sd)
            stands_out = real_abs(ends) / noise_sd;
    }
    real_t enough = DIRECTION_NOISE * x->noise_multiple;
    return a * stands_out > enough ? enough / stands_out : a;
}

void direction_config(const struct commission *c, const struct supervisor *s,
                      struct experiment_config *x)
{
    const struct tested_input *in = inputs_under_test(&c->inputs);
    real_t half_s = REAL_C(0.0);
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++) {
        real_t given_s = s->plan->config.mv[inputs_get(&c->inputs, k)->output].start_up.time_s;
        half_s = given_s > half_s ? given_s : half_s;
    }
    x->half = commission_samples(s, half_s);
    x->amplitude = REAL_C(0.0);
    x->amplitude_max = room_of_inputs(c, s);
    if (in->amplitude_most > REAL_C(0.0) && in->amplitude_most < x->amplitude_max)
        x->amplitude_max = in->amplitude_most;
    x->repeats = in->cut_retries < RETRIES_MAX;
    x->gains_unknown = false;
    x->amplitude_first =
        in->amplitude_wanted > REAL_C(0.0) ? in->amplitude_wanted : first_amplitude(c, x);
}

uint32_t direction_half(const struct commission *c, const struct supervisor *s)
{
    real_t longest_s = REAL_C(0.0);
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++) {
        real_t over_s = direction_over_s(c, j, HALF_TIMES * DIRECTION_LAGS);
        longest_s = over_s > longest_s ? over_s : longest_s;
    }
    return commission_samples(s, longest_s);
}

void direction_excite(const struct commission *c, struct supervisor *s, real_t level)
{
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++)
        supervisor_excite(s, inputs_get(&c->inputs, k)->output,
                          num_from_float(c->work->share[k] * level));
}

/* The sum of row j along the direction means something: so do its gains. */
static bool row_has_sum(const struct commission *c, uint8_t j, uint8_t n)
{
    REFLUX_ASSERT(j < CHANNEL_MAX && n < CHANNEL_MAX);
    if (c->work->element[j][n].flags & FLAGS_NO_SUM)
        return false;
    for (uint8_t i = 0; i < c->work->analysis.plant.inputs; i++)
        if (c->work->analysis.flags[j][i] & FLAGS_NO_SUM)
            return false;
    return true;
}

void direction_condition(struct commission *c, real_t floor)
{
    struct interact_plant *plant = &c->work->analysis.plant;
    uint8_t n = inputs_count(&c->inputs);
    if (!inputs_has_direction(&c->inputs) || inputs_get(&c->inputs, n)->rounds == 0)
        return;
    for (uint8_t k = 0; k < n; k++)
        if (inputs_get(&c->inputs, k)->skipped && real_abs(c->work->share[k]) > REAL_C(0.0))
            return; /* it is no part of the analysis */
    for (uint8_t i = 0; i < plant->inputs; i++)
        plant->share[i] = c->work->share[analysis_job_input(&c->analysis_job, i)];
    for (uint8_t j = 0; j < plant->outputs; j++) {
        const struct shape_found *f = &c->work->element[j][n].found;
        if (row_has_sum(c, j, n))
            direction_take(plant, j, floor, f->shape.gain, f->sd[SHAPE_GAIN]);
    }
}

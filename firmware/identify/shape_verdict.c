#include <stddef.h>

#include "base/assertion.h"
#include "identify/common.h"
#include "identify/shape_choice.h"
#include "identify/shape_response.h"
#include "identify/shape_search.h"

/* Variances of a point that a response explains at least, and beyond the logarithm of the points for each parameter. */
#define SIGNIFICANT  REAL_C(16.0)
#define BEYOND_NONE  REAL_C(4.0)
#define THIRD        REAL_C(0.33333)
#define PLAUSIBLE    REAL_C(0.1)   /* weight of a formula that makes an element slow */
#define COUNTED      REAL_C(0.002) /* least weight of a formula in the mixture */
#define OPEN         REAL_C(0.1)   /* share still to come with which an unsure gain is a slow one */
#define TAIL_LEAST   REAL_C(0.05)  /* share still to come of a tail that counts */
#define EXCESS       REAL_C(1.5)   /* variance of noise over its mean that is not surprising */
#define MISFIT_SHARE REAL_C(1.2)   /* error of the gain, over the misfit */
#define UNSEEN_DOUBT                                                                               \
    REAL_C(0.2) /* share of what is still to come, which the formula alone predicts */
#define MISFIT_MAX REAL_C(0.2) /* over the response, for a shape that means something */

static const uint8_t shape_parameter_counts[SHAPE_FORMULAS] = {3, 4, 5, 4};

/* Share of the response to the longest level that is still to come at its end, either sign. */
static real_t share_to_come(const struct shape_fit *f, enum shape_formula formula)
{
    const struct shape_candidate *c = &f->candidate[formula];
    struct shape_modes m;
    real_t lag, square, time = f->level - c->place.dead;
    if (!(time > ZERO))
        return ONE;
    shape_search_lags(f, formula, &c->place, &lag, &square);
    shape_modes_find(lag, square, &m);
    real_t zero = real_abs(c->gain) > ZERO ? c->gain_zero / c->gain : ZERO;
    return shape_response_to_come(&m, time, zero);
}

/* The numbers of a shape with the residence time in place of the lag. */
static void parameters_of(const struct shape_fit *f, enum shape_formula formula, real_t *number)
{
    struct shape s;
    shape_choice_shape(f, formula, &s);
    number[SHAPE_GAIN] = s.gain;
    number[SHAPE_DEAD] = s.dead_time_s;
    number[SHAPE_LAG] = shape_residence_s(&s);
    number[SHAPE_SQUARE] = s.square_s2;
    number[SHAPE_ZERO] = s.zero_s;
}

/* Error that the best formula leaves in the gain beyond the noise, and whether it is so large that the shape means nothing. */
static real_t gain_misfit(const struct shape_fit *f, enum shape_formula best, bool *hopeless)
{
    const struct shape_candidate *c = &f->candidate[best];
    real_t own = c->squares / (real_t)f->points;
    real_t noise = f->noise_variance > f->rough_variance ? f->noise_variance : f->rough_variance;
    real_t beyond = own - EXCESS * noise, response = f->total / (real_t)f->points;
    *hopeless = beyond > MISFIT_MAX * MISFIT_MAX * response;
    return beyond > ZERO ? MISFIT_SHARE * real_sqrt(beyond) / f->peak : ZERO;
}

/* Mixes slow tails in. sum: of the weights so far. Returns the variance that they add to the residence time. */
static real_t mix_tails(const struct shape_fit *f, const struct shape_weights *w, real_t sum,
                        const real_t *middle, real_t *within, real_t *lag)
{
    const struct shape_candidate *base = &f->candidate[f->tail_base];
    real_t all = sum, added = ZERO;
    for (unsigned k = 0; k < SHAPE_TAILS; k++)
        all += w->tail[k];
    for (unsigned n = 0; n < 15; n++)
        within[n] *= sum / all;
    *lag *= sum / all;
    for (unsigned k = 0; k < SHAPE_TAILS; k++) {
        const struct shape_tail *t = &f->tail[k];
        real_t share = w->tail[k] / all, number[SHAPE_PARAMETERS];
        if (!(share > ZERO))
            continue;
        parameters_of(f, (enum shape_formula)f->tail_base, number);
        real_t gain = number[SHAPE_GAIN] + t->gain - middle[SHAPE_GAIN];
        real_t residence = number[SHAPE_LAG] + t->residence_s - middle[SHAPE_LAG];
        unsigned n = 0;
        for (unsigned i = 0; i < SHAPE_PARAMETERS; i++)
            for (unsigned j = 0; j <= i; j++, n++)
                within[n] += share * base->covariance[n];
        within[0] += share * (gain * gain + t->gain_variance - base->covariance[0]);
        added += share * (residence * residence + t->residence_variance - base->covariance[5]);
        *lag += share * (residence * residence + t->residence_variance);
    }
    return added;
}

/* Mixes the plausible formulas about the chosen one, and packs. The integrator mixes with none. */
static void mix(const struct shape_fit *f, enum shape_formula chosen, const struct shape_weights *w,
                real_t misfit, struct shape_found *found)
{
    const real_t *weight = w->mixture;
    real_t within[15], middle[SHAPE_PARAMETERS], number[SHAPE_PARAMETERS], sum = ZERO;
    real_t lag = ZERO, part[SHAPE_FORMULAS];
    enum shape_formula other = chosen;
    for (unsigned k = 0; k < SHAPE_FORMULAS; k++) {
        bool mixes = k == (unsigned)chosen ||
                     (k != SHAPE_FORMULA_INTEGRATING && chosen != SHAPE_FORMULA_INTEGRATING);
        part[k] = mixes && weight[k] > COUNTED ? weight[k] : ZERO;
        sum += part[k];
        if (k != (unsigned)chosen && part[k] > ZERO && (other == chosen || part[k] > part[other]))
            other = (enum shape_formula)k;
    }
    for (unsigned n = 0; n < 15; n++)
        within[n] = ZERO;
    parameters_of(f, chosen, middle);
    struct shape shape, second;
    shape_choice_shape(f, chosen, &shape);
    shape_choice_shape(f, other, &second);
    for (unsigned k = 0; k < SHAPE_FORMULAS; k++) {
        if (!(part[k] > ZERO))
            continue;
        const struct shape_candidate *c = &f->candidate[k];
        real_t share = part[k] / sum;
        parameters_of(f, (enum shape_formula)k, number);
        real_t apart = number[SHAPE_LAG] - number[SHAPE_DEAD] + number[SHAPE_ZERO] - shape.lag_s;
        lag += share * (c->lag_variance + apart * apart);
        unsigned n = 0;
        for (unsigned i = 0; i < SHAPE_PARAMETERS; i++)
            for (unsigned j = 0; j <= i; j++, n++) {
                within[n] += share * c->covariance[n];
                if (k != (unsigned)other) /* the other one's difference is kept apart */
                    within[n] += share * (number[i] - middle[i]) * (number[j] - middle[j]);
            }
    }
    real_t tails = ZERO;
    if (chosen != SHAPE_FORMULA_INTEGRATING)
        tails = mix_tails(f, w, sum, middle, within, &lag);
    real_t doubt = chosen == SHAPE_FORMULA_INTEGRATING ? ZERO : share_to_come(f, chosen);
    doubt *= UNSEEN_DOUBT;
    within[0] += misfit * misfit + doubt * doubt * shape.gain * shape.gain;
    within[5] += doubt * doubt * shape.lag_s * shape.lag_s; /* the residence time's */
    lag += doubt * doubt * shape.lag_s * shape.lag_s;
    shape_found_pack(found, &shape, shape_parameter_counts[chosen], &second,
                     shape_parameter_counts[other], other == chosen ? ZERO : part[other] / sum,
                     within, lag);
    shape_found_add_tails(found, tails);
}

/* Makes of a shape what has been seen of it: its slow lag and its gain shrink by the share that is still to come, so that the
 * beginning stays. */
static void shrink_to_seen(struct shape *s, real_t to_come)
{
    real_t seen = to_come > ZERO ? ONE - to_come : ONE;
    real_t apart = s->lag_s * s->lag_s - REAL_C(4.0) * s->square_s2;
    seen = seen > REAL_C(1e-4) ? seen : REAL_C(1e-4);
    s->gain *= seen;
    if (!(apart > ZERO))
        return;
    real_t slow = REAL_C(0.5) * (s->lag_s + real_sqrt(apart)), fast = s->square_s2 / slow;
    s->lag_s = slow * seen + fast;
    s->square_s2 = slow * seen * fast;
}

static bool response_stands_out(const struct shape_fit *f, enum shape_formula best)
{
    const struct shape_candidate *c = &f->candidate[best];
    real_t least = BEYOND_NONE + (real_t)shape_parameter_counts[best] * real_log((real_t)f->points);
    real_t gained = f->total - c->squares, spread = c->squares / (real_t)f->points;
    spread = spread > f->noise_variance ? spread : f->noise_variance;
    spread *= (ONE + c->correlation) / (ONE - c->correlation);
    least = least > SIGNIFICANT ? least : SIGNIFICANT;
    return gained > least * spread && gained > ZERO;
}

/* The slow tail of a shape with a zero is as long as it may be: it is longer, or there is a drift beside it. One of which hardly
 * anything is to come, beside what has been seen, is noise. */
static bool tail_is_open(const struct shape_fit *f)
{
    return f->candidate[SHAPE_FORMULA_ZERO].place.time >= SHAPE_AT_BOUND * f->level &&
           real_abs(share_to_come(f, SHAPE_FORMULA_ZERO)) > TAIL_LEAST;
}

static enum shape_kind kind_found(const struct shape_fit *f, enum shape_formula chosen,
                                  const real_t *weight, const struct shape_found *found)
{
    bool slow = false, other_slow = false, perhaps_slow = real_abs(share_to_come(f, chosen)) > OPEN;
    for (unsigned k = 0; k < SHAPE_FORMULAS; k++) {
        if (k != (unsigned)chosen && !(weight[k] > COUNTED))
            continue;
        bool open = real_abs(share_to_come(f, (enum shape_formula)k)) > THIRD ||
                    (k == SHAPE_FORMULA_ZERO && tail_is_open(f));
        slow = slow || (open && k == (unsigned)chosen);
        other_slow = other_slow || (open && weight[k] > PLAUSIBLE);
        perhaps_slow = perhaps_slow || open;
    }
    if (chosen == SHAPE_FORMULA_INTEGRATING && f->ramp_agrees)
        return SHAPE_INTEGRATING;
    if (slow)
        return SHAPE_SLOW;
    if (other_slow)
        return SHAPE_PERHAPS_SLOW;
    if (found->sd[SHAPE_GAIN] > THIRD * real_abs(found->shape.gain))
        return perhaps_slow ? SHAPE_SLOW : SHAPE_UNKNOWN;
    if (chosen == SHAPE_FORMULA_ONE)
        return SHAPE_ONE_LAG;
    return chosen == SHAPE_FORMULA_TWO ? SHAPE_TWO_LAGS : SHAPE_TWO_WITH_ZERO;
}

void shape_choice_find(const struct shape_fit *f, struct shape_found *found)
{
    struct shape_weights weight;
    enum shape_formula chosen = SHAPE_FORMULA_ONE;
    shape_choice_weights(f, &weight);
    for (unsigned k = 0; k < SHAPE_FORMULAS; k++)
        if (weight.choice[k] > weight.choice[chosen])
            chosen = (enum shape_formula)k;
    *found = (struct shape_found){.kind = SHAPE_UNKNOWN};
    if (!response_stands_out(f, chosen)) {
        found->parameters = found->other_parameters = 1;
        found->shape.gain = f->plain_gain;
        found->shape.lag_s = REAL_C(0.25) * f->level * f->h_s;
        found->kind = f->plain_sd > ZERO ? (uint8_t)SHAPE_NO_RESPONSE : (uint8_t)SHAPE_UNKNOWN;
        found->sd[SHAPE_GAIN] = f->plain_sd;
        return;
    }
    bool hopeless;
    real_t misfit = gain_misfit(f, chosen, &hopeless);
    mix(f, chosen, &weight, misfit, found);
    found->kind =
        hopeless ? (uint8_t)SHAPE_UNKNOWN : (uint8_t)kind_found(f, chosen, weight.choice, found);
    if (found->kind == SHAPE_SLOW)
        shrink_to_seen(&found->shape, share_to_come(f, chosen));
}

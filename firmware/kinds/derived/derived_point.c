/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "kinds/derived/derived_point.h"

#include "base/assertion.h"
#include "base/channel.h"
#include "kinds/derived/derived_point_state.h"

#define ZERO          REAL_C(0.0)
#define MS            REAL_C(0.001)
#define LEAST_BY      REAL_C(0.1)
#define BOIL_MOST     REAL_C(0.41)
#define TIME_LEFT(ms) (UINT32_MAX - (ms))

/* ---- sums ---- */

/* Adds x with the exact error of the addition, whichever term is larger (two-sum, as num/accumulator.c). */
static void derived_add(struct derived_total *a, real_t x)
{
    real_t s = a->sum + x;
    real_t from_x = s - a->sum;
    real_t lost = (a->sum - (s - from_x)) + (x - from_x) + a->carry;
    a->sum = s + lost;
    a->carry = lost - (a->sum - s);
}

/* Moves the lag towards x, by backward Euler. Returns it. */
static real_t derived_lag(struct derived_point *p, real_t x, real_t lag_s, real_t passed_s)
{
    derived_add(&p->lagged, passed_s / (lag_s + passed_s) * (x - p->lagged.sum));
    return p->lagged.sum;
}

static uint8_t derived_worse(uint8_t a, uint8_t b)
{
    return a > b ? a : b;
}

struct derived_sum {
    real_t all;           /* over all inputs with a weight */
    real_t usable;        /* over those that are usable, */
    real_t weights;       /* and of their weights */
    uint8_t named, found; /* how many there are, and how many are usable */
    uint8_t best, worst;  /* worst quality of the usable ones, and of all */
    uint8_t counter;      /* the last one: the only one, where it is a counter */
};

static struct derived_sum derived_sum_of(const struct derived_turn *t, unsigned k)
{
    struct derived_sum s = {.best = QUALITY_GOOD, .worst = QUALITY_GOOD};
    for (uint8_t i = 0; i < t->inputs; i++) {
        real_t weight = t->settings->weight[k][i];
        if (weight == ZERO)
            continue;
        real_t term = weight * t->value[i];
        s.named++;
        s.counter = i;
        s.all += term;
        s.worst = derived_worse(s.worst, t->quality[i]);
        if (!quality_usable((enum quality)t->quality[i]))
            continue;
        s.found++;
        s.usable += term;
        s.weights += weight;
        s.best = derived_worse(s.best, t->quality[i]);
    }
    return s;
}

static void derived_let_pass(struct derived_point *p, uint32_t ms)
{
    p->since_ms = ms > TIME_LEFT(p->since_ms) ? UINT32_MAX : p->since_ms + ms;
}

static real_t derived_ms_per(uint8_t per)
{
    return per == DERIVED_PER_H     ? REAL_C(3600000.0)
           : per == DERIVED_PER_MIN ? REAL_C(60000.0)
                                    : REAL_C(1000.0);
}

/* ---- forms: each gives its value, and returns its quality ---- */

/* Adds the rate of rise, `ahead` seconds of it. */
static real_t derived_look_ahead(struct derived_point *p, const struct derived_turn *t, unsigned k,
                                 bool usable, real_t y)
{
    const struct derived_settings *s = t->settings;
    if (s->ahead_s[k] == ZERO)
        return y;
    if (!p->has_last || !usable || !t->passed_known)
        p->lagged = (struct derived_total){y, ZERO};
    p->has_last = usable;
    return y + s->ahead_s[k] * (y - derived_lag(p, y, s->lag_s[k], (real_t)t->passed_ms * MS)) /
                   s->lag_s[k];
}

static uint8_t derived_step_sum(struct derived_point *p, const struct derived_turn *t, unsigned k,
                                const struct derived_sum *sum, real_t *value)
{
    const struct derived_settings *s = t->settings;
    uint8_t quality = sum->worst, by = (uint8_t)s->by[k];
    real_t y = sum->all;
    if (by) {
        real_t d = t->value[by - 1u] / s->reference[k];
        quality = derived_worse(quality, t->quality[by - 1u]);
        if (d < LEAST_BY) {
            d = LEAST_BY;
            quality = derived_worse(quality, QUALITY_UNCERTAIN);
        }
        y /= s->power[k] > 1 ? d * d : d;
    }
    *value = derived_look_ahead(p, t, k, quality_usable((enum quality)quality), s->zero[k] + y);
    return quality;
}

static uint8_t derived_step_mean(const struct derived_turn *t, unsigned k,
                                 const struct derived_sum *sum, real_t *value)
{
    unsigned least = t->settings->least[k] ? t->settings->least[k] : sum->named;
    *value = t->settings->zero[k];
    if (sum->found < least)
        return sum->worst;
    *value += sum->usable / sum->weights;
    return sum->found == sum->named ? sum->best : (uint8_t)QUALITY_UNCERTAIN;
}

/* Takes what has changed since the last usable step: S, or a counter, which may have begun anew at `wrap`. Returns false if nobody knows, because
 * there was no such step, or because the counter has been put back. */
static bool derived_take_change(struct derived_point *p, const struct derived_turn *t, unsigned k,
                                const struct derived_sum *sum, real_t *change)
{
    real_t wrap = t->settings->wrap[k], present = wrap > ZERO ? t->value[sum->counter] : sum->all;
    bool known = p->has_last;
    *change = present - p->last;
    p->last = present;
    p->has_last = true;
    if (wrap == ZERO)
        return known;
    if (*change < REAL_C(-0.5) * wrap)
        *change += wrap;
    known = known && *change >= ZERO;
    *change *= t->settings->weight[k][sum->counter];
    return known;
}

static uint8_t derived_step_rate(struct derived_point *p, const struct derived_turn *t, unsigned k,
                                 const struct derived_sum *sum, real_t *value)
{
    real_t change;
    if (!t->passed_known) {
        p->has_last = p->begun = false;
        p->since_ms = 0;
    }
    derived_let_pass(p, t->passed_ms);
    *value = p->lagged.sum;
    if (!quality_usable((enum quality)sum->worst))
        return sum->worst;
    if (p->has_last && !p->since_ms) /* the same sample again */
        return p->begun ? sum->worst : (uint8_t)QUALITY_BAD;
    if (derived_take_change(p, t, k, sum, &change)) {
        real_t rate = change * (derived_ms_per(t->settings->per[k]) / (real_t)p->since_ms);
        if (!p->begun)
            p->lagged = (struct derived_total){rate, ZERO};
        p->begun = true;
        *value = derived_lag(p, rate, t->settings->lag_s[k], (real_t)p->since_ms * MS);
    }
    p->since_ms = 0;
    return p->begun ? sum->worst : (uint8_t)QUALITY_BAD;
}

/* A flow counts for the time that has passed since the one before it. A counter goes on while nobody reads it. */
static void derived_integrate(struct derived_point *p, const struct derived_turn *t, unsigned k,
                              const struct derived_sum *sum)
{
    bool counts = t->settings->wrap[k] > ZERO, missed = !counts && p->since_ms > t->bridge_ms;
    p->gap = p->gap || missed;
    if (!quality_usable((enum quality)sum->worst))
        return;
    real_t more = t->settings->zero[k] + sum->all;
    if (real_abs(more) < t->settings->cut[k])
        more = ZERO;
    more *= (real_t)p->since_ms / derived_ms_per(t->settings->per[k]);
    if (counts) {
        missed = !derived_take_change(p, t, k, sum, &more);
        p->gap = p->gap || missed;
    }
    if (!missed)
        derived_add(&p->total, more);
    else
        p->missed_ms =
            p->since_ms > TIME_LEFT(p->missed_ms) ? UINT32_MAX : p->missed_ms + p->since_ms;
    p->since_ms = 0;
}

static uint8_t derived_step_total(struct derived_point *p, const struct derived_turn *t, unsigned k,
                                  const struct derived_sum *sum, real_t *value)
{
    if (!t->passed_known) {
        p->gap = p->gap || !p->fresh;
        p->has_last = false;
    }
    p->fresh = false;
    derived_let_pass(p, t->passed_ms);
    derived_integrate(p, t, k, sum);
    *value = p->total.sum;
    return !p->begun ? (uint8_t)QUALITY_BAD
           : p->gap  ? derived_worse(sum->worst, QUALITY_UNCERTAIN)
                     : sum->worst;
}

static uint8_t derived_step_boil(const struct derived_turn *t, unsigned k,
                                 const struct derived_sum *sum, real_t *value)
{
    const struct derived_settings *s = t->settings;
    uint8_t by = (uint8_t)(s->by[k] - 1u), quality = derived_worse(sum->worst, t->quality[by]);
    real_t ratio = t->value[by] / s->reference[k];
    *value = s->zero[k] + sum->all;
    if (!(ratio > ZERO))
        return derived_worse(quality, QUALITY_BAD);
    real_t l = real_clamp(real_log(ratio), -BOIL_MOST, BOIL_MOST);
    *value -= s->slope[k] * s->reference[k] * l / (REAL_C(1.0) - s->bend[k] * l);
    return real_abs(l) < BOIL_MOST ? quality : derived_worse(quality, QUALITY_UNCERTAIN);
}

enum quality derived_point_step(struct derived_point *p, const struct derived_turn *t, unsigned k,
                                real_t *value)
{
    REFLUX_ASSERT(t->inputs <= DERIVED_INPUTS && k < DERIVED_POINTS &&
                  t->settings->by[k] <= t->inputs);
    const struct derived_sum sum = derived_sum_of(t, k);
    uint8_t form = t->settings->form[k];
    uint8_t quality = form == DERIVED_SUM     ? derived_step_sum(p, t, k, &sum, value)
                      : form == DERIVED_MEAN  ? derived_step_mean(t, k, &sum, value)
                      : form == DERIVED_RATE  ? derived_step_rate(p, t, k, &sum, value)
                      : form == DERIVED_TOTAL ? derived_step_total(p, t, k, &sum, value)
                                              : derived_step_boil(t, k, &sum, value);
    if (isfinite(*value))
        return (enum quality)quality;
    *value = ZERO;
    return (enum quality)derived_worse(quality, QUALITY_BAD);
}

/* ---- totals ---- */

void derived_point_reset(struct derived_point *p)
{
    p->total = (struct derived_total){ZERO, ZERO};
    p->begun = p->fresh = true;
    p->gap = false;
    p->since_ms = p->missed_ms = 0;
}

bool derived_point_has_gap(const struct derived_point *p)
{
    return p->begun && p->gap;
}

real_t derived_point_total(const struct derived_point *p)
{
    return p->begun ? p->total.sum : ZERO;
}

real_t derived_point_missed_s(const struct derived_point *p)
{
    return (real_t)p->missed_ms / REAL_C(1000.0);
}

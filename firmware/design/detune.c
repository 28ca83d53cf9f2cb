#include "design/detune.h"

#include <stddef.h>
#include <string.h>

#include "base/assertion.h"
#include "design/first_order.h"
#include "design/modes.h"

#define REFINED REAL_C(1.05) /* F is found to 5 % */

enum {
    STAGE_CHECK,
    STAGE_MARGIN,
    STAGE_FINAL,
    STAGE_TOGETHER, /* parts that were found one by one */
    STAGE_TOGETHER_MARGIN,
    STAGE_DONE
};

void detune_config_default(struct detune_config *config)
{
    *config = (struct detune_config){.db_per_loop = REAL_C(2.0),
                                     .db_most = REAL_C(6.0),
                                     .gain_margin = REAL_C(1.7),
                                     .factor_hi = REAL_C(200.0),
                                     .gain_hi = REAL_C(100.0),
                                     .noise_times = REAL_C(2.0)};
}

static enum err check_detuning(const struct detune_config *c, struct interact_refusal *reason)
{
    const struct interact_range ranges[] = {
        {c->db_per_loop, REAL_C(0.1), REAL_C(20.0), "db_per_loop", "0.1 to 20 dB"},
        {c->db_most, REAL_C(0.1), REAL_C(40.0), "db_most", "0.1 to 40 dB"},
        {c->gain_margin, REAL_C(1.0), REAL_C(10.0), "gain_margin", "1 to 10"},
        {c->factor_hi, REAL_C(1.0), REAL_C(1e4), "factor_hi", "1 to 1e4"},
        {c->gain_hi, REAL_C(1e-6), REAL_C(1e6), "gain_hi", "1e-6 to 1e6"},
        {c->noise_least, REAL_C(0.0), REAL_C(1.0), "noise_least", "0 to 1"},
        {c->noise_times, REAL_C(0.01), REAL_C(1e6), "noise_times", "0.01 to 1e6"}};
    return interact_check_ranges(ranges, sizeof ranges / sizeof ranges[0], reason);
}

/* Returns the way from the input of loop l to the output of loop k as one lag with dead time. */
static struct fopdt reduced_element(const struct detune *d, size_t k, size_t l)
{
    size_t i = d->loops.pairs.output[k], j = d->loops.pairs.input[l];
    return first_order_of(&d->plant->element[i][j], &d->plant->shape[i][j]);
}

/* Returns loop k with the decoupler: gain, mean dead time and mean residence time of the sum of its parts, K_kj D_jk
 * e^{-Ls}/(Ts + 1). Where parts cancel, a mean outside their range says nothing; the loop's own element stands in. */
static struct fopdt decoupled(const struct detune *d, size_t k)
{
    REFLUX_ASSERT(k < d->loops.pairs.n);
    const struct loops *loops = &d->loops;
    const struct fopdt own = reduced_element(d, k, k);
    real_t gain = REAL_C(0.0), dead = REAL_C(0.0), lag = REAL_C(0.0);
    real_t dead_hi = own.dead_time_s, dead_lo = own.dead_time_s;
    real_t lag_hi = own.time_constant_s, lag_lo = own.time_constant_s;
    for (size_t j = 0; j < loops->pairs.n; j++) {
        const struct fopdt e = reduced_element(d, k, j);
        real_t part = e.gain * loops->decoupler->value[j][k];
        if (real_abs(part) <= REAL_C(0.0))
            continue;
        gain += part;
        dead += part * e.dead_time_s;
        lag += part * e.time_constant_s;
        dead_hi = e.dead_time_s > dead_hi ? e.dead_time_s : dead_hi;
        dead_lo = e.dead_time_s < dead_lo ? e.dead_time_s : dead_lo;
        lag_hi = e.time_constant_s > lag_hi ? e.time_constant_s : lag_hi;
        lag_lo = e.time_constant_s < lag_lo ? e.time_constant_s : lag_lo;
    }
    dead = dead / gain;
    lag = lag / gain;
    return (struct fopdt){gain, real_within(dead, dead_lo, dead_hi) ? dead : own.dead_time_s,
                          real_within(lag, lag_lo, lag_hi) ? lag : own.time_constant_s};
}

static enum err set_models(struct detune *d, struct interact_refusal *reason)
{
    const struct loops *loops = &d->loops;
    *reason = (struct interact_refusal){"gains", "a matrix with an inverse", INTERACT_NONE,
                                        INTERACT_NONE};
    interact_gains(d->plant, &loops->pairs, &d->work.begin.gains);
    if (rga_compute(&d->work.begin.gains, &d->work.begin.rga, &d->work.begin.lambda))
        return ERR_SINGULAR;
    for (size_t k = 0; k < loops->pairs.n; k++) {
        struct fopdt *m = &d->model[k];
        real_t lambda = d->work.begin.lambda.value[k][k];
        *m = reduced_element(d, k, k);
        if (loops->decoupler)
            *m = decoupled(d, k);
        else if (lambda > REAL_C(0.0) && lambda < REAL_C(1.0))
            m->gain = m->gain / lambda;
        *reason = (struct interact_refusal){"gain", "not 0: a loop needs an input that acts",
                                            loops->pairs.output[k], loops->pairs.input[k]};
        if (!real_within(real_abs(m->gain), REAL_C(1e-9), REAL_C(1e9)))
            return ERR_RANGE;
        real_t half = loops->interval_s * REAL_C(0.5);
        m->dead_time_s = m->dead_time_s + half; /* the hold */
        if (m->time_constant_s < half)
            m->time_constant_s = half;
    }
    return ERR_OK;
}

/* Through g/(T s + 1), held for h, g sqrt((1 - a)/(1 + a)), a = exp(-h/T), of what changes from one sample to the next. */
static real_t passes(const struct interact_plant *plant, size_t j, size_t i, real_t interval_s)
{
    REFLUX_ASSERT(j < plant->outputs && i < plant->inputs);
    const struct fopdt *e = &plant->element[j][i];
    const struct interact_shape *shape = &plant->shape[j][i];
    if (!interact_one_lag(shape)) {
        struct modes modes;
        modes_of(e, shape, &modes);
        return e->gain * modes_noise(&modes, interval_s);
    }
    real_t a = REAL_C(0.0);
    if (e->time_constant_s > REAL_C(0.0))
        a = real_exp(-interval_s / e->time_constant_s);
    return e->gain * real_sqrt((REAL_C(1.0) - a) / (REAL_C(1.0) + a));
}

/* ... from controller k to output j. */
static real_t passes_from(const struct interact_plant *plant, const struct loops *loops, size_t j,
                          size_t k)
{
    const struct pairs *p = &loops->pairs;
    real_t h = loops->interval_s;
    if (!loops->decoupler)
        return passes(plant, j, p->input[k], h);
    real_t sum = REAL_C(0.0);
    for (size_t l = 0; l < p->n; l++)
        sum += passes(plant, j, p->input[l], h) * loops->decoupler->value[l][k];
    return sum;
}

/* Noise s of a measurement moves what the controller puts out by K_c s. */
real_t detune_largest_gain(const struct interact_plant *plant, const struct loops *loops,
                           const struct detune_config *c, uint8_t k)
{
    REFLUX_ASSERT(k < loops->pairs.n);
    real_t largest = c->gain_hi;
    if (!c->noise_sd)
        return largest;
    real_t noise = c->noise_sd[loops->pairs.output[k]];
    for (size_t j = 0; j < plant->outputs && noise > c->noise_least; j++) {
        real_t moves = real_abs(passes_from(plant, loops, j, k)) * noise;
        real_t most = c->noise_times * c->noise_sd[j];
        if (most > REAL_C(0.0) && moves * largest > most)
            largest = most / moves;
    }
    return largest;
}

/* SIMC with tau_c = F max(theta, T/8) for every loop of the part. */
static enum err set_tuning(struct detune *d, real_t factor)
{
    for (size_t i = 0; i < d->part.pairs.n; i++) {
        size_t k = d->place[i];
        const struct fopdt *m = &d->model[k];
        real_t least = m->time_constant_s * REAL_C(0.125);
        real_t tau_c = factor * (m->dead_time_s > least ? m->dead_time_s : least);
        struct tuning *t = &d->loops.tuning[k];
        enum err err = tuning_simc_pi(m, tau_c < REAL_C(1e6) ? tau_c : REAL_C(1e6), t, NULL);
        if (err)
            return err;
        real_t largest = detune_largest_gain(d->plant, &d->loops, &d->config, (uint8_t)k);
        if (t->gain > largest) { /* as with the larger tau_c that would have given this gain */
            real_t ti = t->ti_s * (t->gain / largest);
            t->gain = largest;
            t->ti_s = ti < m->time_constant_s ? ti : m->time_constant_s;
        }
        d->part.tuning[i] = *t;
    }
    d->part_factor = factor;
    d->tried++;
    return ERR_OK;
}

static real_t limit_db(const struct detune *d)
{
    real_t db = d->config.db_per_loop * (real_t)d->part.pairs.n;
    return db < d->config.db_most ? db : d->config.db_most;
}

/* Tries a factor: first the distance, then the margin. */
static enum err try_factor(struct detune *d, real_t factor)
{
    enum err err = set_tuning(d, factor);
    if (err)
        return err;
    d->stage = STAGE_CHECK;
    return nyquist_begin(&d->work.nyquist, d->plant, &d->part, REAL_C(1.0), limit_db(d));
}

/* The loops that are in the part of the first that is in none yet; all of them where they are joint. */
static enum err begin_part(struct detune *d)
{
    const struct loops *all = &d->loops;
    struct loops *part = &d->part;
    size_t first = 0;
    while (((unsigned)d->done >> first & 1u) != 0u)
        first++;
    REFLUX_ASSERT(first < all->pairs.n);
    *part = *all;
    part->pairs.n = 0;
    for (size_t k = first; k < all->pairs.n; k++) {
        if (!d->joint && d->config.part[k] != d->config.part[first])
            continue;
        d->place[part->pairs.n] = (uint8_t)k;
        part->pairs.output[part->pairs.n] = all->pairs.output[k];
        part->pairs.input[part->pairs.n++] = all->pairs.input[k];
        d->done = (uint16_t)(d->done | 1u << k);
    }
    if (all->decoupler) {
        d->part_decoupler.rows = d->part_decoupler.cols = part->pairs.n;
        for (size_t i = 0; i < part->pairs.n; i++)
            for (size_t j = 0; j < part->pairs.n; j++)
                d->part_decoupler.value[i][j] = all->decoupler->value[d->place[i]][d->place[j]];
        part->decoupler = &d->part_decoupler;
    }
    d->lo = REAL_C(1.0);
    d->hi = REAL_C(0.0);
    return try_factor(d, REAL_C(1.0));
}

/* From the first part on. */
static enum err begin_parts(struct detune *d, bool joint)
{
    d->joint = joint;
    d->failed = false;
    d->done = 0;
    d->factor = REAL_C(0.0);
    return begin_part(d);
}

enum err detune_begin(struct detune *d, const struct interact_plant *plant,
                      const struct pairs *pairs, real_t interval_s, const struct matrix *decoupler,
                      const struct detune_config *config, struct interact_refusal *reason)
{
    struct interact_refusal unused;
    reason = reason ? reason : &unused;
    enum err err = interact_check(plant, reason);
    if (!err)
        err = check_detuning(config, reason);
    if (err)
        return err;
    for (uint8_t j = 0; config->noise_sd && j < plant->outputs; j++)
        if (!real_within(config->noise_sd[j], REAL_C(0.0), REAL_C(1e3))) {
            *reason = (struct interact_refusal){"noise_sd", "0 to 1000", j, INTERACT_NONE};
            return ERR_RANGE;
        }
    memset(d, 0, sizeof *d);
    d->plant = plant;
    d->config = *config;
    d->loops.pairs = *pairs;
    d->loops.interval_s = interval_s;
    d->loops.derivative_filter = REAL_C(8.0);
    d->loops.decoupler = decoupler;
    for (size_t k = 0; k < INTERACT_MAX;
         k++) /* anything valid: the rest is what is to be checked */
        d->loops.tuning[k] = (struct tuning){.gain = REAL_C(1.0), .ti_s = REAL_C(1.0)};
    err = loops_check(plant, &d->loops, reason);
    if (!err)
        err = set_models(d, reason);
    if (err)
        return err;
    err = begin_parts(d, false);
    *reason =
        err ? (struct interact_refusal){"gain, time_constant_s", "such that a PI can be tuned",
                                        INTERACT_NONE, INTERACT_NONE}
            : (struct interact_refusal){"", "", INTERACT_NONE, INTERACT_NONE};
    return err;
}

static enum err busy_or_error(enum err err)
{
    return err ? err : ERR_BUSY;
}

/* The next factor: twice as slow while none has been good, then between; the last one good is checked once more at the
 * end, without a limit, for its figures. */
static enum err next_factor(struct detune *d, bool good)
{
    if (good)
        d->hi = d->part_factor;
    else
        d->lo = d->part_factor;
    enum err err;
    if (d->hi <= REAL_C(0.0) && d->lo < d->config.factor_hi) {
        real_t next = d->lo * REAL_C(2.0);
        err = try_factor(d, next < d->config.factor_hi ? next : d->config.factor_hi);
    } else if (d->hi > REAL_C(1.0) && d->hi > d->lo * REFINED) {
        err = try_factor(d, real_sqrt(d->lo * d->hi));
    } else {
        err = set_tuning(d, d->hi > REAL_C(0.0) ? d->hi : d->config.factor_hi);
        d->tried--;
        d->stage = STAGE_FINAL;
        if (!err)
            err = nyquist_begin(&d->work.nyquist, d->plant, &d->part, REAL_C(1.0), INFINITY);
    }
    return busy_or_error(err);
}

static enum err look_at_all(struct detune *d, uint8_t stage, real_t gain_times)
{
    d->stage = stage;
    return busy_or_error(
        nyquist_begin(&d->work.nyquist, d->plant, &d->loops, gain_times, INFINITY));
}

static enum err close_search(struct detune *d)
{
    d->stage = STAGE_DONE;
    return d->failed ? ERR_TIMEOUT : ERR_OK;
}

/* A part has its settings. */
static enum err end_part(struct detune *d, bool good)
{
    const struct nyquist *n = &d->work.nyquist;
    bool first = d->factor <= REAL_C(0.0);
    if (first || n->log_modulus_db > d->log_modulus_db) {
        d->log_modulus_db = n->log_modulus_db;
        d->omega = n->omega;
    }
    if (first || d->part_factor > d->factor)
        d->factor = d->part_factor;
    if (first || d->part_factor < d->factor_least)
        d->factor_least = d->part_factor;
    d->failed = d->failed || !good || d->hi <= REAL_C(0.0);
    if (d->done != (uint16_t)((1ul << d->loops.pairs.n) - 1u))
        return busy_or_error(begin_part(d));
    if (d->failed || d->part.pairs.n == d->loops.pairs.n)
        return close_search(d);
    return look_at_all(d, STAGE_TOGETHER, REAL_C(1.0));
}

enum err detune_step(struct detune *d)
{
    if (d->stage == STAGE_DONE)
        return ERR_STATE;
    enum err err = nyquist_step(&d->work.nyquist);
    if (err == ERR_BUSY)
        return err;
    bool good = err == ERR_OK && d->work.nyquist.stable;
    if (d->stage == STAGE_FINAL)
        return end_part(d, good);
    if (d->stage == STAGE_TOGETHER && good)
        return look_at_all(d, STAGE_TOGETHER_MARGIN, d->config.gain_margin);
    if (d->stage == STAGE_TOGETHER_MARGIN && good)
        return close_search(d);
    if (d->stage == STAGE_TOGETHER || d->stage == STAGE_TOGETHER_MARGIN)
        return busy_or_error(begin_parts(d, true)); /* they do act on each other */
    if (d->stage == STAGE_CHECK && good) {
        d->stage = STAGE_MARGIN;
        return busy_or_error(
            nyquist_begin(&d->work.nyquist, d->plant, &d->part, d->config.gain_margin, INFINITY));
    }
    return next_factor(d, good);
}

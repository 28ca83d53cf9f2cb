#include "design/loops.h"

#include <stdbool.h>
#include <stddef.h>

#include "base/assertion.h"
#include "design/modes.h"
#include "num/real_trig.h"

static enum err refuse_pair(struct interact_refusal *reason, const char *field, const char *wanted,
                            uint8_t k, const struct pairs *pairs)
{
    *reason = (struct interact_refusal){field, wanted, INTERACT_NONE, INTERACT_NONE};
    if (k != INTERACT_NONE) {
        reason->output = pairs->output[k];
        reason->input = pairs->input[k];
    }
    return ERR_RANGE;
}

enum err loops_check(const struct interact_plant *plant, const struct loops *loops,
                     struct interact_refusal *reason)
{
    struct interact_refusal unused;
    reason = reason ? reason : &unused;
    const struct pairs *p = &loops->pairs;
    enum err err = pairs_check(plant, p, reason);
    if (err)
        return err;
    if (p->n < 1)
        return refuse_pair(reason, "pairs", "at least one", INTERACT_NONE, p);
    if (!real_within(loops->interval_s, REAL_C(1e-3), REAL_C(1e5)))
        return refuse_pair(reason, "interval_s", "0.001 to 1e5 s", INTERACT_NONE, p);
    if (!real_within(loops->derivative_filter, REAL_C(1.0), REAL_C(100.0)))
        return refuse_pair(reason, "derivative_filter", "1 to 100", INTERACT_NONE, p);
    for (uint8_t k = 0; k < p->n; k++) {
        const struct tuning *t = &loops->tuning[k];
        if (!real_within(t->gain, REAL_C(1e-9), REAL_C(1e9)))
            return refuse_pair(reason, "gain", "1e-9 to 1e9", k, p);
        if (!real_within(t->ti_s, REAL_C(1e-3), REAL_C(1e7)))
            return refuse_pair(reason, "ti_s", "0.001 to 1e7 s", k, p);
        if (!real_within(t->td_s, REAL_C(0.0), REAL_C(1e6)))
            return refuse_pair(reason, "td_s", "0 to 1e6 s", k, p);
    }
    if (!loops->decoupler)
        return ERR_OK;
    if (loops->decoupler->rows != p->n || loops->decoupler->cols != p->n)
        return refuse_pair(reason, "decoupler", "a row and a column for every loop", INTERACT_NONE,
                           p);
    return matrix_check(loops->decoupler);
}

void loops_sample(const struct interact_plant *plant, const struct loops *loops,
                  uint16_t delay_most, real_t step_least_s, struct loops_sampled *sampled)
{
    REFLUX_ASSERT(loops->pairs.n <= INTERACT_MAX);
    const struct pairs *p = &loops->pairs;
    real_t h = loops->interval_s > step_least_s ? loops->interval_s : step_least_s;
    for (size_t k = 0; k < p->n; k++)
        for (size_t l = 0; l < p->n; l++) {
            real_t dead = plant->element[p->output[k]][p->input[l]].dead_time_s;
            if (dead > h * (real_t)delay_most)
                h = dead / (real_t)delay_most;
        }
    sampled->plant = plant;
    sampled->step_s = h;
    for (size_t k = 0; k < p->n; k++)
        for (size_t l = 0; l < p->n; l++) {
            const struct fopdt *e = &plant->element[p->output[k]][p->input[l]];
            real_t samples = e->dead_time_s / h, rise[2], late[2];
            uint32_t whole = (uint32_t)samples;
            real_t rest = (REAL_C(1.0) - (samples - (real_t)whole)) * h;
            struct modes modes;
            modes_of(e, &plant->shape[p->output[k]][p->input[l]], &modes);
            modes_rise(&modes, h, h, rise);
            modes_rise(&modes, rest, h, late);
            sampled->delay[k][l] = (uint16_t)whole;
            sampled->rise[k][l] = rise[0];
            sampled->rise_late[k][l] = late[0];
            sampled->second[k][l] = rise[1];
            sampled->second_late[k][l] = late[1];
        }
}

struct cplx loops_z_less_1(real_t omega_h)
{
    real_t half_sine, half_cosine;
    real_sincos(omega_h * REAL_C(0.5), &half_sine, &half_cosine);
    return cplx(REAL_C(-2.0) * half_sine * half_sine, REAL_C(2.0) * half_sine * half_cosine);
}

struct cplx loops_controller(const struct loops *loops, uint8_t k, real_t step_s,
                             struct cplx z_less_1)
{
    REFLUX_ASSERT(k < loops->pairs.n);
    const struct tuning *t = &loops->tuning[k];
    struct cplx c = cplx_div(cplx(step_s / t->ti_s, REAL_C(0.0)), z_less_1);
    c.re += REAL_C(1.0);
    if (t->td_s > REAL_C(0.0)) {
        /* 1/z is the conjugate: 1 - 1/z = -(conj(z) - 1) */
        struct cplx moved = cplx_scale(cplx_conj(z_less_1), REAL_C(-1.0));
        real_t tf = t->td_s / loops->derivative_filter;
        struct cplx below = cplx_scale(moved, tf);
        below.re += step_s;
        c = cplx_add(c, cplx_div(cplx_scale(moved, t->td_s), below));
    }
    return cplx_scale(c, t->action == TUNING_DIRECT ? -t->gain : t->gain);
}

/* The lag of a pole -rate + i turn, or of its conjugate: its rise is complex. */
static struct cplx conjugate_lag(struct cplx rise, struct cplx late, struct cplx z_less_1)
{
    struct cplx back = cplx_conj(z_less_1);
    struct cplx above = cplx_add(rise, cplx_mul(cplx_sub(rise, late), back));
    return cplx_div(above, cplx_add(z_less_1, rise));
}

/* (rise_late + (rise - rise_late)/z)/(z - 1 + rise) */
static struct cplx real_lag(real_t rise, real_t late, struct cplx z_less_1)
{
    struct cplx back = cplx_conj(z_less_1);
    struct cplx above = cplx(rise + (rise - late) * back.re, (rise - late) * back.im);
    return cplx_div(above, cplx(z_less_1.re + rise, z_less_1.im));
}

/* The lags of element (k, l), of plant element (i, j), without gain and delay. */
static struct cplx two_lags(const struct loops_sampled *s, size_t k, size_t l,
                            const struct modes *modes, struct cplx z_less_1)
{
    REFLUX_ASSERT(k < INTERACT_MAX && l < INTERACT_MAX);
    real_t share = modes->share;
    if (!modes->conjugate) {
        struct cplx first = real_lag(s->rise[k][l], s->rise_late[k][l], z_less_1);
        struct cplx other = real_lag(s->second[k][l], s->second_late[k][l], z_less_1);
        return cplx_add(cplx_scale(first, share), cplx_scale(other, REAL_C(1.0) - share));
    }
    struct cplx rise = cplx(s->rise[k][l], s->second[k][l]);
    struct cplx late = cplx(s->rise_late[k][l], s->second_late[k][l]);
    struct cplx up = conjugate_lag(rise, late, z_less_1);
    struct cplx down = conjugate_lag(cplx_conj(rise), cplx_conj(late), z_less_1);
    /* Re x is half of the sum of both, Im x half of the difference over i. */
    struct cplx sum = cplx_add(up, down), difference = cplx_sub(up, down);
    return cplx(REAL_C(0.5) * (sum.re + share * difference.im),
                REAL_C(0.5) * (sum.im - share * difference.re));
}

/* gain z^-delay times the lags */
static struct cplx element_response(const struct loops *loops, const struct loops_sampled *s,
                                    size_t k, size_t l, real_t angle, struct cplx z_less_1)
{
    size_t i = loops->pairs.output[k], j = loops->pairs.input[l];
    const struct fopdt *e = &s->plant->element[i][j];
    const struct interact_shape *shape = &s->plant->shape[i][j];
    real_t rise = s->rise[k][l], late = s->rise_late[k][l], sine, cosine;
    real_sincos(angle * (real_t)s->delay[k][l], &sine, &cosine);
    if (!interact_one_lag(shape)) {
        struct modes modes;
        modes_of(e, shape, &modes);
        struct cplx lags = two_lags(s, k, l, &modes, z_less_1);
        return cplx_scale(cplx_mul(lags, cplx(cosine, -sine)), e->gain);
    }
    struct cplx back = cplx_conj(z_less_1); /* 1/z - 1 */
    struct cplx above = cplx(rise + (rise - late) * back.re, (rise - late) * back.im);
    above = cplx_scale(cplx_mul(above, cplx(cosine, -sine)), e->gain);
    return cplx_div(above, cplx(z_less_1.re + rise, z_less_1.im));
}

void loops_open(const struct loops *loops, const struct loops_sampled *sampled, real_t omega,
                struct cplx open[INTERACT_MAX][MATRIX_MAX])
{
    REFLUX_ASSERT(loops->pairs.n <= INTERACT_MAX);
    size_t n = loops->pairs.n;
    real_t angle = omega * sampled->step_s;
    struct cplx z_less_1 = loops_z_less_1(angle);
    for (size_t k = 0; k < n; k++) {
        struct cplx row[INTERACT_MAX];
        for (size_t l = 0; l < n; l++)
            row[l] = element_response(loops, sampled, k, l, angle, z_less_1);
        for (size_t l = 0; l < n; l++) {
            open[k][l] = row[l];
            if (!loops->decoupler)
                continue;
            open[k][l] = cplx(REAL_C(0.0), REAL_C(0.0));
            for (size_t j = 0; j < n; j++)
                open[k][l] =
                    cplx_add(open[k][l], cplx_scale(row[j], loops->decoupler->value[j][l]));
        }
    }
    for (size_t l = 0; l < n; l++) {
        struct cplx c = loops_controller(loops, (uint8_t)l, sampled->step_s, z_less_1);
        for (size_t k = 0; k < n; k++)
            open[k][l] = cplx_mul(open[k][l], c);
    }
}

real_t loops_advance(const struct loops *loops, const struct loops_sampled *sampled, size_t k,
                     size_t l, real_t before, real_t after, real_t *state, real_t *second)
{
    REFLUX_ASSERT(k < loops->pairs.n && l < loops->pairs.n);
    size_t i = loops->pairs.output[k], j = loops->pairs.input[l];
    const struct fopdt *e = &sampled->plant->element[i][j];
    const struct interact_shape *shape = &sampled->plant->shape[i][j];
    real_t rise = sampled->rise[k][l], late = sampled->rise_late[k][l];
    if (interact_one_lag(shape)) {
        *state += (rise - late) * before + late * after - rise * *state;
        return e->gain * *state;
    }
    struct modes modes;
    modes_of(e, shape, &modes);
    real_t rise_2 = sampled->second[k][l], late_2 = sampled->second_late[k][l];
    real_t x = *state, y = *second;
    if (!modes.conjugate) {
        *state += (rise - late) * before + late * after - rise * x;
        *second += (rise_2 - late_2) * before + late_2 * after - rise_2 * y;
        return e->gain * (modes.share * *state + (REAL_C(1.0) - modes.share) * *second);
    }
    *state += (rise - late) * before + late * after - (rise * x - rise_2 * y);
    *second += (rise_2 - late_2) * before + late_2 * after - (rise * y + rise_2 * x);
    return e->gain * (*state + modes.share * *second);
}

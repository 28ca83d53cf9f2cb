#include "design/loops.h"

#include <stdbool.h>
#include <stddef.h>

#include "base/assertion.h"
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

/* 1 - exp(-x), x at least 0. */
static real_t rise_of(real_t x)
{
    if (x > REAL_C(0.01))
        return REAL_C(1.0) - real_exp(-x);
    real_t sum = REAL_C(1.0); /* Taylor to x^7, from the back */
    for (int n = 7; n > 1; n--)
        sum = REAL_C(1.0) - sum * x / (real_t)n;
    return sum * x;
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
    sampled->step_s = h;
    for (size_t k = 0; k < p->n; k++)
        for (size_t l = 0; l < p->n; l++) {
            const struct fopdt *e = &plant->element[p->output[k]][p->input[l]];
            real_t samples = e->dead_time_s / h, tau = e->time_constant_s;
            uint32_t whole = (uint32_t)samples;
            real_t rest = (REAL_C(1.0) - (samples - (real_t)whole)) * h;
            bool at_once = tau < REAL_C(1e-3) * h;
            sampled->gain[k][l] = e->gain;
            sampled->delay[k][l] = (uint16_t)whole;
            sampled->rise[k][l] = at_once ? REAL_C(1.0) : rise_of(h / tau);
            sampled->rise_late[k][l] = at_once ? REAL_C(1.0) : rise_of(rest / tau);
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

/* gain z^-delay (rise_late + (rise - rise_late)/z)/(z - 1 + rise) */
static struct cplx element_response(const struct loops_sampled *s, size_t k, size_t l, real_t angle,
                                    struct cplx z_less_1)
{
    real_t rise = s->rise[k][l], late = s->rise_late[k][l], sine, cosine;
    struct cplx back = cplx_conj(z_less_1); /* 1/z - 1 */
    struct cplx above = cplx(rise + (rise - late) * back.re, (rise - late) * back.im);
    real_sincos(angle * (real_t)s->delay[k][l], &sine, &cosine);
    above = cplx_scale(cplx_mul(above, cplx(cosine, -sine)), s->gain[k][l]);
    return cplx_div(above, cplx(z_less_1.re + rise, z_less_1.im));
}

void loops_open(const struct loops *loops, const struct loops_sampled *sampled, real_t omega,
                struct cmatrix *open)
{
    REFLUX_ASSERT(loops->pairs.n <= INTERACT_MAX);
    size_t n = loops->pairs.n;
    real_t angle = omega * sampled->step_s;
    struct cplx z_less_1 = loops_z_less_1(angle);
    open->rows = open->cols = loops->pairs.n;
    for (size_t k = 0; k < n; k++) {
        struct cplx row[INTERACT_MAX];
        for (size_t l = 0; l < n; l++)
            row[l] = element_response(sampled, k, l, angle, z_less_1);
        for (size_t l = 0; l < n; l++) {
            open->value[k][l] = row[l];
            if (!loops->decoupler)
                continue;
            open->value[k][l] = cplx(REAL_C(0.0), REAL_C(0.0));
            for (size_t j = 0; j < n; j++)
                open->value[k][l] =
                    cplx_add(open->value[k][l], cplx_scale(row[j], loops->decoupler->value[j][l]));
        }
    }
    for (size_t l = 0; l < n; l++) {
        struct cplx c = loops_controller(loops, (uint8_t)l, sampled->step_s, z_less_1);
        for (size_t k = 0; k < n; k++)
            open->value[k][l] = cplx_mul(open->value[k][l], c);
    }
}

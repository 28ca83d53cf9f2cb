#include "design/loops.h"

#include <stdbool.h>
#include <stddef.h>

#include "num/real_trig.h"

static bool within(real_t x, real_t lo, real_t hi)
{
    return x >= lo && x <= hi; /* false for NaN */
}

static enum err refuse(struct interact_refusal *why, const char *field, const char *wanted,
                       uint8_t k, const struct pairs *pairs)
{
    *why = (struct interact_refusal){field, wanted, INTERACT_NONE, INTERACT_NONE};
    if (k != INTERACT_NONE) {
        why->output = pairs->output[k];
        why->input = pairs->input[k];
    }
    return ERR_RANGE;
}

enum err loops_check(const struct interact_plant *plant, const struct loops *loops,
                     struct interact_refusal *why)
{
    struct interact_refusal unused;
    why = why ? why : &unused;
    const struct pairs *p = &loops->pairs;
    enum err err = pairs_check(plant, p, why);
    if (err)
        return err;
    if (p->n < 1)
        return refuse(why, "pairs", "at least one", INTERACT_NONE, p);
    if (!within(loops->interval_s, REAL_C(1e-3), REAL_C(1e5)))
        return refuse(why, "interval_s", "0.001 to 1e5 s", INTERACT_NONE, p);
    if (!within(loops->derivative_filter, REAL_C(1.0), REAL_C(100.0)))
        return refuse(why, "derivative_filter", "1 to 100", INTERACT_NONE, p);
    for (uint8_t k = 0; k < p->n; k++) {
        const struct tuning *t = &loops->tuning[k];
        if (!within(t->gain, REAL_C(1e-9), REAL_C(1e9)))
            return refuse(why, "gain", "1e-9 to 1e9", k, p);
        if (!within(t->ti_s, REAL_C(1e-3), REAL_C(1e7)))
            return refuse(why, "ti_s", "0.001 to 1e7 s", k, p);
        if (!within(t->td_s, REAL_C(0.0), REAL_C(1e6)))
            return refuse(why, "td_s", "0 to 1e6 s", k, p);
    }
    if (!loops->decoupler)
        return ERR_OK;
    if (loops->decoupler->rows != p->n || loops->decoupler->cols != p->n)
        return refuse(why, "decoupler", "a row and a column for every loop", INTERACT_NONE, p);
    return matrix_check(loops->decoupler);
}

void loops_sample(const struct interact_plant *plant, const struct loops *loops,
                  uint16_t delay_most, real_t step_least_s, struct loops_sampled *sampled)
{
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
            sampled->decay[k][l] = at_once ? REAL_C(0.0) : real_exp(-h / tau);
            sampled->late_part[k][l] = at_once ? REAL_C(0.0) : real_exp(-rest / tau);
        }
}

struct cplx loops_controller(const struct loops *loops, uint8_t k, real_t step_s, struct cplx z)
{
    const struct tuning *t = &loops->tuning[k];
    struct cplx one = cplx(REAL_C(1.0), REAL_C(0.0));
    struct cplx c = cplx_div(cplx(step_s / t->ti_s, REAL_C(0.0)), cplx_sub(z, one));
    c = cplx_add(c, one);
    if (t->td_s > REAL_C(0.0)) {
        struct cplx back = cplx_conj(z); /* 1/z on the unit circle */
        real_t tf = t->td_s / loops->derivative_filter;
        struct cplx below = cplx_sub(cplx(tf + step_s, REAL_C(0.0)), cplx_scale(back, tf));
        c = cplx_add(c, cplx_div(cplx_scale(cplx_sub(one, back), t->td_s), below));
    }
    return cplx_scale(c, t->action == TUNING_DIRECT ? -t->gain : t->gain);
}

/* gain z^-delay (1 - late + (late - decay)/z)/(z - decay) */
static struct cplx element_response(const struct loops_sampled *s, size_t k, size_t l, real_t angle,
                                    struct cplx z)
{
    real_t a = s->decay[k][l], b = s->late_part[k][l], sine, cosine;
    struct cplx above = cplx_scale(cplx_conj(z), b - a);
    above.re += REAL_C(1.0) - b;
    real_sincos(angle * (real_t)s->delay[k][l], &sine, &cosine);
    above = cplx_scale(cplx_mul(above, cplx(cosine, -sine)), s->gain[k][l]);
    return cplx_div(above, cplx(z.re - a, z.im));
}

void loops_open(const struct loops *loops, const struct loops_sampled *sampled, real_t omega,
                struct cmatrix *open)
{
    size_t n = loops->pairs.n;
    real_t angle = omega * sampled->step_s, sine, cosine;
    real_sincos(angle, &sine, &cosine);
    struct cplx z = cplx(cosine, sine);
    open->rows = open->cols = loops->pairs.n;
    for (size_t k = 0; k < n; k++) {
        struct cplx row[INTERACT_MAX];
        for (size_t l = 0; l < n; l++)
            row[l] = element_response(sampled, k, l, angle, z);
        for (size_t l = 0; l < n; l++) {
            open->at[k][l] = row[l];
            if (!loops->decoupler)
                continue;
            open->at[k][l] = cplx(REAL_C(0.0), REAL_C(0.0));
            for (size_t j = 0; j < n; j++)
                open->at[k][l] =
                    cplx_add(open->at[k][l], cplx_scale(row[j], loops->decoupler->at[j][l]));
        }
    }
    for (size_t l = 0; l < n; l++) {
        struct cplx c = loops_controller(loops, (uint8_t)l, sampled->step_s, z);
        for (size_t k = 0; k < n; k++)
            open->at[k][l] = cplx_mul(open->at[k][l], c);
    }
}

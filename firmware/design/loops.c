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

struct cplx loops_controller(const struct loops *loops, uint8_t k, real_t omega)
{
    const struct tuning *t = &loops->tuning[k];
    real_t gain = t->action == TUNING_DIRECT ? -t->gain : t->gain;
    struct cplx c = cplx(gain, -gain / (omega * t->ti_s));
    if (t->td_s > REAL_C(0.0)) { /* i x / (1 + i x/N), x = omega Td */
        real_t x = omega * t->td_s, y = x / loops->derivative_filter;
        real_t scale = gain * x / (REAL_C(1.0) + y * y);
        c = cplx_add(c, cplx(scale * y, scale));
    }
    return c;
}

void loops_open(const struct interact_plant *plant, const struct loops *loops, real_t omega,
                struct cmatrix *open)
{
    size_t n = loops->pairs.n;
    real_t half = loops->interval_s * REAL_C(0.5), sine, cosine;
    real_sincos(omega * half, &sine, &cosine);
    open->rows = open->cols = loops->pairs.n;
    for (size_t k = 0; k < n; k++) {
        struct cplx row[INTERACT_MAX];
        for (size_t l = 0; l < n; l++) {
            struct fopdt e = plant->element[loops->pairs.output[k]][loops->pairs.input[l]];
            if (e.time_constant_s < half)
                e.time_constant_s = half;
            row[l] = fopdt_response(&e, omega);
        }
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
        struct cplx c = cplx_mul(loops_controller(loops, (uint8_t)l, omega), cplx(cosine, -sine));
        for (size_t k = 0; k < n; k++)
            open->at[k][l] = cplx_mul(open->at[k][l], c);
    }
}

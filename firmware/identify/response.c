#include "identify/response.h"

#include "base/assertion.h"
#include "identify/common.h"

/* p^0 + .. + p^(n - 1) = (1 - p^n)/(1 - p), p = e^-x. */
static real_t geometric(real_t x, real_t n)
{
    return one_less_exp(n * x) / one_less_exp(x);
}

static real_t decayed(real_t x)
{
    return x > REAL_C(80.0) ? ZERO : real_exp(-x);
}

/* One edge of height change: response begins between samples first - 1 and first, late samples before first. */
static void edge(real_t change, uint32_t first, real_t late, real_t rate, uint32_t block,
                 uint32_t points, real_t *model, real_t *by_dead)
{
    uint32_t i = first / block;
    if (i >= points)
        return;
    real_t n = (real_t)block, weight = change / n;
    /* The block in which it begins: the rest of it, or all of it. */
    uint32_t rest = block - first % block;
    real_t part = decayed(late * rate) * geometric(rate, (real_t)rest);
    model[i] += weight * ((real_t)rest - part);
    if (by_dead)
        by_dead[i] -= weight * rate * part;
    /* From there whole blocks, each e^(-n/T) of the one before. */
    part = decayed((late + (real_t)rest) * rate) * geometric(rate, n);
    real_t step = decayed(n * rate);
    for (i++; i < points; i++) {
        model[i] += weight * (n - part);
        if (by_dead)
            by_dead[i] -= weight * rate * part;
        part *= step;
        if (part < REAL_C(1e-30)) /* no subnormal numbers */
            part = ZERO;
    }
}

void response_model(const struct excitation *u, real_t lag, real_t dead, uint32_t block,
                    uint32_t points, real_t *model, real_t *by_dead)
{
    REFLUX_ASSERT(u->edges <= EXCITATION_EDGES_MAX && block >= 1);
    for (uint32_t i = 0; i < points; i++) {
        model[i] = ZERO;
        if (by_dead)
            by_dead[i] = ZERO;
    }
    uint32_t whole = (uint32_t)dead;
    real_t late = ONE - (dead - (real_t)whole); /* (0, 1] */
    real_t rate = lag > REAL_C(1e-3) ? ONE / lag : REAL_C(1e3);
    for (uint32_t j = 0; j < u->edges; j++) {
        uint32_t first = u->edge[j].sample + whole + 1;
        edge(u->edge[j].change, first, late, rate, block, points, model, by_dead);
    }
}

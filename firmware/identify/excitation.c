#include "identify/excitation.h"

#include "base/assertion.h"
#include "identify/common.h"
#include "lti/fopdt.h" /* real_is_finite */

void excitation_clear(struct excitation *u)
{
    u->edges = 0;
}

real_t excitation_level(const struct excitation *u)
{
    REFLUX_ASSERT(u->edges <= EXCITATION_EDGES_MAX);
    real_t level = ZERO;
    for (uint32_t i = 0; i < u->edges; i++)
        level += u->edge[i].change;
    return level;
}

real_t excitation_peak(const struct excitation *u)
{
    REFLUX_ASSERT(u->edges <= EXCITATION_EDGES_MAX);
    real_t level = ZERO, peak = ZERO;
    for (uint32_t i = 0; i < u->edges; i++) {
        level += u->edge[i].change;
        if (real_abs(level) > peak)
            peak = real_abs(level);
    }
    return peak;
}

enum err excitation_move(struct excitation *u, uint32_t sample, real_t level)
{
    if (!real_is_finite(level))
        return ERR_NOT_FINITE;
    uint32_t n = u->edges;
    if (n > 0 && sample < u->edge[n - 1].sample)
        return ERR_STATE;
    real_t change = level - excitation_level(u);
    if (!real_is_finite(change))
        return ERR_NOT_FINITE;
    if (n > 0 && sample == u->edge[n - 1].sample) {
        change += u->edge[n - 1].change;
        n--;
    }
    if (real_abs(change) <= ZERO) { /* two moves at one sample can undo each other */
        u->edges = n;
        return ERR_OK;
    }
    if (n >= EXCITATION_EDGES_MAX)
        return ERR_FULL;
    u->edge[n].sample = sample;
    u->edge[n].change = change;
    u->edges = n + 1;
    return ERR_OK;
}

enum err excitation_double_step(struct excitation *u, uint32_t start, uint32_t t1, uint32_t t2,
                                real_t amplitude)
{
    if (!real_is_finite(amplitude))
        return ERR_NOT_FINITE;
    if (t1 == 0 || t2 == 0 || t1 > UINT32_MAX - start || t2 > UINT32_MAX - start - t1 ||
        real_abs(amplitude) <= ZERO)
        return ERR_RANGE;
    u->edges = 3;
    u->edge[0].sample = start;
    u->edge[0].change = amplitude;
    u->edge[1].sample = start + t1;
    u->edge[1].change = REAL_C(-2.0) * amplitude;
    u->edge[2].sample = start + t1 + t2;
    u->edge[2].change = amplitude;
    return ERR_OK;
}

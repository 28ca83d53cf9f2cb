/* Checks of the settings of the kind `polynomial`: inverses, and the past that has to die away. */
#include "kinds/polynomial/polynomial.h"

#include <string.h>

#include "base/assertion.h"
#include "num/solve_small.h"

#define SINGULAR 1e-5f
#define SAMPLES  64

bool polynomial_solve(unsigned n, float a[POLYNOMIAL_LOOPS][POLYNOMIAL_LOOPS], const float *b,
                      float *x)
{
    REFLUX_ASSERT(n <= POLYNOMIAL_LOOPS);
    float w[POLYNOMIAL_LOOPS][POLYNOMIAL_LOOPS + 1];
    for (unsigned i = 0; i < n; i++) {
        for (unsigned j = 0; j < n; j++)
            w[i][j] = a[i][j];
        w[i][n] = b[i];
    }
    if (!solve_small_scaled(SINGULAR, n, n + 1, POLYNOMIAL_LOOPS + 1, w[0]))
        return false;
    for (unsigned i = 0; i < n; i++)
        x[i] = w[i][n];
    return true;
}

/* Adds a sample of the recursion: past[0] is the newest. */
static bool recurse_once(const struct polynomial_settings *c, unsigned loops, unsigned taps,
                         unsigned n, const uint8_t *member,
                         float past[POLYNOMIAL_TAPS][POLYNOMIAL_LOOPS])
{
    float first[POLYNOMIAL_LOOPS][POLYNOMIAL_LOOPS], sum[POLYNOMIAL_LOOPS];
    for (unsigned i = 0; i < n; i++) {
        sum[i] = 0;
        for (unsigned j = 0; j < n; j++) {
            const float *g = c->g[member[i] * loops + member[j]];
            first[i][j] = g[0];
            for (unsigned k = 1; k < taps; k++)
                sum[i] -= g[k] * past[k - 1][j];
        }
    }
    memmove(past[1], past[0], (taps - 1) * sizeof past[0]);
    return polynomial_solve(n, first, sum, past[0]);
}

bool polynomial_forgets(const struct polynomial_settings *c, unsigned loops, unsigned taps,
                        unsigned members)
{
    REFLUX_ASSERT(loops <= POLYNOMIAL_LOOPS && taps >= 1 && taps <= POLYNOMIAL_TAPS);
    uint8_t member[POLYNOMIAL_LOOPS];
    unsigned n = 0;
    float left[POLYNOMIAL_TAPS][POLYNOMIAL_LOOPS] = {{0}};
    for (unsigned k = 0; k < loops; k++)
        if (members & (1u << k))
            member[n++] = (uint8_t)k;
    if (n == 0)
        return true;
    /* The 64th power of the companion matrix, column by column; its norm by rows bounds that power of its spectral radius. */
    unsigned states = taps > 1 ? n * (taps - 1) : 1;
    for (unsigned begun = 0; begun < states; begun++) {
        float past[POLYNOMIAL_TAPS][POLYNOMIAL_LOOPS] = {{0}};
        past[begun / n][begun % n] = 1;
        for (unsigned t = 0; t < SAMPLES; t++)
            if (!recurse_once(c, loops, taps, n, member, past))
                return false;
        for (unsigned k = 0; k + 1 < taps; k++)
            for (unsigned i = 0; i < n; i++)
                left[k][i] += real_abs(past[k][i]);
    }
    for (unsigned k = 0; k + 1 < taps; k++)
        for (unsigned i = 0; i < n; i++)
            if (!(left[k][i] < 0.5f))
                return false;
    return true;
}

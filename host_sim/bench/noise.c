#include "bench/noise.h"

#include <math.h> /* frexp, sqrt: exact or correctly rounded everywhere */

uint32_t noise_bits(struct noise *n)
{
    uint64_t old = n->state;
    n->state = old * 6364136223846793005u + n->stream;
    uint32_t mixed = (uint32_t)(((old >> 18) ^ old) >> 27);
    uint32_t turn = (uint32_t)(old >> 59);
    return (mixed >> turn) | (mixed << ((32u - turn) & 31u));
}

void noise_seed(struct noise *n, uint64_t seed, uint64_t stream)
{
    *n = (struct noise){.state = 0, .stream = (stream << 1) | 1u};
    (void)noise_bits(n);
    n->state += seed;
    (void)noise_bits(n);
}

double noise_uniform(struct noise *n)
{
    return ((double)noise_bits(n) + 0.5) * (1.0 / 4294967296.0);
}

/* Natural logarithm for 0 < x < 1: x = m 2^e with m near 1, ln m = 2 atanh((m - 1) / (m + 1)). */
static double logarithm(double x)
{
    int e;
    double m = frexp(x, &e);
    if (m < 0.70710678118654752) {
        m *= 2.0;
        e--;
    }
    double s = (m - 1.0) / (m + 1.0); /* |s| < 0.172: 12 terms are enough for double */
    double s2 = s * s;
    double sum = 0.0;
    for (int k = 12; k >= 0; k--) {
        sum = sum * s2 + 1.0 / (2.0 * k + 1.0);
    }
    return 2.0 * s * sum + 0.69314718055994531 * e;
}

double noise_normal(struct noise *n)
{
    if (n->has_spare) {
        n->has_spare = false;
        return n->spare;
    }
    double u;
    double v;
    double r;
    do {
        u = 2.0 * noise_uniform(n) - 1.0;
        v = 2.0 * noise_uniform(n) - 1.0;
        r = u * u + v * v;
    } while (r >= 1.0 || r == 0.0);
    double scale = sqrt(-2.0 * logarithm(r) / r);
    n->spare = v * scale;
    n->has_spare = true;
    return u * scale;
}

#include "num/random.h"

#include "num/real_trig.h"

#define TWO_PI REAL_C(6.283185307179586)

/* Returns a number above 0 and up to 1, in steps of 2^-24. */
static real_t uniform(struct random *r)
{
    return (real_t)((random_bits(r) >> 40) + 1u) * REAL_C(5.9604644775390625e-8);
}

real_t random_normal(struct random *r)
{
    if (r->have) {
        r->have = false;
        return r->other;
    }
    real_t radius = real_sqrt(REAL_C(-2.0) * real_log(uniform(r)));
    real_t sine, cosine;
    real_sincos(TWO_PI * uniform(r), &sine, &cosine);
    r->other = radius * sine;
    r->have = true;
    return radius * cosine;
}

/* Random numbers that are the same on every machine: splitmix64 (Steele, Lea and Flood 2014), normal deviates by Box
 * and Muller (1958). They serve simulation and random choices, never secrets. */
#ifndef REFLUX_NUM_RANDOM_H
#define REFLUX_NUM_RANDOM_H

#include <stdbool.h>
#include <stdint.h>

#include "num/double_symbols.h"
#include "num/real.h"

struct random {
    uint64_t state; /* any value as the seed */
    bool have;
    real_t other; /* second deviate of the pair */
};

static inline struct random random_from(uint64_t seed)
{
    return (struct random){.state = seed};
}

static inline uint64_t random_bits(struct random *r)
{
    r->state += UINT64_C(0x9E3779B97F4A7C15);
    uint64_t z = r->state;
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

/* Returns a normal deviate: mean 0, standard deviation 1, magnitude below 5.9 (24-bit uniforms). */
real_t random_normal(struct random *r);

#endif

/* A small random source for tests: same seed, same bytes, on every machine (splitmix64, Steele et al. 2014). */
#ifndef REFLUX_TESTS_RANDOM_SOURCE_H
#define REFLUX_TESTS_RANDOM_SOURCE_H

#include <stdint.h>

struct random_source {
    uint64_t state;
};

static inline uint64_t random_next(struct random_source *r)
{
    r->state += 0x9E3779B97F4A7C15u;
    uint64_t z = r->state;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

static inline uint32_t random_below(struct random_source *r, uint32_t n)
{
    return (uint32_t)(random_next(r) % n);
}

#endif

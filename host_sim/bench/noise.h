/* Seeded random numbers that are the same on every machine: PCG32 (O'Neill 2014) and Marsaglia's polar method
 * with a logarithm of our own, so that no libc or libm takes part. */
#ifndef REFLUX_HOST_SIM_NOISE_H
#define REFLUX_HOST_SIM_NOISE_H

#include <stdbool.h>
#include <stdint.h>

struct noise {
    uint64_t state, stream;
    double spare; /* the polar method makes two at a time */
    bool has_spare;
};

/* Streams of the same seed are independent of one another. */
void noise_seed(struct noise *n, uint64_t seed, uint64_t stream);
uint32_t noise_bits(struct noise *n);
double noise_uniform(struct noise *n); /* in (0, 1) */
double noise_normal(struct noise *n);  /* mean 0, standard deviation 1 */

#endif

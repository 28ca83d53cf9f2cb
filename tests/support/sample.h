/* Samples of cases. A long test tries a sample by default, and every case with the argument `all`, which the full tier gives. */
#ifndef SAMPLE_H
#define SAMPLE_H

#include <stdbool.h>
#include <string.h>

static bool sample_every_case;

static inline void sample_arguments(int argc, char **argv)
{
    sample_every_case = argc > 1 && strcmp(argv[1], "all") == 0;
}

/* True for every stride-th number, and for every number with `all`. */
static inline bool sample_has(unsigned number, unsigned stride)
{
    return sample_every_case || number % stride == 0;
}

#endif

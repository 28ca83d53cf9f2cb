/* Type scaled_t of the fixed build (num/scaled.h). */
#ifndef REFLUX_NUM_SCALED_TYPE_H
#define REFLUX_NUM_SCALED_TYPE_H

#include <stdint.h>

#ifdef REFLUX_FIXED_POINT

#define SCALED_EXPONENT_MAX 4096 /* exponent of the result of a division by zero */

typedef struct {
    int32_t m, e;
} scaled_t;

#endif
#endif

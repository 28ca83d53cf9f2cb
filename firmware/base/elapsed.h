/* Elapsed time as a float, for comparison with settings. */
#ifndef REFLUX_BASE_ELAPSED_H
#define REFLUX_BASE_ELAPSED_H

#include <stdint.h>

/* Returns now_ms - then_ms as the nearest float, of two equally near ones the even one. A cast gives the same number, but on the
 * target it would link the C library's software floats, because no processor here converts 64 bits. */
float elapsed_ms(uint64_t now_ms, uint64_t then_ms);

#endif

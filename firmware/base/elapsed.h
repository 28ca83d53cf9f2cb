/* How long ago something was, for comparison with settings. */
#ifndef REFLUX_BASE_ELAPSED_H
#define REFLUX_BASE_ELAPSED_H

#include <stdint.h>

/* now_ms - then_ms as the nearest float, of two the even one. The same as a cast, which on the target takes the C
 * library's software floats along: no processor here converts 64 bits. */
float elapsed_ms(uint64_t now_ms, uint64_t then_ms);

#endif

/* Read before every file (tools/cmake/options.cmake). Memory for a column's estimator and a controller with a model of the column beside it,
 * of two components and up to 32 stages; the headers' own 16 KiB are 3 KiB short of that. The host has them too. */
#ifndef REFLUX_STM32F405_LIMITS_H
#define REFLUX_STM32F405_LIMITS_H

#define PLAN_ARENA_BYTES 19456

#endif

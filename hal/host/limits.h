/* Read before every file (tools/cmake/options.cmake). Memory for a column's estimator and a controller with a model of the column beside it,
 * of two components and up to 32 stages; the headers' own 16 KiB are 3 KiB short of that. Host and STM32F405 have the same, so that they
 * take the same settings. */
#ifndef REFLUX_HOST_LIMITS_H
#define REFLUX_HOST_LIMITS_H

#define PLAN_ARENA_BYTES 19456

#endif

/* Read before every file (tools/cmake/options.cmake). Memory for a column's estimator and a controller with a model of the column beside it,
 * up to 15 stages of two components; the headers' own 16 KiB are 1.2 KiB short of that. Host and STM32F405 have the same, so that they
 * take the same settings. */
#ifndef REFLUX_HOST_LIMITS_H
#define REFLUX_HOST_LIMITS_H

#define PLAN_ARENA_BYTES 18432

#endif

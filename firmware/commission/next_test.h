/* The settings of the next test of an input: amplitude, shortest and longest half, from the configuration and the results of the
 * tests before. Tick; commission_half_needed() in the main loop. */
#ifndef REFLUX_COMMISSION_NEXT_TEST_H
#define REFLUX_COMMISSION_NEXT_TEST_H

#include "commission/experiment.h"
#include "supervise/supervisor.h"

#define NOISE_FLOOR     REAL_C(7e-5)  /* of span: resolution of a 12-bit converter */
#define AMPLITUDE_FIRST REAL_C(0.005) /* of span: first step where the test finds it */

/* Limits for repeated tests of an input, over all rounds. */
#define LONGER_RETRIES_MAX 3u /* with longer halves, where an output did not come to rest */
#define LINEAR_RETRIES_MAX 1u /* with a smaller step, because an output is not linear */

struct commission;

/* The next test of the input whose turn it is. */
void next_test_config(struct commission *c, const struct supervisor *s,
                      struct experiment_config *x);

/* Seconds until every response to input k is over but for a twentieth, as far as it is surely known. */
real_t commission_lasts(const struct commission *c, uint8_t k);
/* Half of a double step, s, that would show the end of output j's response to input k, where the latest test did not: until it
 * is over but for a twentieth, as far as its time constant is known; at least twice the latest. */
real_t commission_half_needed(const struct commission *c, uint8_t j, uint8_t k);

#endif

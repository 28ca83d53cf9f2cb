/* The plant's channels as start-up needs them: which are tested, where they are held, how far they may go. No state; tick, and main
 * loop under hal_tick_lock. */
#ifndef REFLUX_COMMISSION_CHANNELS_H
#define REFLUX_COMMISSION_CHANNELS_H

#include "num/real.h"
#include "supervise/supervisor.h"

#define COMMISSION_HALF_MOST 20000u /* samples of a half, unless test.longest says otherwise */
/* Samples after which a half goes on only for a response that the fit knows to go on; also of a relay's half, and of a plan. */
#define COMMISSION_HALF_PLENTY 1000u
#define TEST_LIMIT_DEFAULT     REAL_C(0.2) /* of span, where test_limit is 0 */

/* Number of base ticks. */
uint32_t commission_samples(const struct supervisor *s, real_t seconds);
/* Longest half of a test, samples. */
uint32_t commission_longest(const struct supervisor *s);

bool commission_input_is_tested(const struct supervisor *s, uint8_t j);
bool commission_measurement_is_tested(const struct supervisor *s, uint8_t i);
/* Level at which output j is held, fraction of span. */
real_t commission_test_base(const struct supervisor *s, uint8_t j);
/* The shorter way from `held` to an operating limit of output j, fraction of span. */
real_t commission_room(const struct supervisor *s, uint8_t j, real_t held);
/* The largest deviation from rest that a test may cause, fraction of span. */
real_t commission_limit(const struct measurement_config *m);

/* Checksum of the names, spans and order of a configuration's channels, which results refer to by index. */
uint32_t commission_channels(const struct config *config);

/* Measurement i has a good reading. */
bool channel_is_valid(const struct supervisor *s, uint8_t i);
/* Measurement i reads an end of its span or beyond, where a sensor shows nothing of the plant. */
bool channel_is_at_end(const struct supervisor *s, uint8_t i);

#endif

/* Two-position control: the output is at one of two values, chosen by which side of a band the measurement was on
 * last. All values are fractions of span.
 *
 *     direct:   measurement above setpoint + band  -> hi      below setpoint - band  -> lo
 *     reverse:  measurement below setpoint - band  -> hi      above setpoint + band  -> lo
 *     inside the band, edges included: the output stays where it is
 *
 * So an output found anywhere when the block takes over stays there until the measurement leaves the band.
 * The ordinary on-off law with a differential gap; Folami (1989) kept his reboiler level so, with a bottoms valve
 * 60 or 10 % open. Limits, rates or a jammed valve change nothing in it: there is no state to wind up.
 */
#ifndef REFLUX_TWO_POSITION_TWO_POSITION_H
#define REFLUX_TWO_POSITION_TWO_POSITION_H

#include <stdbool.h>

#include "base/error.h"
#include "block/block.h"

struct two_position_config {
    /* Half the gap, fraction of the measurement's span, above 0, at most 10. */
    float band;
    /* The two outputs, fraction, -100 <= lo < hi <= 100. */
    float out_lo, out_hi;
    /* A high measurement asks for out_hi. */
    bool direct;
};

/* Checks settings. *field gets the name of the first field that is wrong, *wanted its range in words (either may be NULL).
 * NaN and infinity anywhere are ERR_NOT_FINITE, all else is ERR_RANGE. */
MUST_CHECK enum err two_position_validate(const struct two_position_config *config,
                                          const char **field, const char **wanted);

/* The fields are private to the block; the struct is defined here so that callers can hold one. */
struct two_position {
    num_t band, lo, hi;
    num_t output;
    bool direct;
};

/* Starts with the output lo. Errors as two_position_validate; on error *t is unchanged. */
MUST_CHECK enum err two_position_init(struct two_position *t,
                                      const struct two_position_config *config);
/* Takes new settings: an output at one of the two values goes to the new value, any other stays. Errors as
 * two_position_init. */
MUST_CHECK enum err two_position_retune(struct two_position *t,
                                        const struct two_position_config *config);

num_t two_position_step(struct two_position *t, num_t setpoint, num_t measurement);
/* Takes the output in effect while the block does not act. */
void two_position_follow(struct two_position *t, num_t applied);

/* A loop's own controller: settings are a struct loop_settings, one member. */
extern const struct block_kind two_position_kind;

#endif

/* Settings for one loop of a given pairing by a relay test (identify/relay.h), in place of tests of the whole plant. The
 * other loops stay as they are: in manual, or those that have been tuned already in automatic (sequential tuning: A. P. Loh,
 * C. C. Hang, C. K. Quek and V. U. Vasnani, Ind. Eng. Chem. Res. 32 (1993) 1102).
 *
 *     rest   until every measurement is at rest, against its own noise
 *     relay  until the limit cycle repeats itself; then the output is where it was held, and there is a proposal for this
 *            one loop: PI by Tyreus and Luyben (design/tuning.h), to be accepted, edited or rejected like any other
 *
 * docs/relay.md. */
#ifndef REFLUX_COMMISSION_BY_RELAY_H
#define REFLUX_COMMISSION_BY_RELAY_H

#include "commission/by_relay_state.h"
#include "supervise/supervisor.h"

/* What a trial of these settings is held against: with the margins of every trial (adoption.h) that is what a setpoint step
 * does to any process of first order with dead time of 0.02 to 2 time constants (tests/reference/relay_family.csv). */
#define BY_RELAY_IAE     REAL_C(2.0)  /* Pu times the step */
#define BY_RELAY_PEAK    REAL_C(0.22) /* overshoot */
#define BY_RELAY_SETTLES REAL_C(8.0)  /* Pu */
#define BY_RELAY_MOVES   REAL_C(0.66) /* largest move of the output: Ku times the step */

/* Whether the test of that loop could begin. *what gets a channel's or loop's name, or NULL. Main loop, under
 * hal_tick_lock. */
MUST_CHECK enum err commission_may_relay(const struct supervisor *s, uint8_t loop,
                                         const char **what, const char **wanted);

#endif

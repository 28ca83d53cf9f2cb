/* Settings for one loop of a given pairing by a relay test (identify/relay.h), in place of tests of the whole plant. The
 * other loops stay as they are: in manual, or those that have been tuned already in automatic (sequential tuning: A. P. Loh,
 * C. C. Hang, C. K. Quek and V. U. Vasnani, Ind. Eng. Chem. Res. 32 (1993) 1102).
 *
 *     rest   until every measurement is at rest, against its own noise
 *     relay  until the limit cycle repeats itself; then the output is where it was held, and there is a proposal for this
 *            one loop: PI by Tyreus and Luyben (design/tuning.h), to be accepted, edited or rejected like any other
 *
 * docs/methods/relay.md. Tick; the main loop reads the results. */
#ifndef REFLUX_COMMISSION_BY_RELAY_H
#define REFLUX_COMMISSION_BY_RELAY_H

#include "commission/relay_finding.h"
#include "supervise/supervisor.h"

struct by_relay;
struct commission;
struct relay_test;

/* Predictions for a trial of these settings. With the margins of every trial (adoption.h) they hold for setpoint steps of any first-order
 * process with dead time of 0.02 to 2 time constants (tests/reference/relay_family.csv). */
#define BY_RELAY_IAE     REAL_C(2.0)  /* Pu times the step */
#define BY_RELAY_PEAK    REAL_C(0.22) /* overshoot */
#define BY_RELAY_SETTLES REAL_C(8.0)  /* Pu */
#define BY_RELAY_MOVES   REAL_C(0.66) /* largest move of the output: Ku times the step */

/* Progress of a test, as a record. */
struct relay_progress {
    bool resting; /* it waits for rest */
    enum relay_phase phase;
    uint16_t periods;
    real_t amplitude; /* fraction of span */
};

/* Tick. */
void commission_begin_relay(struct commission *c, struct supervisor *s);
/* From its start. Tick. */
void commission_start_relay(struct commission *c, struct supervisor *s);
/* A tick of it. */
void commission_relay(struct commission *c, struct supervisor *s);

/* Writes the settings that it has found into the loop. */
void by_relay_write(const struct by_relay *r, struct loop_config *l);
/* Under hal_tick_lock. */
struct relay_progress relay_test_progress(const struct relay_test *t);

#endif

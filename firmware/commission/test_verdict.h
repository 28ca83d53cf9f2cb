/* Verdict on a finished double step without a model: whether the output went on climbing, and whether the gain is the same in
 * each of its three parts. Drift enters both halves with the same sign, the response with opposite signs. Main loop. */
#ifndef REFLUX_COMMISSION_TEST_VERDICT_H
#define REFLUX_COMMISSION_TEST_VERDICT_H

#include "identify/identified.h"
#include "identify/record.h"

struct test_verdict {
    bool moves; /* the changes below exceed the noise */
    /* Change in the second half of each level over that in the first: 1 for an integrator, 0.2 for a lag of a third of the
     * level; 0 where it does not move. */
    real_t climbs;
    real_t first, second; /* the two changes of both levels together, fraction of span */
    real_t change_sd;     /* of the second, by the noise alone */
    /* Gains, output span per input span, from the ends of the two levels and the rest after them; 0 where they are too short
     * to tell. */
    real_t spread;   /* largest less smallest gain of the three parts */
    real_t level;    /* from one level to the other */
    real_t level_sd; /* of `level`, by the noise alone */
    /* Gain up less gain down where noise and drift do not explain it: the output is not linear, or was disturbed. */
    real_t asymmetry;
    real_t left; /* rest after the test over both steps, magnitude */
};

/* Returns `level` for a first-order element of gain 1: below 1 where the steps were too short for it. */
real_t test_verdict_level_of(const struct record *r, real_t dead_time_s, real_t time_constant_s);

/* Output j of a record whose last three edges are those of the double step: to +amplitude, to -amplitude, to 0. drift: of
 * the output before the step, as far as it is sure, span per second. */
void test_verdict_of(const struct record *r, uint8_t j, const struct baseline *baseline,
                     real_t amplitude, real_t drift, struct test_verdict *result);

#endif

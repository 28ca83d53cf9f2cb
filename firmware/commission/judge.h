/* What a finished double step says without a model: whether the output went on climbing, and whether the gain is the same
 * in each of its three parts. Drift enters the two halves with one sign and the response with two. */
#ifndef REFLUX_COMMISSION_JUDGE_H
#define REFLUX_COMMISSION_JUDGE_H

#include "identify/identified.h"
#include "identify/record.h"

struct judgement {
    bool moves; /* the changes below stand out of the noise */
    real_t
        climbs; /* change in the second half of each level over that in the first: 1 for an integrator, 0.2 for a lag of
                       a third of the level; 0 where it does not move */
    real_t first, second; /* the two changes, fraction of span, of both levels together */
    real_t change_sd;     /* of the second, by the noise alone */
    real_t
        spread; /* largest less smallest gain of the three parts, output span per input span; 0 where they are too
                       short to tell */
};

/* Output j of a record whose last three edges are those of the double step: to +amplitude, to -amplitude, to 0. */
void judge_record(const struct record *r, uint8_t j, const struct baseline *baseline,
                  real_t amplitude, struct judgement *result);

#endif

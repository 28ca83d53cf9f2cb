/* The short form: omega from one open-loop step (Frau, PhD thesis Cagliari, section 5.3): the dominant frequency is
 *     omega = 4/t_98,
 * t_98 the time after which the output stays within 2 % of its change about its final value. For a first-order lag
 * without dead time t_98 = 3.9 T, so omega is about 1/T. It is what the observer PI's and cascades' tuning starts from.
 */
#ifndef REFLUX_IDENTIFY_SETTLING_H
#define REFLUX_IDENTIFY_SETTLING_H

#include <stdint.h>

#include "base/error.h"
#include "identify/identified.h"
#include "identify/record.h"
#include "num/real.h"

struct settling {
    real_t change;      /* final level less level before the step */
    real_t t_98_s;      /* from the edge */
    real_t omega_per_s; /* 4/t_98 */
    real_t noise_sd;    /* of one point */
    uint32_t mean_of;   /* points averaged so that 2 % stands above the noise */
};

/* From a record of a single edge: at least 4 points before it and a final quarter without motion. ERR_EMPTY: too few
 * points; ERR_STATE: not exactly one edge, or the final quarter still moves; ERR_RANGE: no such output, or the change is
 * lost in the noise even when a sixteenth of the record is averaged. */
MUST_CHECK enum err settling_from_record(const struct record *r, uint32_t output,
                                         struct settling *result);

/* From a model: t_98 = L + T ln 50. ERR_RANGE: both times 0 or one below; ERR_NOT_FINITE. */
MUST_CHECK enum err settling_from_model(const struct identified *model, real_t *t_98_s,
                                        real_t *omega_per_s);

#endif

/* How large lambda must be for a set of parameters: trials (kinds/gmv/gmv_trial.h) with lambda as it is set and with multiples of it, until
 * the law is stable within its margin, better than the PI, and quiet at rest. Ours.
 *
 * It is the trial's companion between ticks: gmv_detune_begin with the trial that has been taken, then gmv_detune_piece until it
 * returns false, then .best. */
#ifndef REFLUX_GMV_GMV_DETUNE_H
#define REFLUX_GMV_GMV_DETUNE_H

#include "kinds/gmv/gmv_outcome.h"
#include "kinds/gmv/gmv_record.h"
#include "kinds/gmv/gmv_trial.h"

struct gmv_detune {
    struct gmv_outcome best; /* of those that pass; the first where none does */
    bool passes;             /* best does */
    /* Of the search. */
    float times, most, better, noise_margin, least; /* least: ratio of those that pass */
    bool any;
    struct gmv_record record[GMV_LOOPS];
};

/* times: what lambda already is of the one that is set. most: up to which multiple; `times` itself for a single trial.
 * better: part of the PI's error that must be saved. record: of the PI, copied; one for each loop. */
void gmv_detune_begin(struct gmv_detune *d, float times, float most, float better,
                      const struct gmv_record *record);
/* A piece of it, a few steps; true while there is more. */
bool gmv_detune_piece(struct gmv_detune *d, struct gmv_trial *t);

#endif

/* Searches the smallest lambda that suits a set of parameters: trials (kinds/gmv/gmv_trial.h) with lambda as it is set and with multiples
 * of it, until the law is stable within its margin, better than the PI, and quiet at rest. Ours.
 *
 * It runs between ticks beside the trial: gmv_detune_begin with the trial that has been taken, then gmv_detune_piece until it
 * returns false, then gmv_detune_best. */
#ifndef REFLUX_GMV_GMV_DETUNE_H
#define REFLUX_GMV_GMV_DETUNE_H

#include "kinds/gmv/gmv_outcome.h"
#include "kinds/gmv/gmv_record.h"
#include "kinds/gmv/gmv_trial.h"

struct gmv_detune;

/* times: lambda in use as a multiple of the setting. most: largest multiple; `times` itself for a single trial.
 * better: part of the PI's error that must be saved. record: of the PI, copied; one for each loop. */
void gmv_detune_begin(struct gmv_detune *d, float times, float most, float better,
                      const struct gmv_record *record);
/* Runs a few steps. True: not finished. */
bool gmv_detune_piece(struct gmv_detune *d, struct gmv_trial *t);
/* Returns the best of those that pass; the first one where none passes. */
const struct gmv_outcome *gmv_detune_best(const struct gmv_detune *d);

#endif

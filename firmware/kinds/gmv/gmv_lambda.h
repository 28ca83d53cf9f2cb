/* Lambda in use, and the trials that find it. docs/methods/self-tuning.md, Adoption. */
#ifndef REFLUX_GMV_GMV_LAMBDA_H
#define REFLUX_GMV_GMV_LAMBDA_H

#include "block/block.h"
#include "kinds/gmv/gmv.h"
#include "kinds/gmv/gmv_outcome.h"

struct gmv_lambda_search;
struct gmv_record;

/* Settings; the multiple in use stays. */
void gmv_lambda_configure(struct gmv_lambda_search *s, const struct block_setup *setup,
                          const struct gmv_config *c);
/* Lambda is as it is set; no trial is wanted. */
void gmv_lambda_reset(struct gmv_lambda_search *s);
/* No trial is wanted; the result of one under way is dropped. */
void gmv_lambda_cancel(struct gmv_lambda_search *s);

/* Lambda as a multiple of g_ii,0 of the law, where the settings want that, times the multiple in use. */
void gmv_lambda_apply(const struct gmv_lambda_search *s, struct gmv *g);
/* Asks for a trial where one is wanted. A trial that is still under way finishes first, and its result is dropped. searches: lambda may
 * change. better: part of the PI's error that must be saved. record: of each PI. */
void gmv_lambda_ask(struct gmv_lambda_search *s, struct gmv *g, struct block_io *io, bool wanted,
                    bool searches, float better, const struct gmv_record *record);
/* True: the trial is over; its lambda is in use from the next gmv_lambda_apply on. */
bool gmv_lambda_take(struct gmv_lambda_search *s, const struct block_io *io,
                     struct gmv_outcome *outcome);

#endif

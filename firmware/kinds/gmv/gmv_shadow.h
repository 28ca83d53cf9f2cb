/* The self-tuner's own PIs: they compute while it tunes, and follow while the law computes. */
#ifndef REFLUX_GMV_GMV_SHADOW_H
#define REFLUX_GMV_GMV_SHADOW_H

#include "block/block.h"

struct gmv_shadow;

/* Settings of loop i's PI: tune_gain and tune_ti of the block. */
MUST_CHECK enum err gmv_shadow_configure(struct gmv_shadow *s, const struct block_setup *setup,
                                         unsigned i, bool retune);

#endif

/* Kind `ratio`: MVs that follow a measured feed (docs/methods/ratio.md). Ours; Frau (section 5.1 of her thesis)
 * tries a reflux held in proportion to the feed. */
#ifndef REFLUX_RATIO_RATIO_H
#define REFLUX_RATIO_RATIO_H

#include "block/block.h"

#if CONFIG_BLOCKS

#define RATIO_LOOPS 2

struct ratio_settings {
    float nominal; /* unit of the input, above 0: the feed at which the ratio is 1 */
    float zero;    /* fraction of the MV's span at which nothing flows */
    float lag_s;   /* of the feed */
    float lo, hi;  /* of the ratio */
    float hold_s;  /* time that the last ratio is kept without a feed */
};

extern const struct block_kind ratio_kind;

#endif
#endif

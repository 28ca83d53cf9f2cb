/* Kind `gmv`: self-tuning control of one loop or two by generalised minimum variance, with supervision (docs/methods/self-tuning.md). */
#ifndef REFLUX_GMV_GMV_KIND_H
#define REFLUX_GMV_GMV_KIND_H

#include "block/block.h"

#if CONFIG_BLOCKS
extern const struct block_kind gmv_kind;
#endif

#endif

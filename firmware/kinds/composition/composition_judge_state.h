/* State of the judgement on the estimates. For its owner composition_judge.c and for composition_block.h, which allocates it. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_JUDGE_STATE_H
#define REFLUX_COMPOSITION_COMPOSITION_JUDGE_STATE_H

#include "block/block.h"

#if CONFIG_BLOCKS

struct composition_judge {
    /* consecutive steps without any temperature that draws, or vapour; saturates */
    uint32_t without;
    uint32_t steps;  /* towards being settled; back in steps that see nothing */
    uint32_t dry;    /* steps with vapour until the vapour counts */
    uint8_t missing; /* number of the first missing input that is no temperature, or 0 */
    bool seen;       /* a temperature has drawn since the beginning */
};

#endif
#endif

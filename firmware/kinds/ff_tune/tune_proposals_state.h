/* The state behind tune_proposals.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_FF_TUNE_TUNE_PROPOSALS_STATE_H
#define REFLUX_FF_TUNE_TUNE_PROPOSALS_STATE_H

#include <stdbool.h>
#include <stdint.h>

struct tune_proposals {
    /* Steps that a proposal has waited. */
    uint32_t calls;
    /* The proposal of this stage was handed over. */
    bool handed;
    bool silencing, off_waits;
};

#endif

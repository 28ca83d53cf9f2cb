/* A law of state feedback as it was found; numbers are those of fractions of span. */
#ifndef REFLUX_LAW_STATE_LAW_FOUND_H
#define REFLUX_LAW_STATE_LAW_FOUND_H

#include "law/state_law_settings.h"

#if CONFIG_BLOCKS

/* Characters of a refusal in words. */
#define STATE_LAW_WORDS 128

struct state_law_found {
    float f[STATE_LAW_LOOPS][STATE_FEEDBACK_INPUTS], g[STATE_LAW_LOOPS][STATE_LAW_LOOPS];
    float k_star[STATE_LAW_LOOPS];
    /* of B* */
    float condition;
    /* largest magnitude of the modes that are hidden */
    float zero;
    /* of the loop with all states, and with the inputs alone */
    float radius, inputs_radius;
    /* %, of F */
    float left;
    uint8_t index[STATE_LAW_LOOPS], zeros;
    /* A refusal: the field, what it must be, in words, and the loop, from 1 on. "": there is none. */
    const char *field, *wanted;
    uint8_t loop;
};

#endif
#endif

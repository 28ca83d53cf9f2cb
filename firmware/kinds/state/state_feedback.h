/* Kind `state`: a controller of up to four loops by state feedback,
 *
 *     u = F x + G (w + I - D),   I = integral of (w - y)/ti,   D = td y'
 *
 * x its inputs: states, measured or from an estimator, and measured disturbances, whose columns of F are Tf. Source of the law: P. L. Falb and
 * W. A. Wolovich, IEEE Trans. Automatic Control 12 (1967) 651, on a column T. O. Folami (1989), chapter 6; design/state_decoupler.h finds
 * F, G and Tf. I and D are ours. All signals are fractions of span; a constant makes the beginning bumpless, so what counts of x and w
 * is by how much they are away from where it began. Without ti a beginning that is not at rest leaves an offset.
 *
 * F, G, ti and td are settings of its own, or those of a block of the kind `state_law`. While that has no whole law the one that was there goes
 * on; where there was none the block gives up, no_law, and where it is for another interval, interval.
 *
 * A loop that does not act has its measurement for a setpoint. Where MVs are limited the loops they belong to give way, those with ti: their
 * I is what the MVs that took effect ask for. */
#ifndef REFLUX_STATE_STATE_FEEDBACK_H
#define REFLUX_STATE_STATE_FEEDBACK_H

#include "law/state_law_settings.h"

#if CONFIG_BLOCKS

#define STATE_FEEDBACK_LOOPS 4

struct state_feedback_settings {
    float f[STATE_FEEDBACK_LOOPS][STATE_FEEDBACK_INPUTS]; /* MV span per span of the input */
    float g[STATE_FEEDBACK_LOOPS][STATE_FEEDBACK_LOOPS];  /* MV span per span of the measurement */
    float ti_s[STATE_FEEDBACK_LOOPS];                     /* 0: no integral */
    float td_s[STATE_FEEDBACK_LOOPS];                     /* 0: no derivative */
    uint16_t law;                                         /* block; 0: those above */
};

extern const struct block_kind state_feedback_kind;

#endif
#endif

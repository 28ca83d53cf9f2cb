/* The kind `ff_tune` identifies a loop and the path of a measured disturbance while the loop is closed, and tunes a feedforward element from the
 * frequency responses (docs/methods/adaptive-feedforward.md; R. Siddha 2003). It has one loop, whose controller's output passes through unchanged: it is
 * a compensator so that it sees what the controller gave beside what took effect. Inputs: the PV, the disturbance. */
#ifndef REFLUX_FF_TUNE_FEEDFORWARD_TUNE_H
#define REFLUX_FF_TUNE_FEEDFORWARD_TUNE_H

#include "block/block.h"

/* 0 leaves it out of an image. */
#ifndef CONFIG_FEEDFORWARD_TUNE
#define CONFIG_FEEDFORWARD_TUNE CONFIG_BLOCKS
#endif

#if CONFIG_FEEDFORWARD_TUNE

/* Siddha's: 2.5, 3.2, 3.3, 3.4. In the order of the words. */
enum tune_method {
    TUNE_JOINT,       /* A: y by u and d */
    TUNE_SENSITIVITY, /* B: y by u, then y by d */
    TUNE_TRACKING,    /* C: y by r, then y by d */
    TUNE_INPUT        /* D: y by r, then u by d */
};
#define TUNE_METHOD_WORDS "joint|sensitivity|tracking|input"

struct tune_settings {
    /* Interval of the models' samples; 0: a base tick. */
    float period_s;
    /* The loop's PI: output span per PV span, with its sign; s; - */
    float gain, ti_s, b;
    /* rad/s; 0: found */
    float band_lo, band_hi;
    float learn_s, check_s, every_s;
    /* High-pass on all signals; 0: a quarter of learn. */
    float bias_s;
    float forget, forget_least, p0, memory, trace;
    /* Test signal on the setpoint: EU of the PV, s; step 0: none. */
    float step, step_period_s;
    /* Test signal on the disturbance, where that is an MV: EU, s; disturb 0: none. */
    float disturb, disturb_period_s;
    /* %, -, %, % */
    float settled, doubt, confident, better;
    float kick, lag_most_s, dead_most_s;
    /* Number of the ffN, or of the term of the leadlag that `block` names; block 0: an ffN. */
    uint16_t element, block;
    /* na, nb, delay; of u or r, then of d; nb 0: the source's. */
    uint16_t order[2][3];
    uint16_t tries;
    /* Samples of the two lags in series on all signals that are learnt from; 0: none. */
    uint16_t smooth;
    /* enum tune_method, rls_forgetting */
    uint8_t method, forgetting;
    /* The feedforward is off while the disturbance is identified. */
    uint8_t alone;
    /* ask|at_once, off|on, asked|at_once, compare|fall_back */
    uint8_t adopt, protect, begin, rules;
    /* From here on what it finds itself: the numbers of the element. */
    float k, lead_s, lag_s, dead_s;
};

enum tune_adopt { TUNE_ADOPT_ASKED, TUNE_ADOPT_AT_ONCE };

extern const struct block_kind feedforward_tune_kind;

#endif
#endif

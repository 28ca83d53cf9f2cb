/* The kind `ff_tune`: identifies a loop and how a measured disturbance comes into it while the loop is closed, and tunes a feedforward
 * element from the frequency responses (docs/adaptive-feedforward.md; R. Siddha 2003). One loop, whose controller's output
 * passes through unchanged: it is a compensator so that it sees what the controller gave beside what took effect. Inputs: the
 * PV, the disturbance. */
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
    float period_s;         /* of the models' samples; 0: a base tick */
    float gain, ti_s, b;    /* of the loop's PI: output span per PV span, with its sign; s; - */
    float band_lo, band_hi; /* rad/s; 0: found */
    float learn_s, check_s, every_s;
    float bias_s; /* of the high-pass on all signals; 0: a quarter of learn */
    float forget, forget_least, p0, memory, trace;
    float step, step_period_s; /* test signal on the setpoint: EU of the PV, s; step 0: none */
    float disturb, disturb_period_s;         /* on the disturbance, where that is an MV: EU, s */
    float settled, doubt, confident, better; /* %, -, %, % */
    float kick, lag_most_s, dead_most_s;
    uint16_t element;     /* which ffN, or which term */
    uint16_t block;       /* ... of which leadlag; 0: it is an ffN */
    uint16_t order[2][3]; /* na, nb, delay; of u or r, then of d; nb 0: the source's */
    uint16_t tries;
    uint16_t
        smooth; /* samples, of the two lags in series on all signals that are learnt from; 0: none */
    uint8_t method, forgetting; /* enum tune_method, rls_forgetting */
    uint8_t alone;              /* identify the disturbance with the feedforward off */
    uint8_t adopt, protect, begin,
        rules; /* ask|at_once, off|on, asked|at_once, compare|fall_back */
    /* From here on what it finds itself: what the element has. */
    float k, lead_s, lag_s, dead_s;
};

enum tune_adopt { TUNE_ADOPT_ASKED, TUNE_ADOPT_AT_ONCE };

extern const struct block_kind feedforward_tune_kind;

#endif
#endif

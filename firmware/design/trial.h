/* A proposed set of loops tried on the model, in the time domain: what a step will look like before it is made.
 *
 * Inputs are held between samples and the elements stepped exactly, dead times that are no whole number of samples
 * included; the controllers are the PI law of kinds/pid/pid.h without limits (a derivative is left out: settings with one
 * are refused). Linear, from rest. */
#ifndef REFLUX_DESIGN_TRIAL_H
#define REFLUX_DESIGN_TRIAL_H

#include <stdbool.h>

#include "design/loops.h"

#define TRIAL_DELAY   110   /* samples of every input that are remembered */
#define TRIAL_SAMPLES 10000 /* longest trial */

struct trial_config {
    uint8_t loop;      /* whose setpoint, or whose input, is stepped at time 0 */
    bool load;         /* a step at the plant's input of that loop; else of its setpoint */
    real_t size;       /* fraction of span, 1e-6 to 1e6, either sign */
    real_t duration_s; /* 1e-2 to 1e7; 0: fifteen times the largest integral time plus dead time */
    real_t setpoint_weight; /* b of the PID, 0 to 1 */
    real_t
        raise; /* factor on the gain of the loop that is stepped, 0 to 10; 0: as in the settings */
    real_t mark_s; /* how far it has come by then is remembered: 0, never, to 1e7 */
};

struct trial_loop {
    real_t iae; /* integral of |e|, fraction of span times s */
    /* Overshoot of the loop whose setpoint is stepped, the largest |e| of the others; in units of size. */
    real_t peak;
    /* From here |e| stays within 5 % of size; the duration when it does not come to that. */
    real_t settled_s;
    real_t moved; /* largest |u| of its input, fraction of span */
};

/* At mark_s, or at the end where that is earlier. */
struct trial_mark {
    real_t iae; /* of the loop whose setpoint is stepped */
    /* Its mean error over the last quarter, in the direction of the step: above 0 short of it. */
    real_t left;
    real_t others;              /* largest |e| of any other loop, in units of size */
    real_t moved[INTERACT_MAX]; /* largest |u| of every loop's input */
    real_t input[INTERACT_MAX]; /* u */
};

struct trial {
    /* Results */
    struct trial_mark mark;
    struct trial_loop loop[INTERACT_MAX];
    bool bounded; /* no output went past 100 times the step: it ended there otherwise */
    /* Samples had to be longer than the interval, and are no shorter than a fifth of the fastest integral time: the figures are rough. */
    bool coarse;
    real_t time_s; /* reached */
    /* Interval of a sample: that of the loops, or longer where dead times or the duration would not fit. */
    real_t step_s;
    real_t duration_s;

    /* Work: 14 KiB (float) */
    const struct interact_plant *plant;
    const struct loops *loops;
    struct trial_config config;
    struct loops_sampled sampled;
    real_t state[INTERACT_MAX][INTERACT_MAX], second[INTERACT_MAX][INTERACT_MAX];
    real_t past[INTERACT_MAX][TRIAL_DELAY];
    real_t integral[INTERACT_MAX], y[INTERACT_MAX];
    real_t left_sum;
    uint32_t left_n;
    uint32_t sample, steps;
    bool done;
};

/* ERR_RANGE, ERR_NOT_FINITE as interact_check, loops_check, or for config. plant and loops must live and stay as they
 * are. Then trial_step until it is not ERR_BUSY: four samples a call, about 4e4 instructions. */
MUST_CHECK enum err trial_begin(struct trial *t, const struct interact_plant *plant,
                                const struct loops *loops, const struct trial_config *config);
MUST_CHECK enum err trial_step(struct trial *t);

#endif

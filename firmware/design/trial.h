/* A proposed set of loops tried on the model, in the time domain: what a step will look like before it is made. */
#ifndef REFLUX_DESIGN_TRIAL_H
#define REFLUX_DESIGN_TRIAL_H

#include <stdbool.h>

#include "design/loops.h"

struct trial_config {
    uint8_t loop;      /* whose setpoint, or whose input, is stepped */
    bool load;         /* step of `size` at the plant's input of that loop; else of its setpoint */
    real_t size;       /* fraction of span, not 0 */
    real_t duration_s; /* 0: ten times the slowest loop, worked out */
    real_t
        step_s; /* 0: worked out from the fastest time constant, at least interval_s where there is one */
    real_t setpoint_weight; /* b of the PID, 0 to 1 */
};

struct trial_loop {
    real_t iae; /* integral of |e|, fraction of span times s */
    real_t
        peak; /* largest |y - setpoint| after the step first arrived (load), or overshoot past the setpoint, in
                         units of `size`; of the other loops the largest |e| in units of `size` */
    real_t settled_s; /* after it |e| stays within 5 % of size; duration when it never does */
    real_t moved;     /* largest |u| of the loop's input, fraction of span */
};

/* 18 KiB (float), of which the delay lines are TRIAL_DELAY samples for each input. */
#define TRIAL_DELAY 256
struct trial {
    /* Results */
    struct trial_loop loop[INTERACT_MAX];
    bool bounded; /* nothing exceeded 100 times the step */
    real_t time_s, step_s, duration_s;

    /* Work */
    const struct interact_plant *plant;
    const struct loops *loops;
    struct trial_config config;
    real_t state[INTERACT_MAX][INTERACT_MAX]; /* of every element */
    real_t decay[INTERACT_MAX][INTERACT_MAX];
    real_t past[INTERACT_MAX][TRIAL_DELAY];
    real_t y[INTERACT_MAX], integral[INTERACT_MAX], slope[INTERACT_MAX], last_y[INTERACT_MAX];
    uint32_t at, steps;
};

/* ERR_RANGE: config; or a dead time of more than TRIAL_DELAY - 2 steps when step_s is given. Then trial_step until it is
 * not ERR_BUSY: ten samples a call, at most 6e4 operations; 10000 samples at most. */
MUST_CHECK enum err trial_begin(struct trial *t, const struct interact_plant *plant,
                                const struct loops *loops, const struct trial_config *config);
MUST_CHECK enum err trial_step(struct trial *t);

#endif

/* Records of a trial: its bounds, the measurements and loops in it, and its verdicts. adoption.c writes them. */
#ifndef REFLUX_COMMISSION_TRIAL_RECORDS_H
#define REFLUX_COMMISSION_TRIAL_RECORDS_H

#include "commission/trial_line_state.h"
#include "design/trial.h"

/* Bounds for a deviation from the prediction. */
#define ADOPTION_IAE      REAL_C(2.5)  /* times the predicted integral of the error */
#define ADOPTION_PEAK     REAL_C(0.35) /* of the step, past the predicted overshoot */
#define ADOPTION_DURATION REAL_C(1.5)  /* times the predicted settling time, at most */
#define ADOPTION_REPEATS  2u           /* repetitions of steps that a drift has spoilt */

/* A measurement; that of loop k is the k-th, and after those come the ones that no loop holds. */
struct adoption_channel {
    uint8_t measurement;    /* index in the configuration */
    uint8_t output;         /* index in the tests */
    real_t noise_sd;        /* fraction of span */
    real_t limit;           /* farthest from the operating point, fraction of span */
    struct trial_line line; /* of the rest in which the outputs were held */
};

/* Prediction for the step of a loop whose gain is raised: its way back in the trial. */
struct trial_probe {
    /* Largest |u| of any input over that of the step with the accepted gain; 0: not predicted, and the loop is not probed. */
    real_t moved;
    real_t others; /* largest |e| of any other loop, in units of the step */
    real_t left;   /* error left in the last quarter, in units of the step, in its direction */
    bool planned;  /* it fits into the limits */
};

/* A loop on trial; an inner loop uses `loop` and `test_base` alone. */
struct adoption_loop {
    uint8_t loop;      /* index in the plan */
    uint8_t output;    /* that it moves, directly or through others, in the configuration */
    real_t step;       /* of its setpoint, fraction of span, signed */
    real_t duration_s; /* of its step */
    struct trial_loop predicted; /* for a step of `size`; iae until duration_s */
    real_t left;      /* error predicted for the last quarter, in the step's direction, likewise */
    real_t size;      /* step of the prediction */
    real_t iae, peak; /* found on trial; peak in units of the step */
    real_t test_base; /* output before the trial, fraction of span */
};

enum adoption_result {
    ADOPTION_RUNNING,
    ADOPTION_PASSED,
    ADOPTION_PAST_LIMIT,
    ADOPTION_SLOW,
    ADOPTION_OVERSHOOT,
    ADOPTION_RESTLESS,
    ADOPTION_SWINGS,  /* half cycles of the error that do not decay */
    ADOPTION_BLOCKED, /* an output stood at its limit */
    ADOPTION_MARGIN,  /* the loop is not stable with a raised gain */
    ADOPTION_LEFT,    /* at rest too far from the operating point */
    ADOPTION_HAND /* a loop did not go to automatic, or somebody moved a mode, a setpoint or an output */
};

#endif

/* An accepted set of loops on trial, on the plant: every loop's setpoint is stepped once, there and back, and what it
 * does is held against what was predicted. */
#ifndef REFLUX_COMMISSION_ADOPTION_H
#define REFLUX_COMMISSION_ADOPTION_H

#include "design/trial.h"
#include "supervise/supervisor.h"

/* How much worse than predicted is accepted. */
#define ADOPTION_IAE      REAL_C(2.5)  /* times the predicted integral of the error */
#define ADOPTION_PEAK     REAL_C(0.35) /* of the step, past the predicted overshoot */
#define ADOPTION_DURATION REAL_C(1.5)  /* times the predicted settling time */

struct adoption_loop {
    uint8_t loop;                /* index in the plan */
    real_t step;                 /* of its setpoint, fraction of span, either sign */
    real_t noise_sd;             /* fraction of span */
    real_t drift_per_s;          /* to be reckoned with, fraction of span per second */
    real_t limit;                /* farthest from the setpoint, fraction of span */
    struct trial_loop predicted; /* per unit of `size` */
    real_t size;                 /* step of the prediction */
    real_t iae, peak;            /* as found; peak in units of the step */
    real_t held;                 /* output before the trial, fraction of span */
};

enum adoption_result {
    ADOPTION_RUNNING,
    ADOPTION_PASSED,
    ADOPTION_PAST_LIMIT,
    ADOPTION_SLOW,
    ADOPTION_OVERSHOOT,
    ADOPTION_RESTLESS,
    ADOPTION_NOT_AUTO /* a loop did not go to automatic, or left it */
};

struct adoption {
    uint8_t n, at;   /* loops; the one under trial */
    uint8_t n_inner; /* behind them in loop[]: inner loops, which have no setpoint to step */
    struct adoption_loop loop[CONFIG_LOOPS];
    enum adoption_result result;
    uint8_t culprit; /* in loop[] */
    uint8_t stage;
    uint32_t ticks, stage_ticks;
    real_t start[CONFIG_LOOPS]; /* setpoints before, fraction of span */
    real_t error_sum;
    uint32_t error_n;
};

/* Remembers where the outputs are. n and loop[].loop are filled in. */
void adoption_hold(struct adoption *a, const struct supervisor *s);
/* n and loop[] as far as `size` are filled in. Puts the loops into automatic where they are. */
void adoption_begin(struct adoption *a, struct supervisor *s);
/* A tick of it, after validate and before control. */
enum adoption_result adoption_tick(struct adoption *a, struct supervisor *s);

#endif

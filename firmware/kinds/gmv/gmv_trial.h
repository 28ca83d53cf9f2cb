/* The closed loop of a set of parameters with itself as the plant, simulated: does what was upset die away, and how fast?
 * Ours: certainty equivalence, tried with the plant's gains as estimated, over and times `margin`.
 *
 * Everything is a plain float copy of what the self-tuner uses at that moment, so that it can run between ticks: first
 * gmv_trial_take, then gmv_trial_piece until it returns false, then gmv_trial_decay.
 *
 * Setpoints and measured disturbances are 0, and so is the bias: in a linear loop they do not change how it decays. The proxy
 * of residuals is left out.
 *
 * Then law and PI are compared on the model as it is estimated: a setpoint step of each loop and a load, and a sample of sensor
 * noise. Of R only `tau_r` -1 is tried, which makes it P; a filter that the user sets is left out, because the PI has none. */
#ifndef REFLUX_GMV_GMV_TRIAL_H
#define REFLUX_GMV_GMV_TRIAL_H

#include "kinds/gmv/gmv_inside.h"

#define GMV_TRIAL_KEPT   32u /* steps of a signal, a power of two; GMV_KEPT of the self-tuner */
#define GMV_TRIAL_GAINS  3u  /* as estimated, over the margin, times it */
#define GMV_TRIAL_WINDOW 128u
#define GMV_TRIAL_STEPS  (5u * GMV_TRIAL_WINDOW)

/* Runs behind those for the decay, with the gains as estimated, first of the law and then of the PI: setpoint steps and a load;
 * one sample of noise. */
enum gmv_trial_run {
    GMV_TRIAL_LAW = GMV_TRIAL_GAINS,
    GMV_TRIAL_PI,
    GMV_TRIAL_LAW_NOISE,
    GMV_TRIAL_PI_NOISE,
    GMV_TRIAL_RUNS
};

/* The PI of a loop: moves of the MV are gain (e(t) - e(t-1)) + integral e(t-1), e = setpoint - PV; spans. */
struct gmv_trial_pi {
    float gain, integral;
};

/* A loop that takes part: its regression as the plant, and what the law makes of it. */
struct gmv_trial_loop {
    bool acts, weighs_setpoint; /* the latter: R is P */
    struct gmv_trial_pi pi;
    uint8_t horizon, delay; /* of the regression, of the law */
    uint8_t
        plant_behind[GMV_LOOPS]; /* steps from u_j's entry to its first one, in the regression */
    uint8_t behind[GMV_LOOPS];   /* the same in the law */
    bool uses[GMV_LOOPS];        /* u_j is in its model */
    float p, p_scale,
        lambda; /* P = p_scale (1 - p z^-1), of the regression p_scale 1, p 0 in the explicit way */
    float f[GMV_TERMS_MAX], g[GMV_LOOPS][GMV_TERMS_MAX], c[GMV_NOISE_MAX]; /* plant */
    float law_p, law_p_scale;
    float law_f[GMV_TERMS_MAX], law_g[GMV_LOOPS][GMV_TERMS_MAX + GMV_DELAY_MAX];
};

struct gmv_trial {
    uint8_t loops, na, nb, nc, ng;
    bool incremental, scalar, implicit, takes_error; /* the last: `bias error` */
    float determinant, gain[GMV_TRIAL_GAINS];
    struct gmv_trial_loop loop[GMV_LOOPS];
    /* The run under way. */
    uint8_t run;
    uint16_t step;
    float y[GMV_LOOPS][GMV_TRIAL_KEPT], u[GMV_LOOPS][GMV_TRIAL_KEPT];
    float target[GMV_LOOPS][GMV_TRIAL_KEPT], predicted[GMV_LOOPS][GMV_TRIAL_KEPT];
    float largest, first, start; /* of this window, of the one that is compared with, of all */
    uint16_t first_at;           /* its place, windows */
    float decay[GMV_TRIAL_GAINS];
    float setpoint[GMV_LOOPS], setpoint_before[GMV_LOOPS], load[GMV_LOOPS];
    float error[GMV_LOOPS]; /* the PI's last */
    /* Of law and PI: sums of |setpoint - PV| before the load and after it, of squared PVs and moves after a sample of noise. */
    struct gmv_trial_sums {
        float setpoint, load, noise, moves;
    } sums[2][GMV_LOOPS];
};

/* The parameters in use of g. acting: a bit for each loop that acts; MVs of the others rest. margin: > 1. pi: of each loop. */
void gmv_trial_take(struct gmv_trial *t, const struct gmv *g, uint8_t acting, float margin,
                    const struct gmv_trial_pi *pi);
/* A piece of it, a few steps; true while there is more. */
bool gmv_trial_piece(struct gmv_trial *t);
/* The same once more, with every lambda times `times`. */
void gmv_trial_again(struct gmv_trial *t, float times);
/* By what factor the slowest part of an upset shrinks in a step: of the run with the plant's gains as estimated (0), over the
 * margin (1), times it (2). Above 1 it grows. What is gone within a window counts as 0.64. */
float gmv_trial_decay(const struct gmv_trial *t, unsigned run);
/* The largest of the three. */
float gmv_trial_worst(const struct gmv_trial *t);
/* Errors of the law after a setpoint step and after a load, as parts of the PI's on the same model: the worst of all. answer: one for
 * each loop, the PI's error after a setpoint step of 1 as it really was, in steps; it counts where it is smaller, because
 * then the model is at fault. 0: not known. */
float gmv_trial_ratio(const struct gmv_trial *t, const float *answer);
/* What sensor noise with the mean square 1 does to loop i under the law: mean square of its moves, and by how much that of its PV is
 * more than the PI's; both 1e6 at most. */
void gmv_trial_noise(const struct gmv_trial *t, unsigned i, float *error_more, float *moves);

#endif

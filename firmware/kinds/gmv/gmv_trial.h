/* Simulates the closed loop of a set of parameters with itself as the plant: does an upset die away, and how fast?
 * Ours: certainty equivalence, tried with the plant's gains as estimated, over and times `margin`.
 *
 * All of it is a plain float copy of the parameters in use at that moment, so that it can run between ticks: first
 * gmv_trial_take, then gmv_trial_piece until it returns false, then gmv_trial_decay.
 *
 * Setpoints and measured disturbances are 0, and so is the bias: in a linear loop they do not change its decay. The proxy
 * of residuals is left out.
 *
 * Then law and PI are compared on the model as it is estimated: a setpoint step of each loop and a load, and a sample of sensor
 * noise. Of R only `tau_r` -1 is tried, which makes it P; a filter that the user sets is left out, because the PI has none. */
#ifndef REFLUX_GMV_GMV_TRIAL_H
#define REFLUX_GMV_GMV_TRIAL_H

#include "kinds/gmv/gmv.h"

/* Number of samples kept of a signal, a power of two, as the self-tuner keeps (gmv_samples_state.h). */
#define GMV_TRIAL_KEPT 32u
/* Gains of the plant: as estimated, over the margin, times it. */
#define GMV_TRIAL_GAINS  3u
#define GMV_TRIAL_WINDOW 128u
#define GMV_TRIAL_STEPS  (5u * GMV_TRIAL_WINDOW)

/* Runs after the three for the decay, with the gains as estimated, first of the law and then of the PI: setpoint steps and a load;
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

struct gmv_trial;

/* Copies the parameters in use of g. acting: a bit for each loop that acts; MVs of the others rest. margin: > 1. pi: of each loop. */
void gmv_trial_take(struct gmv_trial *t, const struct gmv *g, uint8_t acting, float margin,
                    const struct gmv_trial_pi *pi);
/* Runs a few steps. True: not finished. */
bool gmv_trial_piece(struct gmv_trial *t);
/* Starts again with every lambda times `times`. */
void gmv_trial_again(struct gmv_trial *t, float times);
bool gmv_trial_acts(const struct gmv_trial *t, unsigned i);
/* Returns the factor by which the slowest part of an upset shrinks in a step: of the run with the plant's gains as estimated (0), over the
 * margin (1), times it (2). Above 1 it grows. An upset that is gone within a window counts as 0.64. */
float gmv_trial_decay(const struct gmv_trial *t, unsigned run);
/* Returns the largest of the three. */
float gmv_trial_worst(const struct gmv_trial *t);
/* Returns the law's errors after a setpoint step and after a load, as parts of the PI's on the same model: the worst of all. answer: for
 * each loop the PI's recorded error after a setpoint step of 1, in steps; it counts where it is smaller, because
 * then the model is wrong. 0: not known. */
float gmv_trial_ratio(const struct gmv_trial *t, const float *answer);
/* Gives the effect of sensor noise with the mean square 1 on loop i under the law: mean square of its moves, and that of its PV less the
 * PI's; both 1e6 at most. */
void gmv_trial_noise(const struct gmv_trial *t, unsigned i, float *error_more, float *moves);

#endif

#ifndef REFLUX_GMV_GMV_TRIAL_STATE_H
#define REFLUX_GMV_GMV_TRIAL_STATE_H

#include "kinds/gmv/gmv_trial.h"

/* A loop of the trial: its regression as the plant, and the law made of it. */
struct gmv_trial_loop {
    bool acts;
    /* R is P. */
    bool weighs_setpoint;
    struct gmv_trial_pi pi;
    /* Steps that the regression and the law look ahead. */
    uint8_t horizon, delay;
    /* Steps from u_j's entry to its first one, in the regression and in the law. */
    uint8_t plant_behind[GMV_LOOPS];
    uint8_t behind[GMV_LOOPS];
    /* u_j is in its model. */
    bool uses[GMV_LOOPS];
    /* P = p_scale (1 - p z^-1), of the regression p_scale 1, p 0 in the explicit way. */
    float p, p_scale, lambda;
    /* The plant. */
    float f[GMV_TERMS_MAX], g[GMV_LOOPS][GMV_TERMS_MAX], c[GMV_NOISE_MAX];
    float law_p, law_p_scale;
    float law_f[GMV_TERMS_MAX], law_g[GMV_LOOPS][GMV_TERMS_MAX + GMV_DELAY_MAX];
};

/* Sums of |setpoint - PV| before the load and after it, of squared PVs and moves after a sample of noise. */
struct gmv_trial_sums {
    float setpoint, load, noise, moves;
};

struct gmv_trial {
    uint8_t loops, na, nb, nc, ng;
    bool incremental, scalar, implicit;
    /* The bias is the prediction error. */
    bool takes_error;
    /* The run under way. */
    uint8_t run;
    uint16_t step;
    /* Number of the window compared with. */
    uint16_t first_window;
    float determinant, gain[GMV_TRIAL_GAINS];
    /* Largest size of an upset: in this window, in the window compared with, in the first one. */
    float largest, first, start;
    float decay[GMV_TRIAL_GAINS];
    float setpoint[GMV_LOOPS], setpoint_before[GMV_LOOPS], load[GMV_LOOPS];
    /* The PI's last errors. */
    float error[GMV_LOOPS];
    struct gmv_trial_loop loop[GMV_LOOPS];
    float y[GMV_LOOPS][GMV_TRIAL_KEPT], u[GMV_LOOPS][GMV_TRIAL_KEPT];
    float target[GMV_LOOPS][GMV_TRIAL_KEPT], predicted[GMV_LOOPS][GMV_TRIAL_KEPT];
    /* Sums of the law and of the PI. */
    struct gmv_trial_sums sums[2][GMV_LOOPS];
};

#endif

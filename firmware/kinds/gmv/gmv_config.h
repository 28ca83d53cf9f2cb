/* Settings of a self-tuner and their check. */
#ifndef REFLUX_GMV_GMV_CONFIG_H
#define REFLUX_GMV_GMV_CONFIG_H

#include "base/error.h"
#include "identify/rls.h"
#include "kinds/gmv/gmv_shape.h"

struct gmv_config {
    struct gmv_shape shape;
    float interval_s;
    /* Time constants of P and R, s; 0: none. R below 0: R is P, so that setpoint and PV weigh the same. */
    float tau_p_s[GMV_LOOPS], tau_r_s[GMV_LOOPS];
    /* PV span per MV span, with the sign of the loop's own g0; 0: none. */
    float lambda[GMV_LOOPS];
    /* Below this determinant the loops are solved one by one, (0, 1). */
    float determinant;
    /* Diagonal of P(0), p0_u for the terms of the MVs. */
    float p0, p0_u;
    /* gmv_rls_settings fills in n, p0, lo and hi. */
    struct rls_settings rls;
    /* Start values. */
    float theta[GMV_LOOPS][GMV_PARAMETERS];
    /* Bounds where hi > lo; else none. */
    float lo[GMV_LOOPS][GMV_PARAMETERS], hi[GMV_LOOPS][GMV_PARAMETERS];
};

/* *field: the block's parameter that is wrong, *wanted: what would be right, *loop: its loop. */
MUST_CHECK enum err gmv_check(const struct gmv_config *c, unsigned *loop, const char **field,
                              const char **wanted);
/* Settings of loop i's estimator. p0: memory of the caller that they point to, GMV_PARAMETERS numbers. */
struct rls_settings gmv_rls_settings(const struct gmv_config *c, unsigned i, float *p0);

#endif

/* The opponent of the estimator `composition`: the extended Kalman filter of all mole fractions of the same column, with the covariance
 * of all of them, as well as it can be done in float with the same functions of the model. Temperatures are worked in one after the
 * other. What differs is how the covariance is carried over a sample:
 *
 *   DENSE_EULER       P + h (J P + P J' + Q), J as a band, one step of 0.3 s: the least that any form costs, but not a sample, since a
 *                     longer step lets P lose its sign on this column
 *   DENSE_STEPS       the same for a whole sample, in as many steps as are stable, J held; mole fractions by the factors of a band
 *   DENSE_BAND        F P F' + h Q, F = (I - h J)^-1 by the factors of a band: one step, stable for any h, as the estimator's own
 *   DENSE_TRANSITION  the same, F as a matrix and two products, as textbooks have it
 */
#ifndef REFLUX_BENCH_DENSE_EKF_H
#define REFLUX_BENCH_DENSE_EKF_H

#include "column.h"

#define DENSE_STAGES 37
#define DENSE_STATES ((size_t)2 * DENSE_STAGES)
#define DENSE_LOWER  7 /* of the band with 3 components and an efficiency below 1 */
#define DENSE_UPPER  3
#define DENSE_WIDTH  (DENSE_LOWER + 1 + DENSE_UPPER)

enum dense_form { DENSE_EULER, DENSE_STEPS, DENSE_BAND, DENSE_TRANSITION };

struct dense_ekf {
    struct column column;
    struct column_config config;
    real_t x[DENSE_STATES], change[DENSE_STATES];
    real_t e[BENCH_SENSORS], b[BENCH_SENSORS][COLUMN_COMPONENTS_MAX]; /* of a step */
    /* LAPACK's storage: (row, col) at col WIDTH + UPPER + row - col */
    real_t band[DENSE_STATES * DENSE_WIDTH];
    real_t p[DENSE_STATES * DENSE_STATES];
    real_t work[DENSE_STATES * DENSE_STATES];
    real_t transition[DENSE_STATES * DENSE_STATES];
    uint8_t stage[BENCH_SENSORS];
    real_t h, noise2, model2;
    enum dense_form form;
    /* of Euler's in a sample: more than h |lambda|, of the largest eigenvalue of J */
    uint32_t steps;
};

/* Begins at the estimate, for the inputs, the sensors and the noise of an estimator of DENSE_STAGES stages. */
enum err dense_ekf_begin(struct dense_ekf *ekf, const struct composition_block *like,
                         enum dense_form form);

/* One step to the readings t[BENCH_SENSORS]: a sample of BENCH_STEP_S, of DENSE_EULER 0.3 s. */
enum err dense_ekf_step(struct dense_ekf *ekf, const struct column_inputs *inputs, const real_t *t);

/* Its two parts: rates, their derivatives and deviations; the covariance, and with it the mole fractions. */
enum err dense_ekf_model(struct dense_ekf *ekf, const struct column_inputs *inputs,
                         const real_t *t);
void dense_ekf_covariance(struct dense_ekf *ekf);

/* Without the matrices that a form does not need. */
uint32_t dense_ekf_bytes(enum dense_form form);

#endif

/* Over-parameterised difference models of one output and one or two inputs, by recursive least squares, of which the frequency response
 * is used and never a coefficient (R. Siddha 2003, sections 2.2 and 3.2 to 3.4; his models are high_order_siddha_ below):
 *
 *     y(k) = - sum_i a_i y(k - i) + sum_j sum_i b_j,i u_j(k - delay_j - i) + e(k)     i = 1 .. na, 0 .. nb_j - 1
 *
 * Dead time is not estimated: delay_j is a lower bound of it, and B_j has coefficients enough for the largest. Coefficients of A to spare
 * make e whiter, which is what least squares needs. Two inputs have A in common, so it drops out of the ratio of their
 * responses.
 *
 * Confidence is that of least squares: standard deviations from P and the size of e. It holds where e is white and
 * the model can be the plant. It says nothing of what is left of the dead time outside delay_j .. delay_j + nb_j - 1; noise of a
 * sensor makes e coloured as long as A is short; and in closed loop with a poor model of the noise the error is a bias, which no P knows of. With
 * the source's settings and signals as they are it is up to 6.6 times what P says. With all signals through two lags of half the
 * dead time, which no response notices, it is up to 1.7 times what P says, and as large as a half (method D at 0.5 to 1 rad/s) down to a
 * ninth (method A there) of what it was: tests/unit/test_high_order_confidence.c, table in tests/campaign/results/feedforward-notes.md. P(0)
 * has to be large for that: what the lags leave is small.
 *
 * Signals are num_t, filtered by the caller with one and the same filter, |values| up to 2. */
#ifndef REFLUX_IDENTIFY_HIGH_ORDER_H
#define REFLUX_IDENTIFY_HIGH_ORDER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "identify/rls.h"
#include "num/cmatrix.h"

#define HIGH_ORDER_INPUTS     2
#define HIGH_ORDER_DELAY_MOST 100 /* samples, of delay + nb */

struct high_order_shape {
    uint8_t na;                       /* 0 to RLS_MAX less the others */
    uint8_t inputs;                   /* 1 or HIGH_ORDER_INPUTS */
    uint8_t nb[HIGH_ORDER_INPUTS];    /* coefficients of each B, 1 and more */
    uint8_t delay[HIGH_ORDER_INPUTS]; /* samples, 0: u_j(k) acts on y(k) */
};

/* P(0) = p0 I. Of the other rules see identify/rls.h. */
struct high_order_settings {
    uint8_t forgetting; /* enum rls_forgetting */
    float forget, forget_least, memory, sigma0, trace;
    float p0; /* [1e-6, 1e9], output squared per input squared */
};

struct high_order; /* in the caller's memory, that may be moved between calls */

/* na + nb_0 + nb_1 */
unsigned high_order_parameters(const struct high_order_shape *shape);
/* *field: which is wrong, *wanted: what would be right; either may be NULL. */
MUST_CHECK enum err high_order_check(const struct high_order_shape *shape,
                                     const struct high_order_settings *settings, const char **field,
                                     const char **wanted);
/* Bytes for a shape that high_order_check accepts; a multiple of 8. Memory is aligned to 8. */
uint32_t high_order_bytes(const struct high_order_shape *shape);

/* From theta = 0, with no past. What high_order_check accepts. */
void high_order_init(struct high_order *h, const struct high_order_shape *shape,
                     const struct high_order_settings *settings);
/* P = p0 I once more; theta and the past stay (covariance reset). */
void high_order_reset(struct high_order *h);
/* Other rules of forgetting; theta, P and the past go on. */
void high_order_retune(struct high_order *h, const struct high_order_settings *settings);

/* A sample: y(k) and u [inputs] at k. learn false: the past goes on and nothing is learnt, of this sample; nothing is either
 * before the past is whole. Returns e(k). */
num_t high_order_step(struct high_order *h, num_t y, const num_t *u, bool learn);

/* Samples are missing before the next one: nothing is learnt until the past is whole again. */
void high_order_interrupt(struct high_order *h);

/* Samples that were learnt from. */
uint32_t high_order_samples(const struct high_order *h);
const struct rls *high_order_rls(const struct high_order *h);

/* A response at a frequency, or a ratio of two. */
struct high_order_point {
    struct cplx value;
    /* Root of the mean square of the distance to the true value, as P has it. */
    real_t sd;
};

/* omega_h: rad per sample, (0, pi]. Of input j; ERR_SINGULAR: A has a root there, nothing is written. Takes no more than 4 n^2 + 100 n
 * multiplications. Not while high_order_step() may learn. */
MUST_CHECK enum err high_order_response(const struct high_order *h, unsigned j, real_t omega_h,
                                        struct high_order_point *p);
/* The response to input 1 over that to input 0, without A. ERR_SINGULAR: B_0 has a root there. */
MUST_CHECK enum err high_order_ratio(const struct high_order *h, real_t omega_h,
                                     struct high_order_point *p);

/* The source's models, sampling 0.05 s, dead times 0.4 to 0.8 s (equations 2.1 and 2.2, 3.3, 3.4, 3.7, 3.10). */
extern const struct high_order_shape high_order_siddha_joint, high_order_siddha_process,
    high_order_siddha_sensitivity, high_order_siddha_tracking, high_order_siddha_input;

#endif

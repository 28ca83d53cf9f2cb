/* Recursive least squares with forgetting, in U D U' form: theta in  y = phi'theta + noise  from a sample at a time.
 *
 *     e = y - phi'theta    alpha = v + phi'P phi    K = P phi/alpha    theta += K e    P = (P - P phi phi'P/alpha)/v
 *
 * Rules of forgetting, correction into bounds, normalisation, limit and dead zone: docs/methods/self-tuning.md has the equations and
 * their sources (T. O. Folami 1989, 8.40 to 8.53, 9.3, A5.1). phi, y and theta are num_t; theta is kept wide, so that small
 * corrections add up; P has the exponents of scaled_t in the fixed build.
 *
 * Memory is the caller's: rls_bytes(n) bytes, aligned like a float, that may be moved between calls. */
#ifndef REFLUX_IDENTIFY_RLS_H
#define REFLUX_IDENTIFY_RLS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "num/accumulator.h"
#include "num/scaled.h"

#define RLS_MAX 35 /* parameters */

/* In the order of the words of block parameters. */
enum rls_forgetting {
    RLS_CONSTANT,
    RLS_FORTESCUE,    /* VFF1 */
    RLS_YDSTIE,       /* VFF2 */
    RLS_YDSTIE_TRACE, /* VFF3 */
    RLS_HELD_TRACE,
    RLS_RESET,
    RLS_DIRECTIONAL,
    RLS_BOUNDED
};
#define RLS_FORGETTING_WORDS                                                                       \
    "constant|fortescue|ydstie|ydstie_trace|held_trace|reset|directional|bounded"

enum rls_correction { RLS_CORRECT_NONE, RLS_CORRECT_PC, RLS_CORRECT_SPC };
#define RLS_CORRECTION_WORDS "none|pc|spc"

struct rls_settings {
    uint8_t n;          /* parameters, 1 to RLS_MAX */
    uint8_t forgetting; /* enum rls_forgetting */
    uint8_t correction; /* enum rls_correction */
    bool normalise;
    float forget;       /* v of the constant rules, [0.5, 1] */
    float forget_least; /* no v is below, [0.01, 1] */
    float sigma0;       /* of RLS_FORTESCUE, y squared, [1e-12, 1e6] */
    float memory;       /* N0 of RLS_YDSTIE, in y squared, [1e-12, 1e6] */
    /* The trace of RLS_HELD_TRACE and RLS_RESET; the most of RLS_BOUNDED and RLS_DIRECTIONAL, [1e-6, 1e12]. */
    float trace;
    const float *p0;  /* [n] diagonal of P(0), [1e-6, 1e9]; read during init and retune only */
    float rate;       /* alpha of PC with alpha p0 < 2, mu of SPC in (0, 2) */
    float error_most; /* e is clipped to +- this, y; 0: never */
    float dead_zone;  /* in deviations of e as measured; 0: none */
    /* [n] bounds, hi > lo; where hi <= lo there are none. NULL: none at all. Read during init only. */
    const float *lo, *hi;
};

struct rls; /* in the caller's memory */

uint32_t rls_bytes(unsigned n);
/* Everything is checked. *field: the member that is wrong, *wanted: what would be right, in words; NULL: not wanted. */
MUST_CHECK enum err rls_check(const struct rls_settings *settings, const char **field,
                              const char **wanted);
/* Settings that rls_check accepts. theta: [n] start values. */
void rls_init(struct rls *r, const struct rls_settings *settings, const num_t *theta);
/* New settings with the same n: theta and P go on. */
void rls_retune(struct rls *r, const struct rls_settings *settings);
/* P = p0 I; theta goes on. */
void rls_reset(struct rls *r);
/* theta, where somebody else has put it. */
void rls_set(struct rls *r, const num_t *theta);

/* A sample. With more than 24 parameters every |phi| is below 64. Returns e = y - phi'theta with the parameters of before (not clipped). learn false: nothing changes but
 * that, and what it would have told. */
num_t rls_step(struct rls *r, const num_t *phi, num_t y, bool learn);

num_t rls_predict(const struct rls *r, const num_t *phi);
num_t rls_theta(const struct rls *r, unsigned i);
/* P_ij, P's trace, least and largest D, v of the last step, phi'P phi/(v + phi'P phi) of the last step: how much it told, 0 to 1. */
float rls_covariance(const struct rls *r, unsigned i, unsigned j);
/* c'P c, c [n], finite and not all 0, whatever their size: times the variance of e that of c'theta, where e is white. */
float rls_form(const struct rls *r, const float *c);
float rls_trace(const struct rls *r);
void rls_d_extremes(const struct rls *r, float *least, float *most);
float rls_forgot(const struct rls *r);
float rls_told(const struct rls *r);
/* Standard deviation of e, measured with a memory of 200 samples. */
float rls_error_sd(const struct rls *r);
/* Steps in which an element of D had to be kept within 1e-12 to 1e12, the last resort against a rule of forgetting without bounds. */
uint32_t rls_clamped(const struct rls *r);

#endif

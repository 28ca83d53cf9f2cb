/* Controller of one loop in discrete time by pole placement, two degrees of freedom and integral action:
 *
 *     K P u = R w - Q y,   K = 1 - z^-1,   A y = B u,   A K P + B Q = M O
 *
 * Source of the form: Kotyk and Machacek (1995), Eq. 4; which polynomials, and how they follow from an overshoot, is ours: M has a pair
 * of poles r exp(+-i theta), r such that r^(t/T) is 2 % after the settling time, theta such that the sampled step response of
 * B M(1)/(B(1) M) overshoots by what was asked for; O = (1 - o z^-1)^n filters measurements and cancels in R = O M(1)/B(1), n the
 * degree of A as far as there is room. P and Q are those of least degree (Astrom and Wittenmark, Computer-Controlled Systems, 5). All
 * polynomials are in z^-1, coefficient 0 first. */
#ifndef REFLUX_DESIGN_POLE_PLACEMENT_H
#define REFLUX_DESIGN_POLE_PLACEMENT_H

#include "design/double_symbols.h"
#include "num/polynomial.h"
#include "num/svd.h"

#define POLE_PLACEMENT_MOST MATRIX_MAX /* degrees of A and B together */

struct pole_placement_goal {
    real_t overshoot;    /* of a setpoint step, 0 to 0.5 */
    real_t settling_s;   /* until its envelope is 2 %, 2 to 200 periods */
    real_t observer;     /* o, 0 (dead-beat) to 0.95 */
    real_t condition_hi; /* largest condition number of the equations for P and Q, 10 to 1e6 */
};

struct pole_placement {
    struct polynomial p, q, r; /* p[0] = 1; Q(1) = R(1) */
    struct polynomial poles;   /* M O */
    real_t radius, angle;      /* r, theta */
    real_t condition;          /* of the equations, rows and columns of one norm */
    real_t overshoot;          /* of the sampled step response */
    /* Only pole_placement_judge() gives these. */
    real_t residual;    /* largest coefficient of A K P + B Q - M O */
    real_t input_peak;  /* largest |u| during a setpoint step of 1 from rest */
    real_t sensitivity; /* largest |A K P/(M O)| at 128 frequencies up to pi/T */
};

struct pole_placement_work {
    struct matrix equations, scaled;
    struct lu lu;
    struct svd svd;
};

/* The fault, in words; pointers to constant text. */
struct pole_placement_refusal {
    const char *field, *wanted;
};

/* 10 % overshoot (that of the paper), no observer, condition up to 1e4; settling_s is left to be given. */
void pole_placement_goal_default(struct pole_placement_goal *goal);

/* a: 1 first. b: 0 first, its delay leading zeros. ERR_RANGE: goal or polynomials, an overshoot that no theta gives; ERR_FULL: degrees
 * above POLE_PLACEMENT_MOST; ERR_SINGULAR: A and B have a zero in common, or nearly, or B(1) is 0. why may be NULL. Up to 3e6
 * instructions. */
MUST_CHECK enum err pole_placement_design(const struct polynomial *a, const struct polynomial *b,
                                          real_t period_s, const struct pole_placement_goal *goal,
                                          struct pole_placement_work *work,
                                          struct pole_placement *result,
                                          struct pole_placement_refusal *reason);

/* Judges a design for these polynomials: residual, input_peak and sensitivity. ERR_FULL: a product is too long. Up to 1e5
 * instructions. */
MUST_CHECK enum err pole_placement_judge(const struct polynomial *a, const struct polynomial *b,
                                         struct pole_placement *result);

#endif

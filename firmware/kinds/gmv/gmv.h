/* Generalised minimum variance self-tuning of one loop or two: data, regression and control law, without supervision
 * (kinds/gmv/gmv_kind.c has that). Equations and sources: docs/self-tuning.md.
 *
 * A step of the block:  gmv_take (what was measured)  ->  gmv_learn (one regression per loop)  ->  gmv_solve (the MVs).
 * All signals are num_t fractions of span. What was applied of the MVs is looked up in their histories. */
#ifndef REFLUX_GMV_GMV_H
#define REFLUX_GMV_GMV_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "block/applied_history.h"
#include "identify/rls.h"

#define GMV_LOOPS        2
#define GMV_DISTURBANCES 2
#define GMV_TERMS_MAX    5  /* na, nb */
#define GMV_NOISE_MAX    2  /* nc */
#define GMV_DELAY_MAX    8  /* k_ij, steps */
#define GMV_AVERAGE_MAX  8  /* steps of the data filter */
#define GMV_PARAMETERS   12 /* of one loop, at most */

/* In the order of the words of the block's parameters. */
enum gmv_form { GMV_POSITIONAL, GMV_INCREMENTAL };
enum gmv_way { GMV_IMPLICIT, GMV_EXPLICIT };
enum gmv_weight { GMV_WEIGHT_DELTA, GMV_WEIGHT_SCALAR };
/* Stored as these numbers. The first three are of the positional form; GMV_BIAS_ERROR of the incremental one (Folami 1989, 8.18). */
enum gmv_bias { GMV_BIAS_ONE, GMV_BIAS_RESIDUALS, GMV_BIAS_NONE, GMV_BIAS_ERROR };

/* What makes the data of the regressions: where one of these changes, data and estimates begin anew. */
struct gmv_shape {
    uint8_t loops;                   /* 1 or 2 */
    uint8_t form, way, weight, bias; /* enums above */
    uint8_t na, nb, nc; /* terms of y, of each u, of past predictions: 1..5, 1..5, 0..2 */
    /* k_ij, steps from MV j to PV i; 0: u_j is not in loop i's model. 1 <= k_ii <= k_ij <= GMV_DELAY_MAX */
    uint8_t delay[GMV_LOOPS][GMV_LOOPS];
    uint8_t disturbances;      /* 0..GMV_DISTURBANCES */
    uint8_t disturbance_delay; /* steps, 0..8: phi(t) has L(t - it) */
    uint8_t average;           /* steps of the data filter, 1..8; 1: none */
};

struct gmv_config {
    struct gmv_shape shape;
    float interval_s;
    /* Time constants of P and R, s; 0: none. R below 0: it is P, so that setpoint and PV weigh the same. */
    float tau_p_s[GMV_LOOPS], tau_r_s[GMV_LOOPS];
    float lambda[GMV_LOOPS]; /* PV span per MV span, with the sign of the loop's own g0; 0: none */
    float determinant;       /* less, and the loops are solved one by one, (0, 1) */
    float p0, p0_u;          /* diagonal of P(0), p0_u for the terms of the MVs */
    struct rls_settings rls; /* n, p0, lo and hi are filled in here */
    float theta[GMV_LOOPS][GMV_PARAMETERS]; /* start values */
    float lo[GMV_LOOPS][GMV_PARAMETERS],
        hi[GMV_LOOPS][GMV_PARAMETERS]; /* where hi > lo; else none */
};

struct gmv; /* in the caller's memory, aligned for everything; may be moved between calls */

/* What is measured in a step. */
struct gmv_sample {
    num_t y[GMV_LOOPS], w[GMV_LOOPS], disturbance[GMV_DISTURBANCES];
    const struct applied_history *applied[GMV_LOOPS];
    uint16_t divisor; /* base ticks of a step */
};

/* Number of parameters of loop i's regression; where its terms begin: first u_j (j: 0..1), first disturbance, first past prediction, bias.
 * -1: it has none of these. In the explicit way these are A's (as -a_1 ...), B's, ... in the same places. */
unsigned gmv_parameters(const struct gmv_shape *shape, unsigned i);
int gmv_place_of_u(const struct gmv_shape *shape, unsigned i, unsigned j);
int gmv_place_of_disturbance(const struct gmv_shape *shape, unsigned i);
int gmv_place_of_noise(const struct gmv_shape *shape, unsigned i);
int gmv_place_of_bias(const struct gmv_shape *shape, unsigned i);
/* How many steps a history of an MV must go back; how many steps of data a regression needs before it is whole. */
unsigned gmv_history(const struct gmv_shape *shape);
unsigned gmv_reach(const struct gmv_shape *shape);

uint32_t gmv_bytes(const struct gmv_shape *shape);
/* *field, *wanted: as the block's parameter is called, and what would be right; *loop: which. */
MUST_CHECK enum err gmv_check(const struct gmv_config *c, unsigned *loop, const char **field,
                              const char **wanted);
/* Settings that gmv_check accepts. Without a past. */
void gmv_init(struct gmv *g, const struct gmv_config *c);
/* New settings with the same gmv_bytes, loops and terms: data, estimates and parameters in use go on. */
void gmv_retune(struct gmv *g, const struct gmv_config *c);
/* The data begins anew (estimates stay): before the first step, and after a gap. */
void gmv_begin(struct gmv *g);

void gmv_take(struct gmv *g, const struct gmv_sample *s);
/* Bit i of `learn`: loop i's estimator may learn from this step. Returns which had whole data (their errors are of this step). */
uint8_t gmv_learn(struct gmv *g, const struct gmv_sample *s, uint8_t learn);

/* The law with the parameters in use. acting: a bit for each member that is free; of the others `fixed` is where their MVs
 * are and stay. u: of every member. */
struct gmv_range {
    num_t lo[GMV_LOOPS], hi[GMV_LOOPS], fixed[GMV_LOOPS];
};
enum gmv_solved {
    GMV_SOLVED,
    GMV_ONE_BY_ONE /* the determinant was too small */,
    GMV_NO_NUMBER /* u is unchanged */
};
enum gmv_solved gmv_solve(struct gmv *g, const struct gmv_sample *s, uint8_t acting,
                          const struct gmv_range *range, num_t *u);

/* Parameters in use: what gmv_solve takes; and those estimated. */
num_t gmv_used(const struct gmv *g, unsigned i, unsigned p);
void gmv_use(struct gmv *g, unsigned i, unsigned p, num_t value);
const struct rls *gmv_rls(const struct gmv *g, unsigned i);
struct rls *gmv_rls_of(struct gmv *g, unsigned i);
/* Of the last gmv_learn with whole data: what P y was, what the parameters in use and what the estimated ones had predicted (both of before
 * that step), and what "P y stays as it was a horizon ago" had. */
struct gmv_predicted {
    num_t measured, used, estimated, standstill;
};
struct gmv_predicted gmv_predicted(const struct gmv *g, unsigned i);
/* Of the last gmv_take: R w and P y. */
num_t gmv_setpoint(const struct gmv *g, unsigned i);
num_t gmv_auxiliary(const struct gmv *g, unsigned i);

#endif

/* Shape of a self-tuner: loops, delays, terms, and the places that these have in the regressions. docs/methods/self-tuning.md, Model. */
#ifndef REFLUX_GMV_GMV_SHAPE_H
#define REFLUX_GMV_GMV_SHAPE_H

#include <stdbool.h>
#include <stdint.h>

#define GMV_LOOPS        2
#define GMV_DISTURBANCES 2
/* Most terms na, nb. */
#define GMV_TERMS_MAX 5
/* Most past predictions nc. */
#define GMV_NOISE_MAX 2
/* Longest delay k_ij, steps. */
#define GMV_DELAY_MAX 8
/* Longest data filter, steps. */
#define GMV_AVERAGE_MAX 8
/* Most parameters of one loop. */
#define GMV_PARAMETERS 12

/* In the order of the words of the block's parameters. */
enum gmv_form { GMV_POSITIONAL, GMV_INCREMENTAL };
enum gmv_way { GMV_IMPLICIT, GMV_EXPLICIT };
enum gmv_weight { GMV_WEIGHT_DELTA, GMV_WEIGHT_SCALAR };
/* Stored as these numbers. The first three are of the positional form; GMV_BIAS_ERROR of the incremental one (Folami 1989, 8.18). */
enum gmv_bias { GMV_BIAS_ONE, GMV_BIAS_RESIDUALS, GMV_BIAS_NONE, GMV_BIAS_ERROR };

/* A change of one of these starts samples and estimates anew. */
struct gmv_shape {
    /* 1 or 2 */
    uint8_t loops;
    /* enum gmv_form, gmv_way, gmv_weight, gmv_bias */
    uint8_t form, way, weight, bias;
    /* Terms of y (1..5), of each u (1..5), of past predictions (0..2). */
    uint8_t na, nb, nc;
    /* k_ij, steps from MV j to PV i; 0: u_j is not in loop i's model. 1 <= k_ii <= k_ij <= GMV_DELAY_MAX */
    uint8_t delay[GMV_LOOPS][GMV_LOOPS];
    /* 0..GMV_DISTURBANCES */
    uint8_t disturbances;
    /* it, steps, 0..8: phi(t) has L(t - it). */
    uint8_t disturbance_delay;
    /* Steps of the data filter, 1..8; 1: none. */
    uint8_t average;
};

/* Number of parameters of loop i's regression. */
unsigned gmv_parameters(const struct gmv_shape *shape, unsigned i);
/* Number of its parameters that multiply PVs or MVs; they stand first. */
unsigned gmv_pv_and_mv_terms(const struct gmv_shape *shape, unsigned i);
/* Places in loop i's regression of the first term of u_j (j: 0..1), of the first disturbance, of the first past prediction, and of the
 * bias; -1: the regression has none. In the explicit way A's coefficients (as -a_1 ...), B's, ... have the same places. */
int gmv_place_of_u(const struct gmv_shape *shape, unsigned i, unsigned j);
int gmv_place_of_disturbance(const struct gmv_shape *shape, unsigned i);
int gmv_place_of_noise(const struct gmv_shape *shape, unsigned i);
int gmv_place_of_bias(const struct gmv_shape *shape, unsigned i);
/* Steps that a history of an MV must go back. */
unsigned gmv_history(const struct gmv_shape *shape);
/* Steps back to the oldest value of any signal that a regression or the law uses. */
unsigned gmv_reach(const struct gmv_shape *shape);
/* Horizon of loop i's regression, steps: its delay, or 1 in the explicit way. */
unsigned gmv_horizon(const struct gmv_shape *shape, unsigned i);
/* Steps from u_j's entry in phi(t) to its first one: k_ij - k_i; in the explicit way k_ij - 1. */
unsigned gmv_behind(const struct gmv_shape *shape, unsigned i, unsigned j);

#endif

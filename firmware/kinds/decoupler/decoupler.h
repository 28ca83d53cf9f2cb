/* Static decoupler: u = D v over the loops that are acting, and its back-calculation.
 *
 * D is given for all loops; only the rows and columns of the loops in automatic or cascade take part, so a
 * loop in manual neither moves nor is moved by the others. Fractions of output span throughout.
 * When loops come or go, all of v is D^-1 u. After a step only differences go back, applied - commanded, and only to the loops whose
 * MVs were limited: these loops follow their MVs while the requests of the others stand. With D^-1 of all
 * differences a loop at its limit would push the others a little in every tick, and they would settle off their
 * setpoints. Where nothing was limited the correction is exactly zero, whatever the rounding.
 */
#ifndef REFLUX_DECOUPLER_DECOUPLER_H
#define REFLUX_DECOUPLER_DECOUPLER_H

#include <stdint.h>

#include "block/block.h"

struct decoupler {
    /* Number of loops that take part. */
    uint8_t n;
    /* Their indices, ascending. */
    uint8_t member[DECOUPLER_MAX];
    num_t d[DECOUPLER_MAX][DECOUPLER_MAX];
    num_t inverse[DECOUPLER_MAX][DECOUPLER_MAX];
};

/* Selects the loops whose bit is set in mask. matrix: row i, column j for loops i, j, finite, magnitudes
 * up to 100. ERR_SINGULAR when that part of D has no inverse with entries below NUM_MAX_MAGNITUDE:
 * *decoupler is then unchanged. Gauss-Jordan with partial pivoting in float. */
MUST_CHECK enum err decoupler_select(struct decoupler *decoupler,
                                     const float matrix[DECOUPLER_MAX][DECOUPLER_MAX],
                                     uint8_t mask);

/* Settings are a struct matrix_settings. ERR_SINGULAR when any selection out of the members that are there would be, or its
 * v = D^-1 u may exceed NUM_MAX_MAGNITUDE while every |u_j| is at most the out_reach of member j; *worst is then that
 * selection. */
MUST_CHECK enum err decoupler_check(const struct block_setup *setup, uint8_t *worst);

/* v and u are indexed by loop; only members are read and written. Rows are summed wide: products may leave the range of
 * num_t as long as their sum does not; that saturates. */
void decoupler_forward(const struct decoupler *decoupler, const num_t *v, num_t *u);
/* dv = D^-1 du for the members. */
void decoupler_back(const struct decoupler *decoupler, const num_t *du, num_t *dv);
/* dv of the members whose du is not 0, such that D dv is du in their rows; 0 of the others. */
void decoupler_give_way(const struct decoupler *decoupler, const num_t *du, num_t *dv);

/* A compensator: settings are a struct matrix_settings; members are the first DECOUPLER_MAX loops. Between select and the
 * next, only the members selected take part. */
extern const struct block_kind decoupler_kind;

#endif

/* Static decouplers that take back less of the interaction than K^-1 does, from a square matrix of gains K (row and column k: output and
 * input of loop k). design/static_decoupler.h is the whole one.
 *
 * Each gives u = D v with a diagonal of 1: loop k moves its own input by what it asks for. What the loops then see is K D. */
#ifndef REFLUX_DESIGN_DECOUPLER_SHAPES_H
#define REFLUX_DESIGN_DECOUPLER_SHAPES_H

#include "design/double_symbols.h"
#include "num/svd.h"

#define DECOUPLER_SHAPE_LOOPS 8

struct decoupler_shape {
    struct matrix d;
    struct matrix seen;                 /* K D */
    real_t gain[DECOUPLER_SHAPE_LOOPS]; /* its diagonal */
    /* The largest element of row k off the diagonal over that on it, magnitudes. */
    real_t left[DECOUPLER_SHAPE_LOOPS];
};

struct decoupler_shape_work {
    struct pseudo_inverse_work pseudo;
    struct matrix inverse;
    struct svd svd;
};

/* ERR_RANGE: K is not square, has more than DECOUPLER_SHAPE_LOOPS rows, or another argument is out of its range; ERR_NOT_FINITE;
 * ERR_SINGULAR: what would have to be inverted has no inverse, or a diagonal element is 0. Units of inputs and outputs do not
 * matter, but to the third; there, gains are span per span. */

/* Partial: element k, l of the whole decoupler times factor[k][l], 0 (none of it) to 1 (all of it). Ours; what is lost by the errors of
 * an ill-conditioned K grows with the factors (Skogestad, Morari and Doyle, IEEE Trans. Automatic Control 33 (1988) 1092). */
MUST_CHECK enum err
decoupler_partial(const struct matrix *gains,
                  const real_t factor[DECOUPLER_SHAPE_LOOPS][DECOUPLER_SHAPE_LOOPS],
                  struct decoupler_shape_work *work, struct decoupler_shape *shape);

/* One-way: rank[0] is the loop that no other one disturbs, rank[1] is disturbed by that alone, and so on: K D is lower triangular in that
 * order, D upper with a diagonal of 1, so K = L D^-1 (of two loops an element of D is 0, the other -k12/k11). The loops keep
 * the stability of a triangular system whatever element is wrong on the side that stays. rank: each loop once. */
MUST_CHECK enum err decoupler_one_way(const struct matrix *gains, const uint8_t *rank,
                                      struct decoupler_shape_work *work,
                                      struct decoupler_shape *shape);

/* By directions: K = V Q W', D before its columns are divided is W Q^-1 V' (the law of Folami's appendix A3.2, with W and V in
 * the order that inverts K), but a direction that needs more than condition_hi (1 to 1e4) times what the strongest needs gets no more
 * than that. With an infinite bound D is the whole decoupler. *limited: directions that were. */
MUST_CHECK enum err decoupler_by_directions(const struct matrix *gains, real_t condition_hi,
                                            struct decoupler_shape_work *work,
                                            struct decoupler_shape *shape, uint8_t *limited);

#endif

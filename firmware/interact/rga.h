/* Relative gains and what follows from them: docs/methods/interaction.md.
 *
 * Accuracy: each relative gain within 16 REAL_EPSILON kappa (1 + |lambda|) of the exact one, kappa the condition number
 * of the equilibrated matrix. Where the sums that are 1 by definition miss it by more than 0.05, rounding has taken over
 * and the matrix is singular (ERR_SINGULAR). */
#ifndef REFLUX_INTERACT_RGA_H
#define REFLUX_INTERACT_RGA_H

#include "interact/plant.h"

struct rga_work {
    struct pseudo_inverse_work pseudo;
    struct matrix scaled, inverse;
};

/* Lambda = K .* (K+)': Bristol, IEEE Trans. Automatic Control 11 (1966) 133; non-square with the pseudo-inverse: Chang
 * and Yu, Chem. Eng. Sci. 45 (1990) 1309. Sums of every row and column are 1 where K is square; of a tall one the
 * columns', of a wide one the rows'. ERR_SINGULAR: rank not full, there are no relative gains. */
MUST_CHECK enum err rga_compute(const struct matrix *gains, struct rga_work *work,
                                struct matrix *lambda);

/* Dynamic RGA: G(i omega) .* (G(i omega)+)' (transposed, not conjugated). magnitude gets the moduli, real_part the real
 * parts; either may be NULL. pairs NULL: the whole plant. About 3e5 instructions for 16 x 16. */
struct rga_at_work {
    struct cmatrix response, inverse;
    struct matrix size;
    struct cpseudo_inverse_work pseudo;
};
MUST_CHECK enum err rga_at(const struct interact_plant *plant, const struct pairs *pairs,
                           real_t omega, struct rga_at_work *work, struct matrix *magnitude,
                           struct matrix *real_part);

/* Magnitude of the dynamic relative gain of pair k at omega, with the other pairs alone beside it: G_kk (G^-1)_kk of the paired rows and
 * columns. k is below pairs->n; omega 0 or more. ERR_SINGULAR: there is none. About 5e4 instructions for 16 pairs. */
struct rga_pair_work {
    struct cmatrix response;
    struct clu lu;
};
MUST_CHECK enum err rga_of_pair(const struct interact_plant *plant, const struct pairs *pairs,
                                uint8_t k, real_t omega, struct rga_pair_work *work,
                                real_t *magnitude);

/* Sum of |Lambda - P|, P the pairing's permutation: Skogestad and Postlethwaite, Multivariable Feedback Control, 2nd
 * ed. (2005), 3.4. 0 is no interaction. Rows and columns outside the pairs are left out. */
real_t rga_number(const struct matrix *lambda, const struct pairs *pairs);

/* Smallest relative error of a single gain that makes K singular: 1/max|lambda| (Yu and Luyben, Ind. Eng. Chem. Res. 26
 * (1987) 1043; Skogestad and Postlethwaite 3.4). *output and *input: of which gain. */
real_t rga_smallest_error(const struct matrix *lambda, uint8_t *output, uint8_t *input);

/* Certainty of the sign of det K: |det K| over its standard deviation, to first order. d ln|det K| is the sum of (K^-1)_ji dK_ij
 * over all gains, sd their standard deviations; the errors of row i have the covariance diag(sd_i^2) - common_i common_i'
 * (interact/direction.h), NULL: they are independent. Infinite where no gain has one. ERR_RANGE: not square, or another size;
 * ERR_SINGULAR. */
MUST_CHECK enum err rga_determinant_sds(const struct matrix *gains, const struct matrix *sd,
                                        const struct matrix *common, struct rga_work *work,
                                        real_t *sds);

/* NI = det K / product of K[output k][input k]: Niederlinski, Automatica 7 (1971) 691. Below 0 the loops with integral
 * action are unstable together, however slow (Grosdidier, Morari and Holt 1985, for proper open loops). May overflow to
 * infinity; its sign is right. ERR_SINGULAR: det or a paired gain is 0. */
MUST_CHECK enum err niederlinski_index(const struct matrix *gains, const struct pairs *pairs,
                                       struct rga_work *work, real_t *index);

#endif

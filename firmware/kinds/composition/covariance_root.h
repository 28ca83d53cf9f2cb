/* Parts of a step of kinds/composition/covariance_ud.c on the square root S = U D^(1/2), in this order: every extra, every stage from the reboiler up,
 * every stage from the condenser down. Between the parts the triangle holds columns of S and of U D side by side. */
#ifndef REFLUX_COMPOSITION_COVARIANCE_ROOT_H
#define REFLUX_COMPOSITION_COVARIANCE_ROOT_H

#include "kinds/composition/covariance.h"

struct covariance_root;

/* Takes the triangle ud and memory own, left of its own, [n][m] each. */
void covariance_root_begin(struct covariance_root *c, size_t stages, size_t m, real_t *ud,
                           real_t *own, real_t *left);
/* Begins a step. */
void covariance_root_start(struct covariance_root *c);
/* ERR_NOT_FINITE: the last step made something that is no number. */
enum err covariance_root_err(const struct covariance_root *c);

/* The column of extra k: what the extras push, Phi, keep, and back to one on the diagonal. */
void covariance_root_extra(struct covariance_root *c, const struct covariance_step *step, size_t k);
/* Columns of stage s through both sweeps; the vapour of the stage is turned into them. */
void covariance_root_up(struct covariance_root *c, const struct column_transition *t, size_t s);
/* Row block s becomes upper triangular, and its columns those of U and D. */
void covariance_root_back(struct covariance_root *c, size_t s);

#endif

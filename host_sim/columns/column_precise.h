/* Derivatives of a column with its channels, from the model in long double (reflux_model_long).
 *
 * There the bubble points leave 1e-20 of the pressure, so differences at 1e-5 of a mole fraction are right to ten digits, also
 * along a component of which there is next to nothing: the equations hold for mole fractions a little below 0 too. Where long
 * double is as wide as double the same steps leave some 1e-8 of the largest entry of a row; differences at larger distances that
 * derivative.h compares with them then do better than those. */
#ifndef REFLUX_HOST_SIM_COLUMN_PRECISE_H
#define REFLUX_HOST_SIM_COLUMN_PRECISE_H

#include <stdbool.h>
#include <stddef.h>

struct column_precise; /* opaque */
struct column_terms;   /* column_terms.h */

/* number: of column_carry_out. terms must outlive it. NULL when there is no memory. */
struct column_precise *column_precise_create(const double *number, const struct column_terms *terms,
                                             char *err, size_t err_size);
void column_precise_destroy(struct column_precise *p);

/* The point: states and values of the input channels, copied. */
bool column_precise_set(struct column_precise *p, const double *x, const double *u, char *err,
                        size_t err_size);

/* At a distance from the point along state or input number `along`: rates of all states, then values of all channels that
 * are no inputs; of logarithms of a fraction those of the fraction. */
bool column_precise_at(struct column_precise *p, bool of_input, size_t along, long double distance,
                       long double *rates_and_values, char *err, size_t err_size);

/* Factor for the slopes of channel k's value above: 1, or those of the logarithm. */
double column_precise_scale(const struct column_precise *p, size_t k);

#endif

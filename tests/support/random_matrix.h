/* Random matrices whose elements are exact in float: the same ones as matrix() and costs() of
 * tests/reference/interact_reference.py make from the same seed. */
#ifndef REFLUX_TESTS_RANDOM_MATRIX_H
#define REFLUX_TESTS_RANDOM_MATRIX_H

#include "num/matrix.h"
#include "random_source.h"

#define RANDOM_KINDS 4

/* -1 to 1 in steps of 2^-23 */
static inline double random_fraction(struct random_source *r)
{
    return (double)(random_next(r) >> 40) / 8388608.0 - 1.0;
}

/* Kinds: 0 uniform, 1 columns from 1 down to 2^-15, 2 rank deficient, 3 rows from 1 up to 2^15. */
static inline unsigned random_matrix(uint64_t seed, struct matrix *a)
{
    struct random_source r = {seed};
    a->rows = (uint8_t)(1 + random_below(&r, MATRIX_MAX));
    a->cols = (uint8_t)(1 + random_below(&r, MATRIX_MAX));
    unsigned kind = random_below(&r, RANDOM_KINDS);
    if (kind == 2) {
        double b[MATRIX_MAX][MATRIX_MAX], c[MATRIX_MAX][MATRIX_MAX];
        unsigned least = a->rows < a->cols ? a->rows : a->cols;
        unsigned rank = random_below(&r, least + 1);
        for (unsigned i = 0; i < a->rows; i++)
            for (unsigned k = 0; k < rank; k++)
                b[i][k] = (double)random_below(&r, 9) - 4.0;
        for (unsigned k = 0; k < rank; k++)
            for (unsigned j = 0; j < a->cols; j++)
                c[k][j] = (double)random_below(&r, 9) - 4.0;
        for (unsigned i = 0; i < a->rows; i++)
            for (unsigned j = 0; j < a->cols; j++) {
                double sum = 0.0;
                for (unsigned k = 0; k < rank; k++)
                    sum += b[i][k] * c[k][j];
                a->value[i][j] = (real_t)sum;
            }
        return kind;
    }
    double column = 1.0, row = 1.0;
    for (unsigned i = 0; i < a->rows; i++, row *= 2.0) {
        column = 1.0;
        for (unsigned j = 0; j < a->cols; j++, column *= 0.5) {
            double x = random_fraction(&r);
            a->value[i][j] = (real_t)(kind == 1 ? x * column : (kind == 3 ? x * row : x));
        }
    }
    return kind;
}

#endif

/* Complex numbers and dense complex matrices up to 16 x 16. The rules of num/matrix.h apply. A matrix is 2 KiB (float), and
 * no function takes more than 3e5 instructions. */
#ifndef REFLUX_NUM_CMATRIX_H
#define REFLUX_NUM_CMATRIX_H

#include "num/matrix.h"
#include "num/real_trig.h"

struct cplx {
    real_t re, im;
};

struct cmatrix {
    uint8_t rows, cols; /* 1 to MATRIX_MAX */
    struct cplx value[MATRIX_MAX][MATRIX_MAX];
};

struct clu {
    uint8_t n;
    int16_t sign;
    uint8_t row[MATRIX_MAX];
    struct cplx value[MATRIX_MAX][MATRIX_MAX];
};

static inline struct cplx cplx(real_t re, real_t im)
{
    return (struct cplx){re, im};
}
static inline struct cplx cplx_add(struct cplx a, struct cplx b)
{
    return (struct cplx){a.re + b.re, a.im + b.im};
}
static inline struct cplx cplx_sub(struct cplx a, struct cplx b)
{
    return (struct cplx){a.re - b.re, a.im - b.im};
}
static inline struct cplx cplx_mul(struct cplx a, struct cplx b)
{
    return (struct cplx){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
static inline struct cplx cplx_scale(struct cplx a, real_t k)
{
    return (struct cplx){a.re * k, a.im * k};
}
/* e^(i angle), rad */
static inline struct cplx cplx_turned(real_t angle)
{
    struct cplx z;
    real_sincos(angle, &z.im, &z.re);
    return z;
}
static inline struct cplx cplx_conj(struct cplx a)
{
    return (struct cplx){a.re, -a.im};
}
static inline real_t cplx_square(struct cplx a)
{
    return a.re * a.re + a.im * a.im;
}
/* Returns |a|, for magnitudes between 1e-18 and 1e18 (float). */
static inline real_t cplx_abs(struct cplx a)
{
    return real_sqrt(cplx_square(a));
}
/* Returns a/b, b not 0, for magnitudes as above. */
static inline struct cplx cplx_div(struct cplx a, struct cplx b)
{
    return cplx_scale(cplx_mul(a, cplx_conj(b)), REAL_C(1.0) / cplx_square(b));
}

MUST_CHECK enum err cmatrix_check(const struct cmatrix *a);

/* Factors a as lu_factor() does. Errors as there. */
MUST_CHECK enum err clu_factor(const struct cmatrix *a, struct clu *lu);
/* The same for the matrix of n rows that is in lu->value already. */
MUST_CHECK enum err clu_factor_own(struct clu *lu, uint8_t n);
/* Diagonal of the inverse, in half of the time of all solutions. */
void clu_inverse_diagonal(const struct clu *lu, struct cplx *diagonal);
void clu_solve(const struct clu *lu, const struct cplx *b, struct cplx *x);
/* det A = *direction exp(*log_magnitude), |*direction| = 1. */
void clu_determinant(const struct clu *lu, struct cplx *direction, real_t *log_magnitude);

/* Replaces the n x n matrix in a by its inverse, by Gauss-Jordan elimination with pivots by rows. ERR_SINGULAR: a pivot is at
 * most n REAL_EPSILON of the largest element. ERR_RANGE: n. On an error a is destroyed. */
MUST_CHECK enum err cmatrix_invert_own(struct cplx a[MATRIX_MAX][MATRIX_MAX], uint8_t n);

/* Pseudo-inverse: (A^H A)^-1 A^H of a tall or square matrix of full column rank, A^H (A A^H)^-1 of a wide one, by Gram-Schmidt
 * with reorthogonalisation. ERR_SINGULAR: the rank is not full to working precision. */
struct cpseudo_inverse_work {
    struct cmatrix q, r;
};
MUST_CHECK enum err cmatrix_pseudo_inverse(const struct cmatrix *a,
                                           struct cpseudo_inverse_work *work,
                                           struct cmatrix *inverse);

#endif

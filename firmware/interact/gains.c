#include "interact/gains.h"

#include <stddef.h>

#include "interact/direction.h"

#define FLOOR_MAX REAL_C(0.5)
#define QUANTILE  REAL_C(1.6449) /* of the normal law, 95 % */

enum { STAGE_SPANS, STAGE_EQUILIBRATED, STAGE_WEIGHTED, STAGE_DONE };

static size_t smaller_side(const struct gains *g)
{
    return g->k.rows < g->k.cols ? g->k.rows : g->k.cols;
}

/* Begins the decomposition of diag(row_scale) K diag(col_scale). */
static enum err decompose_scaled(struct gains *g)
{
    struct matrix *product = &g->scaled;
    product->rows = g->k.rows;
    product->cols = g->k.cols;
    for (size_t i = 0; i < g->k.rows; i++)
        for (size_t j = 0; j < g->k.cols; j++)
            product->value[i][j] = g->k.value[i][j] * g->row_scale[i] * g->col_scale[j];
    return svd_begin(&g->svd, product);
}

enum err gains_begin(struct gains *g, const struct interact_plant *plant, real_t floor)
{
    enum err err = interact_check(plant, NULL);
    if (err)
        return err;
    if (!real_is_finite(floor))
        return ERR_NOT_FINITE;
    if (floor < REAL_C(0.0) || floor > FLOOR_MAX)
        return ERR_RANGE;
    interact_gains(plant, NULL, &g->k);
    g->plant = plant;
    g->floor = floor;
    g->sd.rows = g->k.rows;
    g->sd.cols = g->k.cols;
    for (size_t i = 0; i < g->k.rows; i++)
        for (size_t j = 0; j < g->k.cols; j++)
            g->sd.value[i][j] = direction_sd(plant, i, j, floor);
    g->rank = g->rank_exact = 0;
    g->condition = g->condition_scaled = g->smallest_in_sd = REAL_C(0.0);
    g->stage = STAGE_SPANS;
    return svd_begin(&g->svd, &g->k);
}

/* Wilson and Hilferty's approximation to the 95 % point of chi-square. */
static real_t chi_square_point(real_t freedom)
{
    real_t a = REAL_C(2.0) / (REAL_C(9.0) * freedom);
    real_t b = REAL_C(1.0) - a + QUANTILE * real_sqrt(a);
    return freedom * b * b * b;
}

/* Variances of the elements of U' E V, E the errors of the scaled gains: into g->scaled. */
static void rotate_variances(struct gains *g)
{
    size_t p = g->k.rows, m = g->k.cols;
    for (size_t k = 0; k < p; k++) {
        real_t row[INTERACT_MAX];
        for (size_t j = 0; j < m; j++) {
            real_t sum = REAL_C(0.0);
            for (size_t i = 0; i < p; i++) {
                real_t part =
                    g->svd.u.value[i][k] * g->sd.value[i][j] * g->row_scale[i] * g->col_scale[j];
                sum += part * part;
            }
            row[j] = sum;
        }
        for (size_t l = 0; l < m; l++) {
            real_t sum = REAL_C(0.0);
            for (size_t j = 0; j < m; j++)
                sum += row[j] * g->svd.v.value[j][l] * g->svd.v.value[j][l];
            g->scaled.value[k][l] = sum;
        }
    }
}

/* Takes off them what is known along a direction: the covariance of row i is diag(sd_i^2) - q_i q_i'. */
static void know_direction(struct gains *g)
{
    size_t p = g->k.rows, m = g->k.cols;
    for (size_t i = 0; i < p; i++) {
        real_t q[INTERACT_MAX];
        if (!direction_common(g->plant, i, g->floor, q))
            continue;
        for (size_t l = 0; l < m; l++) {
            real_t along = REAL_C(0.0);
            for (size_t j = 0; j < m; j++)
                along += q[j] * g->row_scale[i] * g->col_scale[j] * g->svd.v.value[j][l];
            for (size_t k = 0; k < p; k++) {
                real_t part = g->svd.u.value[i][k] * along;
                real_t left = g->scaled.value[k][l] - part * part;
                g->scaled.value[k][l] = left > REAL_C(0.0) ? left : REAL_C(0.0);
            }
        }
    }
}

/* The least r for which what is left past r is no more than errors would leave: weighted chi-square, its degrees of
 * freedom after Satterthwaite (1946). */
static void rank_in_noise(struct gains *g)
{
    size_t n = smaller_side(g);
    rotate_variances(g);
    know_direction(g);
    real_t variance = g->scaled.value[n - 1][n - 1];
    if (variance > REAL_C(0.0))
        g->smallest_in_sd = g->svd.s[n - 1] / real_sqrt(variance);
    size_t rank = 0;
    for (; rank < n; rank++) {
        real_t energy = REAL_C(0.0), sum = REAL_C(0.0), squares = REAL_C(0.0);
        for (size_t k = rank; k < n; k++)
            energy += g->svd.s[k] * g->svd.s[k];
        for (size_t k = rank; k < g->k.rows; k++)
            for (size_t l = rank; l < g->k.cols; l++) {
                sum += g->scaled.value[k][l];
                squares += g->scaled.value[k][l] * g->scaled.value[k][l];
            }
        if (energy <= REAL_C(0.0))
            break;
        if (squares > REAL_C(0.0) &&
            energy <= squares / sum * chi_square_point(sum * sum / squares))
            break;
    }
    g->rank = (uint8_t)(rank < g->rank_exact ? rank : g->rank_exact);
}

static bool errors_known(const struct gains *g)
{
    for (size_t i = 0; i < g->sd.rows; i++)
        for (size_t j = 0; j < g->sd.cols; j++)
            if (g->sd.value[i][j] > REAL_C(0.0))
                return true;
    return false;
}

/* Scales that give the errors about equal size: one over the geometric middle of each row's and column's. */
static void weight_by_errors(struct gains *g)
{
    matrix_equilibrate(&g->sd, true, g->row_scale, g->col_scale);
}

enum err gains_step(struct gains *g)
{
    if (g->stage == STAGE_DONE)
        return ERR_STATE;
    enum err err = svd_step(&g->svd);
    if (err)
        return err;
    size_t n = smaller_side(g);
    switch (g->stage) {
    case STAGE_SPANS:
        for (size_t k = 0; k < n; k++)
            g->singular[k] = g->svd.s[k];
        for (size_t j = 0; j < g->k.cols; j++)
            g->weakest[j] = g->svd.v.value[j][n - 1u];
        g->condition = svd_condition(&g->svd);
        matrix_equilibrate(&g->k, true, g->row_scale, g->col_scale);
        g->stage = STAGE_EQUILIBRATED;
        err = decompose_scaled(g);
        return err ? err : ERR_BUSY;
    case STAGE_EQUILIBRATED:
        g->condition_scaled = svd_condition(&g->svd);
        g->rank = g->rank_exact = (uint8_t)svd_rank(&g->svd, REAL_C(0.0));
        if (!errors_known(g))
            break;
        weight_by_errors(g);
        g->stage = STAGE_WEIGHTED;
        err = decompose_scaled(g);
        return err ? err : ERR_BUSY;
    default:
        rank_in_noise(g);
        break;
    }
    g->stage = STAGE_DONE;
    return ERR_OK;
}

static void normalise(real_t *x, size_t n)
{
    real_t most = REAL_C(0.0), sum = REAL_C(0.0);
    for (size_t k = 0; k < n; k++)
        if (real_abs(x[k]) > most)
            most = real_abs(x[k]);
    for (size_t k = 0; k < n; k++) {
        x[k] = x[k] / most;
        sum += x[k] * x[k];
    }
    for (size_t k = 0; k < n; k++)
        x[k] = x[k] / real_sqrt(sum);
}

enum err gains_null_input(const struct gains *g, unsigned k, real_t *x)
{
    if (g->stage != STAGE_DONE)
        return ERR_STATE;
    if (k >= (unsigned)g->k.cols - g->rank)
        return ERR_RANGE;
    for (size_t j = 0; j < g->k.cols; j++)
        x[j] = g->svd.v.value[j][g->rank + k] * g->col_scale[j];
    normalise(x, g->k.cols);
    return ERR_OK;
}

enum err gains_null_output(const struct gains *g, unsigned k, real_t *y)
{
    if (g->stage != STAGE_DONE)
        return ERR_STATE;
    if (k >= (unsigned)g->k.rows - g->rank)
        return ERR_RANGE;
    for (size_t i = 0; i < g->k.rows; i++)
        y[i] = g->svd.u.value[i][g->rank + k] * g->row_scale[i];
    normalise(y, g->k.rows);
    return ERR_OK;
}

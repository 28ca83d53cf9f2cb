#include "interact/ina_search.h"

#include <math.h>
#include <stddef.h>

#include "base/assertion.h"
#include "lti/fopdt.h"

#define ELEMENT_MOST  REAL_C(1e15)
#define FIRST_STEP    REAL_C(0.5)
#define LONGEST_STEP  REAL_C(1.0)
#define SHORTEST_STEP REAL_C(1e-6)
#define IDLE_ROUNDS   3 /* frames that must not help before the step is halved */
#define ROUNDS_MOST   600
#define POWER_ROUNDS  60
#define STARTS        8
#define LAMBDA        REAL_C(100.0)
#define LAMBDA_MOST   REAL_C(1e6)

enum { AT_START, AT_ROUNDS };

void ina_search_config_default(struct ina_search_config *config)
{
    *config = (struct ina_search_config){
        .by = INA_BY_ROWS, .starts = STARTS, .lambda_hi = LAMBDA, .seed = 1};
}

/* Rows of K in x; row i of K F^-1 at a point. */
static struct cplx array_element(const struct ina_search *s, const real_t *k, size_t point,
                                 size_t j)
{
    const struct cplx *f = s->inverse + point * s->n * s->n + j;
    struct cplx sum = cplx(REAL_C(0.0), REAL_C(0.0));
    for (size_t a = 0; a < s->n; a++)
        sum = cplx_add(sum, cplx_scale(f[a * s->n], k[a]));
    return sum;
}

static real_t ratio_of(real_t off, real_t own)
{
    return own > REAL_C(0.0) ? off / own : INFINITY;
}

static real_t ratio_of_row(const struct ina_search *s, const real_t *k, size_t point)
{
    real_t off = REAL_C(0.0), own = REAL_C(0.0);
    for (size_t j = 0; j < s->n; j++) {
        real_t size = cplx_abs(array_element(s, k, point, j));
        if (j == s->row)
            own = size;
        else
            off += size;
    }
    return ratio_of(off, own);
}

static real_t ratio_of_columns(const struct ina_search *s, const real_t *k, size_t point)
{
    real_t worst = REAL_C(0.0);
    for (size_t j = 0; j < s->n; j++) {
        real_t off = REAL_C(0.0), own = REAL_C(0.0);
        for (size_t i = 0; i < s->n; i++) {
            real_t size = cplx_abs(array_element(s, k + i * s->n, point, j));
            if (j == i)
                own = size;
            else
                off += size;
        }
        real_t ratio = ratio_of(off, own);
        worst = ratio > worst ? ratio : worst;
    }
    return worst;
}

/* Largest ratio over the frequencies, or the first that is not below limit. The frequency that ruled out the last one comes first:
 * mostly it rules out this one too. */
static real_t worst_ratio(struct ina_search *s, const real_t *k, real_t limit)
{
    real_t worst = REAL_C(0.0);
    s->looks++;
    for (size_t visit = 0; visit <= s->points; visit++) {
        size_t point = visit > 0 ? visit - 1 : s->hardest;
        real_t ratio =
            s->config.by == INA_BY_ROWS ? ratio_of_row(s, k, point) : ratio_of_columns(s, k, point);
        if (ratio > worst) {
            worst = ratio;
            s->hardest = (uint16_t)point;
        }
        if (!(ratio < limit))
            return ratio;
    }
    return worst;
}

/* Largest relative gain of K, and so of its inverse, which is left in b; infinite where there is none. */
static real_t largest_lambda(struct ina_search *s, const real_t *k)
{
    s->a.rows = s->a.cols = s->n;
    for (size_t m = 0; m < (size_t)s->n * s->n; m++)
        s->a.value[m / s->n][m % s->n] = k[m];
    if (lu_factor(&s->a, &s->lu))
        return INFINITY;
    lu_inverse(&s->lu, &s->b);
    real_t largest = REAL_C(0.0);
    for (size_t i = 0; i < s->n; i++)
        for (size_t j = 0; j < s->n; j++) {
            real_t lambda = real_abs(s->a.value[i][j] * s->b.value[j][i]);
            largest = lambda > largest ? lambda : largest;
        }
    return largest;
}

/* As worst_ratio; by columns infinite where K is too near to singular. By rows each row is found for itself. */
static real_t judged_ratio(struct ina_search *s, const real_t *k, real_t limit)
{
    real_t ratio = worst_ratio(s, k, limit);
    if (s->config.by == INA_BY_COLUMNS && ratio < limit &&
        !(largest_lambda(s, k) <= s->config.lambda_hi))
        return INFINITY;
    return ratio;
}

/* By rows, the row at hand; by columns all of K. */
static const real_t *given_row(const struct ina_search *s, size_t at)
{
    return s->k.value[s->config.by == INA_BY_ROWS ? s->row : at / s->n] + at % s->n;
}

static void scale_to_1(const struct ina_search *s, real_t *x)
{
    real_t largest = REAL_C(0.0);
    for (size_t m = 0; m < s->numbers; m++)
        largest = real_abs(x[m]) > largest ? real_abs(x[m]) : largest;
    for (size_t m = 0; m < s->numbers && largest > REAL_C(0.0); m++)
        x[m] /= largest;
}

/* Sums a row: a the squares off the diagonal and b those on it, every frequency with the same weight whatever its gain. */
static void sum_squares(struct ina_search *s, size_t row)
{
    size_t n = s->n;
    s->a.rows = s->a.cols = s->b.rows = s->b.cols = s->n;
    for (size_t k = 0; k < n; k++)
        for (size_t l = 0; l < n; l++)
            s->a.value[k][l] = s->b.value[k][l] = REAL_C(0.0);
    for (size_t point = 0; point < s->points; point++) {
        const struct cplx *f = s->inverse + point * n * n;
        real_t all = REAL_C(0.0);
        for (size_t m = 0; m < n * n; m++)
            all += cplx_square(f[m]);
        for (size_t k = 0; k < n; k++)
            for (size_t l = 0; l < n; l++)
                for (size_t j = 0; j < n; j++) {
                    struct cplx p = f[k * n + j], q = f[l * n + j];
                    real_t part = (p.re * q.re + p.im * q.im) / all;
                    if (j == row)
                        s->b.value[k][l] += part;
                    else
                        s->a.value[k][l] += part;
                }
    }
}

/* x: the row whose squares on the diagonal are largest for those off it, the vector of the largest eigenvalue of a^-1 b, with
 * x' b x = 1. */
static bool pseudo_diagonal(struct ina_search *s, size_t row, real_t *x)
{
    size_t n = s->n;
    sum_squares(s, row);
    if (lu_factor(&s->a, &s->lu))
        return false;
    for (size_t k = 0; k < n; k++)
        x[k] = s->k.value[row][k];
    for (unsigned round = 0; round < POWER_ROUNDS; round++) {
        real_t image[INA_MOST], square = REAL_C(0.0);
        for (size_t k = 0; k < n; k++) {
            image[k] = REAL_C(0.0);
            for (size_t l = 0; l < n; l++)
                image[k] += s->b.value[k][l] * x[l];
            square += image[k] * x[k];
        }
        if (!(square > REAL_C(0.0)))
            return false;
        real_t size = real_sqrt(square);
        if (round + 1 == POWER_ROUNDS) {
            for (size_t k = 0; k < n; k++)
                x[k] /= size;
            break;
        }
        lu_solve(&s->lu, image, x);
        for (size_t k = 0; k < n; k++)
            x[k] /= size;
        real_t largest = REAL_C(0.0);
        for (size_t k = 0; k < n; k++)
            largest = real_abs(x[k]) > largest ? real_abs(x[k]) : largest;
        if (!(largest > REAL_C(0.0)) || !real_is_finite(largest))
            return false;
        for (size_t k = 0; k < n; k++)
            x[k] /= largest;
    }
    return true;
}

static bool pseudo_diagonal_start(struct ina_search *s)
{
    if (s->config.by == INA_BY_ROWS)
        return pseudo_diagonal(s, s->row, s->x);
    for (size_t row = 0; row < s->n; row++)
        if (!pseudo_diagonal(s, row, s->x + row * s->n))
            return false;
    return true;
}

static void begin_start(struct ina_search *s)
{
    bool known = s->start == 1 && pseudo_diagonal_start(s);
    for (size_t m = 0; m < s->numbers && !known; m++)
        s->x[m] = s->start == 0 ? *given_row(s, m) : random_normal(&s->random);
    scale_to_1(s, s->x);
    s->found = judged_ratio(s, s->x, INFINITY);
    s->step = FIRST_STEP;
    s->idle = 0;
    s->rounds = 0;
    s->stage = AT_ROUNDS;
}

/* Reflection 1 - 2 v v', v a random unit vector: its columns are a frame, and it needs no room. */
static void turn_frame(struct ina_search *s)
{
    real_t square = REAL_C(0.0);
    for (size_t m = 0; m < s->numbers; m++) {
        s->turn[m] = random_normal(&s->random);
        square += s->turn[m] * s->turn[m];
    }
    real_t size = real_sqrt(square);
    for (size_t m = 0; m < s->numbers && size > REAL_C(0.0); m++)
        s->turn[m] /= size;
}

static bool try_axis(struct ina_search *s, size_t axis, real_t step)
{
    REFLUX_ASSERT(axis < s->numbers);
    for (size_t m = 0; m < s->numbers; m++) {
        real_t one = m == axis ? REAL_C(1.0) : REAL_C(0.0);
        s->trial[m] = s->x[m] + step * (one - REAL_C(2.0) * s->turn[axis] * s->turn[m]);
    }
    real_t found = judged_ratio(s, s->trial, s->found);
    if (!(found < s->found))
        return false;
    scale_to_1(s, s->trial);
    for (size_t m = 0; m < s->numbers; m++)
        s->x[m] = s->trial[m];
    s->found = found;
    return true;
}

/* True: this start has come to its end. */
static bool one_round(struct ina_search *s)
{
    bool moved = false;
    turn_frame(s);
    for (size_t axis = 0; axis < s->numbers; axis++)
        if (try_axis(s, axis, s->step) || try_axis(s, axis, -s->step))
            moved = true;
    if (moved) {
        s->idle = 0;
        s->step = s->step + s->step < LONGEST_STEP ? s->step + s->step : LONGEST_STEP;
    } else if (++s->idle >= IDLE_ROUNDS) {
        s->idle = 0;
        s->step *= REAL_C(0.5);
    }
    return s->step < SHORTEST_STEP || ++s->rounds >= ROUNDS_MOST;
}

/* The best of the starts becomes part of a. */
static void keep_best(struct ina_search *s)
{
    if (s->start == 0 || s->found < s->size) {
        s->size = s->found;
        for (size_t m = 0; m < s->numbers; m++)
            s->best[m] = s->x[m];
    }
}

static void store_rows(struct ina_search *s)
{
    bool rows = s->config.by == INA_BY_ROWS;
    for (size_t m = 0; m < s->numbers; m++)
        s->g.value[rows ? s->row : m / s->n][m % s->n] = s->best[m];
    for (size_t i = 0; i < s->n; i++)
        if (!rows || i == s->row)
            s->ratio[i] = s->size;
    if (s->row == 0 || s->size > s->after)
        s->after = s->size;
}

/* g holds G^-1 until now. */
static enum err finish_search(struct ina_search *s)
{
    real_t k[INA_MOST * INA_MOST];
    for (size_t m = 0; m < (size_t)s->n * s->n; m++)
        k[m] = s->g.value[m / s->n][m % s->n];
    s->lambda = largest_lambda(s, k);
    /* By columns every K that was taken is within the bound, but for the rounding of this one. */
    real_t most = s->config.by == INA_BY_ROWS ? s->config.lambda_hi : ELEMENT_MOST;
    if (!(s->lambda <= most) || !(s->size < INFINITY))
        return ERR_SINGULAR;
    lu_inverse(&s->lu, &s->g);
    if (s->config.by == INA_BY_ROWS) {
        (void)ina_normalise(&s->g);
        return ERR_OK;
    }
    real_t largest = REAL_C(0.0);
    for (size_t i = 0; i < s->n; i++)
        for (size_t j = 0; j < s->n; j++)
            largest = real_abs(s->g.value[i][j]) > largest ? real_abs(s->g.value[i][j]) : largest;
    for (size_t j = 0; j < s->n; j++) {
        real_t by = s->g.value[j][j] < REAL_C(0.0) ? -largest : largest;
        for (size_t i = 0; i < s->n; i++)
            s->g.value[i][j] /= by;
    }
    return ERR_OK;
}

enum err ina_search_begin(struct ina_search *s, const struct cplx *inverse, uint16_t points,
                          const struct matrix *g, const struct ina_search_config *config)
{
    if (points < 1 || points > INA_POINTS_MOST || config->starts < 1 ||
        config->starts > INA_STARTS_MOST ||
        !real_within(config->lambda_hi, REAL_C(1.0), LAMBDA_MOST) || g->rows != g->cols ||
        g->rows < 1 || g->rows > INA_MOST ||
        (config->by != INA_BY_ROWS && config->by != INA_BY_COLUMNS))
        return ERR_RANGE;
    size_t n = g->rows, elements = (size_t)points * n * n;
    for (size_t m = 0; m < elements; m++)
        if (!(real_abs(inverse[m].re) <= ELEMENT_MOST && real_abs(inverse[m].im) <= ELEMENT_MOST))
            return ERR_NOT_FINITE;
    enum err err = lu_factor(g, &s->lu);
    if (err)
        return err;
    lu_inverse(&s->lu, &s->k);
    s->k.rows = s->k.cols = s->g.rows = s->g.cols = g->rows;
    s->inverse = inverse;
    s->config = *config;
    s->random = random_from(config->seed);
    s->points = points;
    s->n = g->rows;
    s->numbers = (uint8_t)(config->by == INA_BY_ROWS ? n : n * n);
    s->hardest = 0;
    s->looks = 0;
    s->row = s->start = 0;
    s->stage = AT_START;
    s->before = s->after = REAL_C(0.0);
    return ERR_OK;
}

enum err ina_search_step(struct ina_search *s)
{
    REFLUX_ASSERT(s->n >= 1 && s->n <= INA_MOST && s->row < s->n && s->hardest < s->points);
    if (s->stage == AT_START) {
        begin_start(s);
        if (s->start == 0 && s->found > s->before)
            s->before = s->found;
        return ERR_BUSY;
    }
    if (!one_round(s))
        return ERR_BUSY;
    keep_best(s);
    s->stage = AT_START;
    if (++s->start < s->config.starts)
        return ERR_BUSY;
    store_rows(s);
    s->start = 0;
    s->row++;
    if (s->config.by == INA_BY_ROWS && s->row < s->n)
        return ERR_BUSY;
    return finish_search(s);
}

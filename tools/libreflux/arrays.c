#include "arrays.h"

#include <stdlib.h>
#include <string.h>

#include "interact/difference_response.h"
#include "interact/ina.h"
#include "interact/ina_search.h"
#include "interact/plant.h"
#include "num/ceigen.h"
#include "sampled.h"

static void give_response(const struct cmatrix *from, double *to)
{
    for (size_t i = 0; i < from->rows; i++)
        for (size_t j = 0; j < from->cols; j++) {
            to[2 * (i * from->cols + j)] = from->value[i][j].re;
            to[2 * (i * from->cols + j) + 1] = from->value[i][j].im;
        }
}

static void take_response(size_t n, const double *from, struct cmatrix *to)
{
    to->rows = to->cols = (uint8_t)n;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            to->value[i][j] = cplx(from[2 * (i * n + j)], from[2 * (i * n + j) + 1]);
}

static enum err take_compensator(int32_t n, const double *from, struct matrix *to)
{
    if (n < 1 || n > INA_MOST)
        return ERR_RANGE;
    to->rows = to->cols = (uint8_t)n;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            to->value[i][j] = from[i * n + j];
    return matrix_check(to);
}

static void give_compensator(const struct matrix *from, double *to)
{
    for (size_t i = 0; i < from->rows; i++)
        for (size_t j = 0; j < from->cols; j++)
            to[i * from->cols + j] = from->value[i][j];
}

int32_t reflux_response(const struct reflux_plant *plant, int32_t points, const double *omega,
                        double *response)
{
    struct interact_plant p;
    memset(&p, 0, sizeof p);
    if (plant->outputs < 1 || plant->outputs > INTERACT_MAX || plant->inputs < 1 ||
        plant->inputs > INTERACT_MAX)
        return ERR_RANGE;
    p.outputs = (uint8_t)plant->outputs;
    p.inputs = (uint8_t)plant->inputs;
    size_t elements = (size_t)p.outputs * p.inputs;
    for (size_t k = 0; k < elements; k++)
        p.element[k / p.inputs][k % p.inputs] =
            (struct fopdt){plant->gain[k], plant->dead_time_s[k], plant->time_constant_s[k]};
    enum err err = interact_check(&p, NULL);
    for (int32_t k = 0; k < points && !err; k++) {
        struct cmatrix at;
        if (!(omega[k] >= 0.0 && omega[k] <= 1e9))
            return ERR_RANGE;
        interact_response(&p, NULL, omega[k], &at);
        give_response(&at, response + 2 * elements * (size_t)k);
    }
    return err;
}

enum err take_sampled(const struct reflux_sampled *from, struct difference_model *to)
{
    memset(to, 0, sizeof *to);
    if (from->outputs < 1 || from->outputs > DIFFERENCE_MOST || from->inputs < 1 ||
        from->inputs > DIFFERENCE_MOST || from->na < 0 || from->na > DIFFERENCE_A_MOST ||
        from->nb < 1 || from->nb > DIFFERENCE_B_MOST)
        return ERR_RANGE;
    to->outputs = (uint8_t)from->outputs;
    to->inputs = (uint8_t)from->inputs;
    to->na = (uint8_t)from->na;
    to->nb = (uint8_t)from->nb;
    to->period_s = from->period_s;
    for (int i = 0; i < from->outputs; i++) {
        for (int k = 0; k < from->na; k++)
            to->a[i][k] = from->a[i * from->na + k];
        for (int j = 0; j < from->inputs; j++)
            for (int k = 0; k < from->nb; k++)
                to->b[i][j][k] = from->b[(i * from->inputs + j) * from->nb + k];
    }
    return ERR_OK;
}

int32_t reflux_response_sampled(const struct reflux_sampled *model, int32_t points,
                                const double *omega, double *response)
{
    struct difference_model m;
    if (take_sampled(model, &m))
        return ERR_RANGE;
    size_t elements = (size_t)m.outputs * m.inputs;
    enum err err = ERR_OK;
    for (int32_t k = 0; k < points && !err; k++) {
        struct cmatrix at;
        err = difference_response(&m, omega[k], &at);
        if (!err)
            give_response(&at, response + 2 * elements * (size_t)k);
    }
    return err;
}

int32_t reflux_array(int32_t n, int32_t points, const double *response, const double *g,
                     int32_t inverse, double *array, double *row_radius, double *column_radius,
                     double *row_ratio, double *column_ratio, int32_t *failed)
{
    struct matrix compensator;
    struct cmatrix f, found;
    struct ina_work work;
    *failed = 0;
    enum err err = take_compensator(n, g, &compensator);
    for (int32_t k = 0; k < points && !err; k++) {
        size_t size = (size_t)n, at = (size_t)k * size;
        *failed = k;
        take_response(size, response + 2 * at * size, &f);
        err = inverse ? ina_inverse(&f, &compensator, &work, &found)
                      : ina_direct(&f, &compensator, &found);
        if (err)
            return err;
        give_response(&found, array + 2 * at * size);
        (void)ina_dominance(&found, INA_BY_ROWS, row_radius + at, row_ratio + at);
        (void)ina_dominance(&found, INA_BY_COLUMNS, column_radius + at, column_ratio + at);
    }
    return err;
}

int32_t reflux_array_operate(int32_t n, double *g, int32_t kind, int32_t row, int32_t other,
                             double by)
{
    struct matrix compensator;
    enum err err = take_compensator(n, g, &compensator);
    if (err)
        return err;
    if (kind < 0 || kind > INA_SWAP || row < 0 || row >= n || other < 0 || other >= n)
        return ERR_RANGE;
    struct ina_operation operation = {(enum ina_kind)kind, (uint8_t)row, (uint8_t)other, by};
    err = ina_operate(&compensator, &operation);
    if (!err)
        give_compensator(&compensator, g);
    return err;
}

int32_t reflux_array_align(int32_t n, const double *response, double *g)
{
    struct matrix compensator;
    struct cmatrix f;
    struct ina_align_work work;
    if (n < 1 || n > INA_MOST)
        return ERR_RANGE;
    take_response((size_t)n, response, &f);
    enum err err = ina_align(&f, &work, &compensator);
    if (!err)
        give_compensator(&compensator, g);
    return err;
}

int32_t reflux_array_normalise(int32_t n, double *g, int32_t *all)
{
    struct matrix compensator;
    enum err err = take_compensator(n, g, &compensator);
    if (err)
        return err;
    *all = ina_normalise(&compensator);
    give_compensator(&compensator, g);
    return ERR_OK;
}

/* F^-1 at every frequency, as ina_search wants it. */
static enum err invert_all(size_t n, size_t points, const double *response, struct cplx *table)
{
    struct matrix one;
    struct cmatrix f, inverse;
    struct ina_work work;
    enum err err = ina_identity((uint8_t)n, &one);
    for (size_t k = 0; k < points && !err; k++) {
        take_response(n, response + 2 * k * n * n, &f);
        err = ina_inverse(&f, &one, &work, &inverse);
        for (size_t m = 0; m < n * n && !err; m++)
            table[k * n * n + m] = inverse.value[m / n][m % n];
    }
    return err;
}

int32_t reflux_array_search(int32_t n, int32_t points, const double *response, int32_t by,
                            int32_t starts, int32_t seed, double *g, double *numbers)
{
    static struct ina_search search;
    struct matrix compensator;
    enum err err = take_compensator(n, g, &compensator);
    if (err)
        return err;
    if (points < 1 || points > INA_POINTS_MOST || (by != 0 && by != 1) || starts < 1 ||
        starts > INA_STARTS_MOST)
        return ERR_RANGE;
    struct cplx *table = malloc((size_t)points * (size_t)(n * n) * sizeof *table);
    if (!table)
        return ERR_FULL;
    struct ina_search_config config;
    ina_search_config_default(&config);
    config.by = by == 0 ? INA_BY_ROWS : INA_BY_COLUMNS;
    config.starts = (uint8_t)starts;
    config.seed = (uint64_t)seed;
    err = invert_all((size_t)n, (size_t)points, response, table);
    if (!err)
        err = ina_search_begin(&search, table, (uint16_t)points, &compensator, &config);
    if (!err)
        while ((err = ina_search_step(&search)) == ERR_BUSY)
            ;
    free(table);
    if (err)
        return err;
    give_compensator(&search.g, g);
    numbers[0] = search.before;
    numbers[1] = search.after;
    numbers[2] = (double)search.looks;
    numbers[3] = search.lambda;
    return ERR_OK;
}

int32_t reflux_loci(int32_t n, int32_t points, const double *response, const double *g,
                    double *loci)
{
    struct matrix compensator;
    struct cplx before[MATRIX_MAX], now[MATRIX_MAX];
    enum err err = take_compensator(n, g, &compensator);
    for (int32_t k = 0; k < points && !err; k++) {
        struct cmatrix f, h;
        size_t size = (size_t)n;
        take_response(size, response + 2 * (size_t)k * size * size, &f);
        err = ina_direct(&f, &compensator, &h);
        if (!err)
            err = ceigen_values(&h, now);
        if (err)
            return err;
        if (k > 0)
            ceigen_follow(before, now, (uint8_t)n);
        memcpy(before, now, sizeof before);
        for (size_t i = 0; i < size; i++) {
            loci[2 * ((size_t)k * size + i)] = now[i].re;
            loci[2 * ((size_t)k * size + i) + 1] = now[i].im;
        }
    }
    return err;
}

#include "identify/arx_fit.h"

#include <string.h>

#include "identify/common.h"

#define IV_PASSES  30
#define ELS_PASSES 100
#define SETTLED    REAL_C(1e-3) /* of a standard deviation */

/* Samples from .. to - 1 of an output. */
struct arx_part {
    const struct arx_data *data;
    uint8_t output;
    uint32_t from, to;
};

static real_t output_at(const struct arx_part *p, uint32_t k)
{
    return p->data->y[(size_t)k * p->data->outputs + p->output];
}

static const real_t *inputs_at(const struct arx_part *p, uint32_t k)
{
    return &p->data->u[(size_t)k * p->data->inputs];
}

/* Whether no theta has changed by more than rounding and a thousandth of its standard deviation. */
static bool unchanged(const struct arx_fit *fit, const real_t *before, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        real_t rounding = REAL_C(64.0) * REAL_EPSILON * (ONE + real_abs(before[i]));
        if (!(real_abs(fit->theta[i] - before[i]) <= SETTLED * fit->sd[i] + rounding))
            return false;
    }
    return true;
}

/* ---- instrumental variables ---- */

/* Rows (z, phi, y) into a triangle of the instruments: with Z = Q R what stands on the right is Q'Phi and Q'y. */
static enum err rotate_along(const struct arx_part *p, struct arx_work *w,
                             const struct arx_fit *fit)
{
    const struct arx_orders *o = &fit->orders;
    uint8_t inputs = p->data->inputs;
    size_t n = arx_parameters(o, inputs), before = arx_before(o, inputs);
    struct arx_history h = {0}, clean = {0};
    triangle_begin(&w->triangle, n, n + 1, w->of);
    for (uint32_t k = p->from; k < p->to; k++) {
        real_t row[2 * ARX_MOST + 1], y = output_at(p, k), x = y;
        if (k - p->from >= before) {
            arx_regressor(o, inputs, &clean, row);
            arx_regressor(o, inputs, &h, row + n);
            row[2 * n] = y;
            x = arx_sum(row, fit->theta, n);
            if (!(real_abs(x) <= VALUE_MAX))
                return ERR_STATE;
            triangle_row(&w->triangle, row);
        }
        arx_push(&h, inputs, y, inputs_at(p, k), ZERO);
        arx_push(&clean, inputs, x, inputs_at(p, k), ZERO);
    }
    for (size_t i = 0; i < n; i++)
        memcpy(w->square[i], triangle_at(&w->triangle, i) + (n - i), (n + 1) * sizeof(real_t));
    return ERR_OK;
}

static void exchange_rows(struct arx_work *w, size_t a, size_t b, size_t width)
{
    for (size_t j = 0; j < width && a != b; j++) {
        real_t other = w->square[a][j];
        w->square[a][j] = w->square[b][j];
        w->square[b][j] = other;
    }
}

/* Gauss and Jordan with pivots by columns: of square [n][n + 1] the matrix becomes its inverse, columns in the order of the
 * pivots, and the last column the solution. */
static enum err invert_in_place(struct arx_work *w, size_t n)
{
    real_t size[ARX_MOST];
    for (size_t j = 0; j < n; j++) {
        size[j] = ZERO;
        for (size_t i = 0; i < n; i++)
            size[j] = real_abs(w->square[i][j]) > size[j] ? real_abs(w->square[i][j]) : size[j];
    }
    for (size_t k = 0; k < n; k++) {
        size_t at = k;
        for (size_t i = k + 1; i < n; i++)
            at = real_abs(w->square[i][k]) > real_abs(w->square[at][k]) ? i : at;
        exchange_rows(w, k, at, n + 1);
        real_t pivot = w->square[k][k];
        if (!(real_abs(pivot) > REAL_C(8.0) * (real_t)n * REAL_EPSILON * size[k]))
            return ERR_SINGULAR;
        w->square[k][k] = ONE;
        for (size_t j = 0; j <= n; j++)
            w->square[k][j] /= pivot;
        for (size_t i = 0; i < n; i++) {
            real_t times = w->square[i][k];
            if (i == k)
                continue;
            w->square[i][k] = ZERO;
            for (size_t j = 0; j <= n; j++)
                w->square[i][j] -= times * w->square[k][j];
        }
    }
    return ERR_OK;
}

/* Errors of fit->theta, and of what follows from them. */
static void take_errors(const struct arx_part *p, size_t n, const struct arx_work *w,
                        struct arx_fit *fit)
{
    struct arx_history h = {0};
    size_t before = arx_before(&fit->orders, p->data->inputs);
    fit->squares = ZERO;
    for (uint32_t k = p->from; k < p->to; k++) {
        real_t phi[ARX_MOST], y = output_at(p, k);
        arx_regressor(&fit->orders, p->data->inputs, &h, phi);
        real_t e = y - arx_sum(phi, fit->theta, n);
        if (k - p->from >= before)
            fit->squares += e * e;
        arx_push(&h, p->data->inputs, y, inputs_at(p, k), ZERO);
    }
    fit->variance = fit->squares / (real_t)(fit->rows - n);
    for (size_t i = 0; i < n;
         i++) { /* rows of the inverse; the order of its columns does not matter */
        real_t sum = ZERO;
        for (size_t j = 0; j < n; j++)
            sum += w->square[i][j] * w->square[i][j];
        fit->sd[i] = real_sqrt(sum * fit->variance);
    }
}

static enum err by_instruments(const struct arx_part *p, struct arx_work *w, struct arx_fit *fit)
{
    size_t n = arx_parameters(&fit->orders, p->data->inputs);
    fit->settled = false;
    for (fit->passes = 1; fit->passes <= IV_PASSES; fit->passes++) {
        real_t before[ARX_MOST];
        memcpy(before, fit->theta, sizeof before);
        enum err err = rotate_along(p, w, fit);
        if (!err)
            err = invert_in_place(w, n);
        if (err)
            return err;
        for (size_t i = 0; i < n; i++)
            fit->theta[i] = w->square[i][n];
        take_errors(p, n, w, fit);
        fit->settled = unchanged(fit, before, n);
        if (fit->settled)
            return ERR_OK;
    }
    fit->passes = IV_PASSES;
    return ERR_OK;
}

/* ---- extended least squares ---- */

/* Rows with the errors that fit->theta has left; *mean gets theirs. */
static enum err rotate_errors(const struct arx_part *p, struct arx_work *w,
                              const struct arx_orders *o, const struct arx_fit *fit, real_t *mean)
{
    uint8_t inputs = p->data->inputs;
    size_t n = arx_parameters(o, inputs), known = arx_parameters(&fit->orders, inputs);
    size_t before = arx_before(o, inputs);
    struct arx_history h = {0};
    triangle_begin(&w->triangle, n + 1, 0, w->of);
    for (uint32_t k = p->from; k < p->to; k++) {
        real_t row[ARX_MOST + 1], old[ARX_MOST], y = output_at(p, k), e = ZERO;
        if (k - p->from >= before) {
            arx_regressor(&fit->orders, inputs, &h, old);
            e = y - arx_sum(old, fit->theta, known);
            if (!(real_abs(e) <= VALUE_MAX))
                return ERR_STATE;
            arx_regressor(o, inputs, &h, row);
            row[n] = y;
            triangle_row(&w->triangle, row);
            *mean += e / (real_t)fit->rows;
        }
        arx_push(&h, inputs, y, inputs_at(p, k), e);
    }
    return ERR_OK;
}

/* A level of the errors would go to and fro between them and the constant, further each time where C(1) is below a half. So
 * the constant is that beside errors without their mean. */
static void level_constant(struct arx_fit *fit, size_t n, real_t mean)
{
    for (size_t k = 0; k < fit->orders.nc && fit->orders.constant; k++)
        fit->theta[n - 1] += fit->theta[n - 2 - k] * mean;
}

static enum err extend(const struct arx_part *p, uint8_t nc, struct arx_work *w,
                       struct arx_fit *fit)
{
    struct arx_orders with = fit->orders;
    with.nc = nc;
    size_t n = arx_parameters(&with, p->data->inputs), skip = arx_before(&with, p->data->inputs);
    if (p->to - p->from < skip + n + 2)
        return ERR_EMPTY;
    fit->rows = p->to - p->from - (uint32_t)skip;
    fit->settled = false;
    for (fit->passes = 1; fit->passes <= ELS_PASSES; fit->passes++) {
        real_t before[ARX_MOST], mean = ZERO;
        memcpy(before, fit->theta, sizeof before);
        enum err err = rotate_errors(p, w, &with, fit, &mean);
        if (err)
            return err;
        fit->orders = with;
        err = arx_take(&w->triangle, fit);
        if (err)
            return err;
        level_constant(fit, n, mean);
        fit->settled = unchanged(fit, before, n);
        if (fit->settled)
            return ERR_OK;
        /* Half the way only: C of the whole may be unstable, and errors then grow without end. */
        for (size_t i = 0; i < n && fit->passes > 1; i++)
            fit->theta[i] = before[i] + REAL_C(0.5) * (fit->theta[i] - before[i]);
    }
    fit->passes = ELS_PASSES;
    return ERR_OK;
}

enum err arx_fit(const struct arx_data *d, uint8_t output, const struct arx_orders *o,
                 enum arx_method method, uint32_t from, uint32_t to, struct arx_work *w,
                 struct arx_fit *fit)
{
    const struct arx_part part = {d, output, from, to};
    memset(fit, 0, sizeof *fit);
    fit->orders = *o;
    fit->orders.nc = 0;
    enum err err = arx_collect(d, output, &fit->orders, from, to,
                               (uint32_t)arx_before(o, d->inputs), w, &fit->rows);
    if (!err)
        err = arx_take(&w->triangle, fit);
    fit->settled = true;
    if (err || method == ARX_LS)
        return err;
    if (method == ARX_IV)
        return by_instruments(&part, w, fit);
    return extend(&part, o->nc, w, fit);
}

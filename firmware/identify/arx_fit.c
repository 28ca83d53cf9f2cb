#include "identify/arx_fit.h"

#include <string.h>

#include "base/assertion.h"
#include "identify/common.h"

#define IV_PASSES  30
#define ELS_PASSES 100
#define SETTLED    REAL_C(1e-3) /* of a standard deviation */

enum fit_stage { FIT_LEAST, FIT_INSTRUMENTS, FIT_ERRORS, FIT_EXTENDED, FIT_OVER };

static const real_t *inputs_at(const struct arx_fitting *f)
{
    REFLUX_ASSERT(f->rows.k < f->rows.data->samples);
    return &f->rows.data->u[(size_t)f->rows.k * f->rows.data->inputs];
}

static real_t output_at(const struct arx_fitting *f)
{
    REFLUX_ASSERT(f->rows.k < f->rows.data->samples);
    return f->rows.data->y[(size_t)f->rows.k * f->rows.data->outputs + f->rows.output];
}

/* From the beginning of the record again. */
static void begin_pass(struct arx_fitting *f, enum fit_stage stage)
{
    f->rows.k = f->rows.from;
    memset(&f->rows.history, 0, sizeof f->rows.history);
    memset(&f->clean, 0, sizeof f->clean);
    f->stage = (uint8_t)stage;
}

static void end_of_fit(struct arx_fitting *f, enum err err)
{
    f->err = err;
    f->stage = FIT_OVER;
}

/* Returns true when no theta has changed by more than rounding and a thousandth of its standard deviation. */
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

static void begin_instruments(struct arx_fitting *f)
{
    REFLUX_ASSERT(arx_parameters(&f->fit->orders, f->rows.data->inputs) <= ARX_MOST);
    size_t n = arx_parameters(&f->fit->orders, f->rows.data->inputs);
    memcpy(f->before, f->fit->theta, sizeof f->before);
    triangle_begin(&f->rows.work->triangle, n, n + 1, f->rows.work->cells);
    begin_pass(f, FIT_INSTRUMENTS);
}

/* A row (z, phi, y) into a triangle of the instruments: with Z = Q R what stands on the right is Q'Phi and Q'y. */
static enum err rotate_along(struct arx_fitting *f)
{
    const struct arx_orders *o = &f->fit->orders;
    uint8_t inputs = f->rows.data->inputs;
    size_t n = arx_parameters(o, inputs), before = arx_before(o, inputs);
    real_t row[2 * ARX_MOST + 1], y = output_at(f), x = y;
    if (f->rows.k - f->rows.from >= before) {
        arx_regressor(o, inputs, &f->clean, row);
        arx_regressor(o, inputs, &f->rows.history, row + n);
        row[2 * n] = y;
        x = arx_sum(row, f->fit->theta, n);
        if (!(real_abs(x) <= VALUE_MAX))
            return ERR_STATE;
        triangle_row(&f->rows.work->triangle, row);
    }
    arx_push(&f->rows.history, inputs, y, inputs_at(f), ZERO);
    arx_push(&f->clean, inputs, x, inputs_at(f), ZERO);
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
    REFLUX_ASSERT(n <= ARX_MOST);
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

/* The solution of a pass; its errors are looked at next. */
static void solve_instruments(struct arx_fitting *f)
{
    struct arx_work *w = f->rows.work;
    size_t n = arx_parameters(&f->fit->orders, f->rows.data->inputs);
    for (size_t i = 0; i < n; i++)
        memcpy(w->square[i], triangle_at(&w->triangle, i) + (n - i), (n + 1) * sizeof(real_t));
    enum err err = invert_in_place(w, n);
    if (err) {
        end_of_fit(f, err);
        return;
    }
    for (size_t i = 0; i < n; i++)
        f->fit->theta[i] = w->square[i][n];
    f->fit->squares = ZERO;
    begin_pass(f, FIT_ERRORS);
}

static enum err add_error(struct arx_fitting *f)
{
    struct arx_fit *fit = f->fit;
    uint8_t inputs = f->rows.data->inputs;
    real_t phi[ARX_MOST], y = output_at(f);
    arx_regressor(&fit->orders, inputs, &f->rows.history, phi);
    real_t e = y - arx_sum(phi, fit->theta, arx_parameters(&fit->orders, inputs));
    if (f->rows.k - f->rows.from >= arx_before(&fit->orders, inputs))
        fit->squares += e * e;
    arx_push(&f->rows.history, inputs, y, inputs_at(f), ZERO);
    return ERR_OK;
}

/* Ends a pass with the errors of fit->theta, and decides on another one. */
static void end_instruments(struct arx_fitting *f)
{
    struct arx_fit *fit = f->fit;
    const struct arx_work *w = f->rows.work;
    size_t n = arx_parameters(&fit->orders, f->rows.data->inputs);
    fit->variance = fit->squares / (real_t)(fit->rows - n);
    for (size_t i = 0; i < n;
         i++) { /* rows of the inverse; the order of its columns does not matter */
        real_t sum = ZERO;
        for (size_t j = 0; j < n; j++)
            sum += w->square[i][j] * w->square[i][j];
        fit->sd[i] = real_sqrt(sum * fit->variance);
    }
    fit->settled = unchanged(fit, f->before, n);
    if (fit->settled || fit->passes >= IV_PASSES) {
        end_of_fit(f, ERR_OK);
        return;
    }
    fit->passes++;
    begin_instruments(f);
}

/* ---- extended least squares ---- */

static void begin_extended(struct arx_fitting *f)
{
    memcpy(f->before, f->fit->theta, sizeof f->before);
    f->mean = ZERO;
    triangle_begin(&f->rows.work->triangle, arx_parameters(&f->with, f->rows.data->inputs) + 1, 0,
                   f->rows.work->cells);
    begin_pass(f, FIT_EXTENDED);
}

/* A row with the errors that fit->theta has left; mean gets theirs. */
static enum err rotate_errors(struct arx_fitting *f)
{
    const struct arx_fit *fit = f->fit;
    uint8_t inputs = f->rows.data->inputs;
    size_t n = arx_parameters(&f->with, inputs), known = arx_parameters(&fit->orders, inputs);
    real_t row[ARX_MOST + 1], old[ARX_MOST], y = output_at(f), e = ZERO;
    if (f->rows.k - f->rows.from >= arx_before(&f->with, inputs)) {
        arx_regressor(&fit->orders, inputs, &f->rows.history, old);
        e = y - arx_sum(old, fit->theta, known);
        if (!(real_abs(e) <= VALUE_MAX))
            return ERR_STATE;
        arx_regressor(&f->with, inputs, &f->rows.history, row);
        row[n] = y;
        triangle_row(&f->rows.work->triangle, row);
        f->mean += e / (real_t)fit->rows;
    }
    arx_push(&f->rows.history, inputs, y, inputs_at(f), e);
    return ERR_OK;
}

/* A level of the errors would go to and fro between them and the constant, further each time where C(1) is below a half. So
 * the constant is that beside errors without their mean. */
static void level_constant(struct arx_fit *fit, size_t n, real_t mean)
{
    for (size_t k = 0; k < fit->orders.nc && fit->orders.constant; k++)
        fit->theta[n - 1] += fit->theta[n - 2 - k] * mean;
}

static void end_extended(struct arx_fitting *f)
{
    struct arx_fit *fit = f->fit;
    size_t n = arx_parameters(&f->with, f->rows.data->inputs);
    fit->orders = f->with;
    enum err err = arx_take(&f->rows.work->triangle, fit);
    if (err) {
        end_of_fit(f, err);
        return;
    }
    level_constant(fit, n, f->mean);
    fit->settled = unchanged(fit, f->before, n);
    if (fit->settled) {
        end_of_fit(f, ERR_OK);
        return;
    }
    /* Half the way only: C of the whole may be unstable, and errors then grow without end. */
    for (size_t i = 0; i < n && fit->passes > 1; i++)
        fit->theta[i] = f->before[i] + REAL_C(0.5) * (fit->theta[i] - f->before[i]);
    if (fit->passes >= ELS_PASSES) {
        end_of_fit(f, ERR_OK);
        return;
    }
    fit->passes++;
    begin_extended(f);
}

/* ---- all of them ---- */

void arx_fit_begin(struct arx_fitting *f, const struct arx_data *d, uint8_t output,
                   const struct arx_orders *o, enum arx_method method, uint32_t from, uint32_t to,
                   struct arx_work *w, struct arx_fit *fit)
{
    memset(fit, 0, sizeof *fit);
    memset(f, 0, sizeof *f);
    fit->orders = f->with = *o;
    fit->orders.nc = 0;
    f->fit = fit;
    f->method = (uint8_t)method;
    f->err = arx_collect_begin(&f->rows, d, output, &fit->orders, from, to,
                               (uint32_t)arx_before(o, d->inputs), w);
    if (f->err)
        f->stage = FIT_OVER;
}

/* Least squares are there: all of it, or where the passes begin. */
static void end_least(struct arx_fitting *f)
{
    struct arx_fit *fit = f->fit;
    fit->rows = f->rows.rows;
    enum err err = arx_take(&f->rows.work->triangle, fit);
    fit->settled = true;
    if (err || f->method == ARX_LS) {
        end_of_fit(f, err);
        return;
    }
    fit->settled = false;
    fit->passes = 1;
    if (f->method == ARX_IV) {
        begin_instruments(f);
        return;
    }
    size_t n = arx_parameters(&f->with, f->rows.data->inputs),
           skip = arx_before(&f->with, f->rows.data->inputs);
    if (f->rows.to - f->rows.from < skip + n + 2) {
        end_of_fit(f, ERR_EMPTY);
        return;
    }
    fit->rows = f->rows.to - f->rows.from - (uint32_t)skip;
    begin_extended(f);
}

static enum err fit_row(struct arx_fitting *f)
{
    if (f->stage == FIT_INSTRUMENTS)
        return rotate_along(f);
    return f->stage == FIT_ERRORS ? add_error(f) : rotate_errors(f);
}

/* Samples of a pass; what comes behind the last one is the next piece. */
static void go_through(struct arx_fitting *f, uint32_t most)
{
    for (; f->rows.k < f->rows.to && most > 0; f->rows.k++, most--) {
        enum err err = fit_row(f);
        if (err) {
            end_of_fit(f, err);
            return;
        }
    }
}

bool arx_fit_piece(struct arx_fitting *f, uint32_t most)
{
    bool rows_left = f->stage != FIT_OVER && f->rows.k < f->rows.to;
    if (f->stage == FIT_LEAST && rows_left)
        (void)arx_collect_piece(&f->rows, most);
    else if (f->stage == FIT_LEAST)
        end_least(f);
    else if (rows_left)
        go_through(f, most);
    else if (f->stage == FIT_INSTRUMENTS)
        solve_instruments(f);
    else if (f->stage == FIT_ERRORS)
        end_instruments(f);
    else if (f->stage == FIT_EXTENDED)
        end_extended(f);
    return f->stage != FIT_OVER;
}

enum err arx_fit(const struct arx_data *d, uint8_t output, const struct arx_orders *o,
                 enum arx_method method, uint32_t from, uint32_t to, struct arx_work *w,
                 struct arx_fit *fit)
{
    struct arx_fitting f;
    arx_fit_begin(&f, d, output, o, method, from, to, w, fit);
    /* A pass has two pieces, instruments have two passes for each solution. */
    for (unsigned piece = 0; piece < 4u * ELS_PASSES && arx_fit_piece(&f, to - from); piece++)
        ;
    return f.err;
}

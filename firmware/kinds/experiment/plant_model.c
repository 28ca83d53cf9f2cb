#include "kinds/experiment/plant_model.h"

#include <string.h>

#include "base/assertion.h"
#include "num/polynomial.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)
#define TWO  REAL_C(2.0)

/* Number of the best orders outside the grid that are fitted. */
#define BEST_FITTED 8u
/* Largest distance of gains at rest from those of two thirds of the record, and from what the record leaves of them: parts of the largest
 * effect of an input. */
#define PARTS_APART REAL_C(0.25)
#define REST_APART  REAL_C(0.1)
/* Time constants in which a plant settles. */
#define SETTLES REAL_C(4.0)

enum finding_phase {
    FIND_ORDERS,
    FIND_NEXT,
    FIND_FIT,
    FIND_JUDGE,
    FIND_ALL,
    FIND_LEFT, /* what the model leaves of the record */
    FIND_OVER  /* of an output */
};

/* ---- polynomials ---- */

bool plant_roots_within(const real_t *a, size_t n, real_t radius)
{
    REFLUX_ASSERT(n < POLYNOMIAL_MOST);
    struct polynomial p = {.n = (uint8_t)(n + 1u), .value = {ONE}};
    memcpy(&p.value[1], a, n * sizeof a[0]);
    return polynomial_zeros_within(&p, radius);
}

/* Gains at rest; false: it integrates, but for rounding. */
static bool gains_of_fit(const struct arx_fit *fit, uint8_t inputs, real_t *gain)
{
    const struct arx_orders *o = &fit->orders;
    real_t at_rest = ONE, size = ONE;
    size_t n = 0;
    for (; n < o->na; n++) {
        at_rest += fit->theta[n];
        size += real_abs(fit->theta[n]);
    }
    if (!(at_rest > REAL_C(16.0) * REAL_EPSILON * size))
        return false;
    for (size_t j = 0; j < inputs; j++) {
        gain[j] = ZERO;
        for (size_t k = o->first[j]; k <= o->last[j] && o->last[j] > 0; k++)
            gain[j] += fit->theta[n++] / at_rest;
    }
    return true;
}

/* ---- which of the orders ---- */

/* All of the grid, and the best of the others. */
static bool is_worth_a_fit(const struct plant_finding *f, uint16_t trial)
{
    REFLUX_ASSERT(trial < f->search.trials);
    const struct arx_search *s = &f->search;
    const struct arx_trial *t = &s->trial[trial];
    bool grid = true;
    unsigned before = 0;
    if (t->err)
        return false;
    for (size_t j = 0; j < f->data.inputs; j++)
        grid = grid && t->orders.first[j] == t->orders.first[0] &&
               t->orders.last[j] == t->orders.last[0];
    for (uint16_t k = 0; k < s->trials; k++)
        before += !s->trial[k].err && s->trial[k].criterion < t->criterion ? 1u : 0u;
    return grid || before < BEST_FITTED;
}

/* The criterion of errors on data that the model has not seen: of the simulation, of least squares one sample ahead. */
static real_t validation_criterion(const struct plant_finding *f, const struct arx_judgement *j)
{
    REFLUX_ASSERT(f->trial < f->search.trials);
    real_t n = (real_t)j->rows, p = (real_t)f->search.trial[f->trial].parameters;
    real_t square = f->wanted.method == ARX_LS ? j->step_squares : j->simulated_squares;
    real_t least = REAL_C(1e-24) * j->squares;
    square = square > least ? square : least;
    real_t misfit = square > ZERO ? n * real_log(square) : ZERO;
    if (f->wanted.criterion == ARX_BIC)
        return misfit + p * real_log(n);
    return n > p + ONE ? misfit + TWO * p + TWO * p * (p + ONE) / (n - p - ONE)
                       : misfit + REAL_C(1e12);
}

static void begin_fit_of(struct plant_finding *f, const struct arx_orders *orders, uint32_t to)
{
    struct arx_orders o = *orders;
    if (f->wanted.method == ARX_ELS)
        o.nc = o.na ? o.na : 1u;
    arx_fit_begin(&f->fitting, &f->data, f->output, &o, (enum arx_method)f->wanted.method, 0, to,
                  &f->search.work, &f->fit);
}

static void fit_next(struct plant_finding *f)
{
    while (f->trial < f->search.trials && !is_worth_a_fit(f, f->trial))
        f->trial++;
    if (f->trial < f->search.trials) {
        begin_fit_of(f, &f->search.trial[f->trial].orders, f->border);
        f->phase = FIND_FIT;
    } else if (f->any) {
        begin_fit_of(f, &f->best.orders, f->data.samples);
        f->phase = FIND_ALL;
    } else {
        f->found[f->output].verdict = PLANT_UNSTABLE;
        f->phase = FIND_OVER;
    }
}

static void judge_next(struct plant_finding *f)
{
    bool no_model = f->fitting.err || arx_judge_begin(&f->judging, &f->data, f->output, &f->fit,
                                                      f->border, f->data.samples) != ERR_OK;
    if (no_model)
        f->trial++;
    f->phase = no_model ? (uint8_t)FIND_NEXT : (uint8_t)FIND_JUDGE;
}

static void keep_if_best(struct plant_finding *f)
{
    struct arx_judgement judged;
    arx_judge_take(&f->judging, &judged);
    real_t criterion = validation_criterion(f, &judged);
    if (!f->any || criterion < f->best_criterion) {
        f->best = f->fit;
        f->best_criterion = criterion;
        f->best_judged = judged;
        f->any = true;
    }
    f->trial++;
    f->phase = FIND_NEXT;
}

/* ---- what comes out ---- */

static real_t explained_part(real_t squares, real_t all)
{
    return all > ZERO ? ONE - real_sqrt(squares / all) : ZERO;
}

static void put_coefficients(const struct plant_finding *f, struct plant_output *out)
{
    const struct arx_orders *o = &f->fit.orders;
    size_t n = 0;
    out->na = o->na;
    out->settled = f->fit.settled;
    for (; n < o->na; n++)
        out->a[n] = f->fit.theta[n];
    for (size_t j = 0; j < f->data.inputs; j++) {
        out->nb = o->last[j] > out->nb ? o->last[j] : out->nb;
        for (size_t k = o->first[j]; k <= o->last[j] && o->last[j] > 0; k++)
            out->b[j][k - 1] = f->fit.theta[n++];
    }
}

/* The largest of change[] times what the inputs did, as a part of the largest of all[]. */
static real_t part_of_effects(const struct plant_finding *f, const real_t *change,
                              const real_t *all)
{
    real_t largest = ZERO, apart = ZERO;
    for (size_t j = 0; j < f->data.inputs; j++) {
        real_t effect = real_abs(all[j]) * f->moved[j], other = real_abs(change[j]) * f->moved[j];
        largest = effect > largest ? effect : largest;
        apart = other > apart ? other : apart;
    }
    return largest > ZERO ? apart / largest : ONE;
}

static enum plant_verdict judged_as(const struct plant_finding *f, struct plant_output *out)
{
    real_t change[DIFFERENCE_MOST];
    real_t radius = real_exp(-SETTLES / (real_t)f->wanted.memory);
    if (!(out->fit >= f->wanted.fit))
        return PLANT_POOR;
    if (!gains_of_fit(&f->fit, f->data.inputs, out->gain) ||
        !plant_roots_within(out->a, out->na, radius) ||
        !gains_of_fit(&f->best, f->data.inputs, change))
        return PLANT_SLOW;
    for (size_t j = 0; j < f->data.inputs; j++)
        change[j] -= out->gain[j];
    out->apart = part_of_effects(f, change, out->gain);
    return out->apart <= PARTS_APART ? PLANT_USABLE : PLANT_UNSURE;
}

/* The model on its own from the beginning of the record, at rest there. What it leaves is put down to the inputs as they are behind
 * the slowest lag that the experiment allows: what comes out is by how much its gains at rest are off. Where B ends too soon, or A is
 * of too low an order, a model can follow the record well and be far off there. */
static void begin_left(struct plant_finding *f)
{
    struct plant_leftover *l = &f->left;
    memset(l, 0, sizeof *l);
    l->pole = real_exp(-SETTLES / (real_t)f->wanted.memory);
    triangle_begin(&l->triangle, (size_t)f->data.inputs + 2, 0, l->cells);
    f->phase = FIND_LEFT;
}

/* A sample; false: it has run away. */
static bool take_left(struct plant_finding *f)
{
    REFLUX_ASSERT(f->left.k < f->data.samples);
    struct plant_leftover *l = &f->left;
    uint8_t n = f->data.inputs;
    const real_t *u = &f->data.u[(size_t)l->k * n];
    real_t phi[ARX_MOST], row[DIFFERENCE_MOST + 2];
    arx_regressor(&f->fit.orders, n, &l->history, phi);
    real_t x = arx_sum(phi, f->fit.theta, arx_parameters(&f->fit.orders, n));
    if (!(real_abs(x) <= REAL_C(1e12)))
        return false;
    memcpy(row, l->slow, n * sizeof row[0]);
    row[n] = ONE;
    row[n + 1] = f->data.y[(size_t)l->k * f->data.outputs + f->output] - x;
    if (l->k > 0)
        triangle_row(&l->triangle, row);
    arx_push(&l->history, n, x, u, ZERO);
    for (size_t j = 0; j < n; j++)
        l->slow[j] += (ONE - l->pole) * (u[j] - l->slow[j]);
    l->k++;
    return true;
}

static void end_left(struct plant_finding *f)
{
    struct plant_output *out = &f->found[f->output];
    real_t theta[DIFFERENCE_MOST + 2];
    f->phase = FIND_OVER;
    if (triangle_solve(&f->left.triangle, theta)) {
        out->verdict = PLANT_UNSURE;
        return;
    }
    real_t apart = part_of_effects(f, theta, out->gain);
    if (apart > REST_APART)
        out->verdict = PLANT_UNSURE;
    out->apart = apart > out->apart ? apart : out->apart;
}

static void left_piece(struct plant_finding *f, uint32_t most)
{
    for (; f->left.k < f->data.samples && most > 0; most--)
        if (!take_left(f)) {
            f->found[f->output].verdict = PLANT_UNSTABLE;
            f->phase = FIND_OVER;
            return;
        }
    if (f->left.k >= f->data.samples)
        end_left(f);
}

static void end_output(struct plant_finding *f)
{
    struct plant_output *out = &f->found[f->output];
    f->phase = FIND_OVER;
    out->one_step = explained_part(f->best_judged.step_squares, f->best_judged.squares);
    out->fit = explained_part(f->best_judged.simulated_squares, f->best_judged.squares);
    if (f->fitting.err) {
        out->verdict = PLANT_UNSTABLE;
        return;
    }
    put_coefficients(f, out);
    out->verdict = (uint8_t)judged_as(f, out);
    if (out->verdict == PLANT_USABLE)
        begin_left(f);
}

/* ---- pieces ---- */

static void begin_orders(struct plant_finding *f)
{
    f->phase = FIND_ORDERS;
    f->trial = 0;
    f->any = false;
    arx_select_begin(&f->searching, &f->data, f->output, f->wanted.na, f->wanted.nb, true,
                     (enum arx_criterion)f->wanted.criterion, 0, f->border, &f->search);
}

void plant_finding_begin(struct plant_finding *f, const struct arx_data *data,
                         const struct plant_wanted *wanted)
{
    REFLUX_ASSERT(data->inputs <= DIFFERENCE_MOST && data->outputs <= DIFFERENCE_MOST);
    memset(f, 0, sizeof *f);
    f->wanted = *wanted;
    f->data = *data;
    f->border = data->samples / 3u * 2u;
    for (size_t j = 0; j < data->inputs; j++) {
        real_t sum = ZERO;
        for (uint32_t k = 0; k < data->samples; k++)
            sum += data->u[(size_t)k * data->inputs + j] * data->u[(size_t)k * data->inputs + j];
        f->moved[j] = real_sqrt(sum / (real_t)(data->samples ? data->samples : 1u));
    }
    begin_orders(f);
}

static void end_orders(struct plant_finding *f)
{
    if (f->searching.err)
        f->found[f->output].verdict = PLANT_UNTOLD;
    f->phase = f->searching.err ? (uint8_t)FIND_OVER : (uint8_t)FIND_NEXT;
}

bool plant_finding_piece(struct plant_finding *f, uint32_t most)
{
    REFLUX_ASSERT(f->output < DIFFERENCE_MOST);
    switch ((enum finding_phase)f->phase) {
    case FIND_ORDERS:
        if (!arx_select_piece(&f->searching, most))
            end_orders(f);
        return true;
    case FIND_NEXT:
        fit_next(f);
        return true;
    case FIND_FIT:
        if (!arx_fit_piece(&f->fitting, most))
            judge_next(f);
        return true;
    case FIND_JUDGE:
        if (!arx_judge_piece(&f->judging, most))
            keep_if_best(f);
        return true;
    case FIND_ALL:
        if (!arx_fit_piece(&f->fitting, most))
            end_output(f);
        return true;
    case FIND_LEFT:
        left_piece(f, most);
        return true;
    case FIND_OVER:
        break;
    }
    if (f->output + 1u >= f->data.outputs)
        return false;
    f->output++;
    begin_orders(f);
    return true;
}

unsigned plant_finding_done(const struct plant_finding *f)
{
    return f->output;
}

const struct plant_output *plant_finding_output(const struct plant_finding *f, unsigned i)
{
    REFLUX_ASSERT(i < DIFFERENCE_MOST);
    return &f->found[i];
}

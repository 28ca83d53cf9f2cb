#include "design/state_decoupler.h"

#include <stddef.h>

#include "base/assertion.h"

/* Rest that poles meant to be pairs may leave, part of the magnitudes. */
#define PAIR_ERROR REAL_C(1e-4)

void state_decoupler_config_default(struct state_decoupler_config *config)
{
    *config = (struct state_decoupler_config){
        .row_lo = REAL_C(1e-3), .condition_hi = REAL_C(1e4), .weight_lo = REAL_C(1e-6)};
}

static enum err refuse_state(struct state_decoupler_refusal *reason, enum err code,
                             const char *field, const char *wanted, size_t loop)
{
    *reason = (struct state_decoupler_refusal){field, wanted, (uint8_t)loop};
    return code;
}

static enum err check_state_config(const struct state_decoupler_config *c,
                                   struct state_decoupler_refusal *reason)
{
    if (!real_within(c->row_lo, REAL_C(0.0), REAL_C(0.1)))
        return refuse_state(reason, ERR_RANGE, "row_lo", "0 to 0.1", STATE_LOOP_NONE);
    if (!real_within(c->condition_hi, REAL_C(1.0), REAL_C(1e6)))
        return refuse_state(reason, ERR_RANGE, "condition_hi", "1 to 1e6", STATE_LOOP_NONE);
    if (!real_within(c->weight_lo, REAL_C(0.0), REAL_C(0.1)))
        return refuse_state(reason, ERR_RANGE, "weight_lo", "0 to 0.1", STATE_LOOP_NONE);
    return ERR_OK;
}

static enum err check_goal(const struct state_decoupler_goal *g, size_t loops,
                           struct state_decoupler_refusal *reason)
{
    for (size_t i = 0; i < loops; i++) {
        if (!real_within(g->integral_s[i], REAL_C(0.0), REAL_C(1e6)))
            return refuse_state(reason, ERR_RANGE, "integral_s", "0 (none) to 1e6", i);
        if (!real_within(g->derivative_s[i], REAL_C(0.0), REAL_C(1e6)))
            return refuse_state(reason, ERR_RANGE, "derivative_s", "0 (none) to 1e6", i);
    }
    if (!real_within(g->hold_s, REAL_C(0.0), REAL_C(1e6)))
        return refuse_state(reason, ERR_RANGE, "hold_s", "0 (not judged) to 1e6", STATE_LOOP_NONE);
    return ERR_OK;
}

/* Copies a row of C; what lies behind the states is 0. */
static void output_row(const struct matrix *c, size_t i, real_t *row)
{
    REFLUX_ASSERT(i < MATRIX_MAX);
    for (size_t k = 0; k < STATE_MODEL_STATES; k++)
        row[k] = k < c->cols ? c->value[i][k] : REAL_C(0.0);
}

/* to <- row times a matrix. */
static void multiply_row(const real_t *row, const struct matrix *by, real_t *to)
{
    for (size_t j = 0; j < by->cols; j++) {
        to[j] = REAL_C(0.0);
        for (size_t k = 0; k < by->rows; k++)
            to[j] += row[k] * by->value[k][j];
    }
}

static real_t norm_of(const real_t *x, size_t n)
{
    real_t most = REAL_C(0.0), sum = REAL_C(0.0);
    for (size_t k = 0; k < n; k++)
        if (real_abs(x[k]) > most)
            most = real_abs(x[k]);
    /* Rates per second of slow plants squared would be too small for a float. */
    for (size_t k = 0; k < n && most > REAL_C(0.0); k++)
        sum += (x[k] / most) * (x[k] / most);
    return most * real_sqrt(sum);
}

/* Largest cosine of the angles between a row and the columns of B. */
static real_t largest_cosine(const struct matrix *b, const real_t *row, const real_t *moved)
{
    real_t largest = REAL_C(0.0), size = norm_of(row, b->rows);
    for (size_t j = 0; j < b->cols; j++) {
        real_t column[STATE_MODEL_STATES] = {REAL_C(0.0)};
        for (size_t k = 0; k < b->rows; k++)
            column[k] = b->value[k][j];
        real_t both = size * norm_of(column, b->rows);
        if (both > REAL_C(0.0) && real_abs(moved[j]) / both > largest)
            largest = real_abs(moved[j]) / both;
    }
    return largest;
}

static enum err keep_row(struct matrix *chain, const real_t *row, size_t loop,
                         struct state_decoupler_refusal *reason)
{
    REFLUX_ASSERT(chain->rows <= chain->cols && chain->cols <= MATRIX_MAX);
    real_t size = norm_of(row, chain->cols);
    if (!(size > REAL_C(0.0)))
        return refuse_state(reason, ERR_SINGULAR, "output", "moved by an input", loop);
    if (chain->rows == chain->cols)
        return refuse_state(reason, ERR_SINGULAR, "output",
                            "moved by an input, by other states than the outputs before", loop);
    for (size_t k = 0; k < chain->cols; k++)
        chain->value[chain->rows][k] = row[k] / size;
    chain->rows++;
    return ERR_OK;
}

/* Index of output i, its rows of A* and B*, and in f the sum of m_k C A^k. */
static enum err find_index(const struct state_model *model,
                           const struct state_decoupler_config *config, size_t i,
                           struct state_decoupler_work *work, struct state_decoupler *d,
                           struct state_decoupler_refusal *reason)
{
    REFLUX_ASSERT(i < STATE_LOOPS);
    size_t n = d->states;
    real_t row[STATE_MODEL_STATES], next[STATE_MODEL_STATES];
    output_row(&model->c, i, row);
    for (size_t j = 0; j < STATE_POLES; j++) {
        enum err err = keep_row(&work->chain, row, i, reason);
        if (err)
            return err;
        multiply_row(row, &model->b, d->b_star.value[i]);
        multiply_row(row, &model->a, next);
        real_t cosine = largest_cosine(&model->b, row, d->b_star.value[i]);
        if (cosine > config->row_lo) {
            d->index[i] = (uint8_t)j;
            for (size_t k = 0; k < n; k++)
                d->a_star.value[i][k] = next[k];
            return ERR_OK;
        }
        if (cosine > d->neglected)
            d->neglected = cosine;
        for (size_t k = 0; k < n; k++)
            row[k] = next[k];
    }
    return refuse_state(reason, ERR_RANGE, "index", "0 to 3: an input that moves the output sooner",
                        i);
}

static enum err judge_b_star(const struct state_decoupler_config *config,
                             struct state_decoupler_work *work, struct state_decoupler *d,
                             struct state_decoupler_refusal *reason)
{
    real_t r[MATRIX_MAX], c[MATRIX_MAX];
    matrix_equilibrate(&d->b_star, true, r, c);
    work->invariant = d->b_star;
    for (size_t i = 0; i < d->loops; i++)
        for (size_t j = 0; j < d->loops; j++)
            work->invariant.value[i][j] *= r[i] * c[j];
    enum err err = svd_decompose(&work->at.svd, &work->invariant);
    if (err)
        return err;
    d->condition = svd_condition(&work->at.svd);
    if (!(d->condition <= config->condition_hi))
        return refuse_state(reason, ERR_SINGULAR, "b_star",
                            "regular: inputs that move the outputs in ways of their own",
                            STATE_LOOP_NONE);
    err = lu_factor(&d->b_star, &work->lu);
    if (err)
        return refuse_state(reason, err, "b_star", "regular", STATE_LOOP_NONE);
    return ERR_OK;
}

/* to, loops x cols, <- B*^-1 to, column by column. */
static void solve_columns(const struct lu *lu, size_t loops, struct matrix *to)
{
    REFLUX_ASSERT(loops <= MATRIX_MAX);
    for (size_t j = 0; j < to->cols; j++) {
        real_t column[MATRIX_MAX];
        for (size_t i = 0; i < loops; i++)
            column[i] = to->value[i][j];
        lu_solve(lu, column, column);
        for (size_t i = 0; i < loops; i++)
            to->value[i][j] = column[i];
    }
}

/* m_ik from the product of (s - pole), and kappa. */
static enum err assign_poles(const struct state_decoupler_goal *goal, bool in_z, size_t i,
                             struct state_decoupler *d, struct state_decoupler_refusal *reason)
{
    REFLUX_ASSERT(i < STATE_LOOPS && d->index[i] < STATE_POLES);
    unsigned count = d->index[i] + 1u;
    /* Coefficients of s^0, s^1 and so on; size: those of the magnitudes, by which rounding is judged. */
    struct cplx c[STATE_POLES + 1] = {{REAL_C(1.0), REAL_C(0.0)}};
    struct cplx at_one = {REAL_C(1.0), REAL_C(0.0)};
    real_t size[STATE_POLES + 1] = {REAL_C(1.0)};
    for (unsigned p = 0; p < count; p++) {
        struct cplx pole = goal->pole[i][p];
        if (!real_within(pole.re, REAL_C(-1e6), REAL_C(1e6)) ||
            !real_within(pole.im, REAL_C(-1e6), REAL_C(1e6)))
            return refuse_state(reason, ERR_NOT_FINITE, "pole", "a number, to 1e6", i);
        if (in_z ? !(cplx_abs(pole) < REAL_C(1.0)) : !(pole.re < REAL_C(0.0)))
            return refuse_state(
                reason, ERR_RANGE, "pole",
                in_z ? "stable: a magnitude below 1" : "stable: a real part below 0", i);
        c[p + 1] = c[p];
        size[p + 1] = size[p];
        for (unsigned k = p + 1u; k-- > 0;) {
            struct cplx below = k ? c[k - 1] : cplx(REAL_C(0.0), REAL_C(0.0));
            size[k] = (k ? size[k - 1] : REAL_C(0.0)) + cplx_abs(pole) * size[k];
            c[k] = cplx_sub(below, cplx_mul(pole, c[k]));
        }
        at_one = cplx_mul(at_one, cplx_sub(cplx(REAL_C(1.0), REAL_C(0.0)), pole));
    }
    for (unsigned k = 0; k < count; k++) {
        if (!(real_abs(c[k].im) <= PAIR_ERROR * size[k]))
            return refuse_state(reason, ERR_RANGE, "pole", "real, or in conjugate pairs", i);
        d->m[i][k] = -c[k].re;
    }
    d->k_star[i] = in_z ? at_one.re : c[0].re;
    return ERR_OK;
}

/* F = B*^-1 (sum of M_k C A^k - A*), G = B*^-1 K*, and -B*^-1 A*. */
static void find_gains(const struct state_model *model, struct state_decoupler_work *work,
                       struct state_decoupler *d)
{
    size_t n = d->states, loops = d->loops;
    d->f.rows = d->g.rows = work->invariant.rows = (uint8_t)loops;
    d->f.cols = work->invariant.cols = (uint8_t)n;
    d->g.cols = (uint8_t)loops;
    for (size_t i = 0; i < loops; i++) {
        real_t row[STATE_MODEL_STATES], next[STATE_MODEL_STATES];
        output_row(&model->c, i, row);
        for (size_t k = 0; k < n; k++) {
            d->f.value[i][k] = work->invariant.value[i][k] = -d->a_star.value[i][k];
        }
        for (size_t j = 0; j <= d->index[i]; j++) {
            multiply_row(row, &model->a, next);
            for (size_t k = 0; k < n; k++) {
                d->f.value[i][k] += d->m[i][j] * row[k];
                row[k] = next[k];
            }
        }
        for (size_t j = 0; j < loops; j++)
            d->g.value[i][j] = i == j ? d->k_star[i] : REAL_C(0.0);
    }
    solve_columns(&work->lu, loops, &d->f);
    solve_columns(&work->lu, loops, &d->g);
    solve_columns(&work->lu, loops, &work->invariant);
}

static enum err find_feedforward(const struct state_model *model, enum state_feedforward form,
                                 struct state_decoupler_work *work, struct state_decoupler *d)
{
    size_t loops = d->loops, n = d->states;
    d->tf.rows = (uint8_t)loops;
    d->tf.cols = form == STATE_FEEDFORWARD_NONE ? 0u : model->e.cols;
    d->disturbances = d->tf.cols;
    if (!d->tf.cols)
        return ERR_OK;
    if (form == STATE_FEEDFORWARD_OUTPUTS) {
        for (size_t i = 0; i < loops; i++) {
            real_t row[STATE_MODEL_STATES], next[STATE_MODEL_STATES] = {REAL_C(0.0)};
            output_row(&model->c, i, row);
            for (size_t j = 0; j < d->index[i]; j++) {
                multiply_row(row, &model->a, next);
                for (size_t k = 0; k < n; k++)
                    row[k] = next[k];
            }
            multiply_row(row, &model->e, next);
            for (size_t j = 0; j < d->tf.cols; j++)
                d->tf.value[i][j] = -next[j];
        }
        solve_columns(&work->lu, loops, &d->tf);
        return ERR_OK;
    }
    struct matrix *inverse = &work->sampled.a; /* free until the loop is judged */
    enum err err = matrix_pseudo_inverse(&model->b, &work->at.pseudo_inverse, inverse);
    if (!err)
        err = matrix_multiply(inverse, &model->e, &d->tf);
    for (size_t i = 0; i < loops && !err; i++)
        for (size_t j = 0; j < d->tf.cols; j++)
            d->tf.value[i][j] = -d->tf.value[i][j];
    return err;
}

static void count_needed(const struct state_decoupler_config *config, struct state_decoupler *d)
{
    d->needed = 0;
    d->needed_count = 0;
    for (size_t i = 0; i < d->loops; i++) {
        real_t largest = REAL_C(0.0);
        for (size_t k = 0; k < d->states; k++)
            if (real_abs(d->f.value[i][k]) > largest)
                largest = real_abs(d->f.value[i][k]);
        for (size_t k = 0; k < d->states; k++)
            if (real_abs(d->f.value[i][k]) > config->weight_lo * largest)
                d->needed |= (uint16_t)(1u << k);
    }
    for (size_t k = 0; k < d->states; k++)
        d->needed_count = (uint8_t)(d->needed_count + (((unsigned)d->needed >> k) & 1u));
}

/* Routh: all roots of c[0] + c[1] s + ... + s^n have real parts below 0. */
static bool left_of_zero(const real_t *c, size_t n)
{
    REFLUX_ASSERT(n <= STATE_POLES + 1u);
    real_t above[STATE_POLES + 3] = {REAL_C(0.0)}, row[STATE_POLES + 3] = {REAL_C(0.0)};
    for (size_t k = 0; 2 * k <= n; k++)
        above[k] = c[n - 2 * k];
    for (size_t k = 0; 2 * k + 1 <= n; k++)
        row[k] = c[n - 1 - 2 * k];
    for (size_t step = 0; step < n; step++) {
        if (!(row[0] > REAL_C(0.0)))
            return false;
        real_t by = above[0] / row[0];
        for (size_t k = 0; k + 1 < STATE_POLES + 3; k++) {
            real_t next = above[k + 1] - by * row[k + 1];
            above[k] = row[k];
            row[k] = next;
        }
    }
    return true;
}

/* With its integral and derivative each loop is s^(d+2) - sum of m_k s^(k+1) + kappa T_D s^2 + kappa/T_I. */
static enum err judge_modes_of_loops(const struct state_decoupler *d,
                                     struct state_decoupler_refusal *reason)
{
    for (size_t i = 0; i < d->loops; i++) {
        real_t c[STATE_POLES + 2] = {REAL_C(0.0)};
        size_t degree = d->index[i] + 1u, up = d->integral_s[i] > REAL_C(0.0) ? 1u : 0u;
        for (size_t k = 0; k < degree; k++)
            c[k + up] = -d->m[i][k];
        c[degree + up] = REAL_C(1.0);
        c[1 + up] += d->k_star[i] * d->derivative_s[i];
        if (up)
            c[0] = d->k_star[i] / d->integral_s[i];
        if (!left_of_zero(c, degree + up))
            return refuse_state(reason, ERR_RANGE, "integral_s",
                                "longer: with it the loop's poles are not stable", i);
    }
    return ERR_OK;
}

static enum err judge_samples(const struct state_model *model, real_t hold_s,
                              struct state_decoupler_work *work, struct state_decoupler *d,
                              struct state_decoupler_refusal *reason)
{
    bool in_z = model->period_s > REAL_C(0.0);
    if (!in_z && !(hold_s > REAL_C(0.0)))
        return ERR_OK;
    if (!in_z) {
        enum err err = state_model_sample(model, hold_s, &work->at.sampling, &work->sampled);
        if (err)
            return refuse_state(reason, err, "hold_s", "shorter", STATE_LOOP_NONE);
    }
    const struct state_law law = {&d->f, &d->g, d->integral_s, d->derivative_s};
    enum err err =
        state_loop_radius(in_z ? model : &work->sampled, &law, &work->at.zeros, &d->radius);
    if (err == ERR_FULL)
        return refuse_state(reason, err, "states",
                            "at most 16, with a place for each integral and each derivative",
                            STATE_LOOP_NONE);
    if (err)
        return refuse_state(reason, err, "states", "of a loop whose modes can be computed",
                            STATE_LOOP_NONE);
    if (!(d->radius < REAL_C(1.0)))
        return refuse_state(reason, ERR_RANGE, in_z ? "integral_s" : "hold_s",
                            in_z ? "longer: with it the loop is not stable"
                                 : "shorter, or slower poles: sampled the loop is not stable",
                            STATE_LOOP_NONE);
    return ERR_OK;
}

static enum err judge_zeros(const struct state_model *model, struct state_decoupler_work *work,
                            struct state_decoupler *d, struct state_decoupler_refusal *reason)
{
    enum err err =
        state_zeros_find(model, &work->chain, &work->invariant, &work->at.zeros, &d->zeros);
    if (err)
        return refuse_state(reason, err, "zeros", "found", STATE_LOOP_NONE);
    real_t limit = model->period_s > REAL_C(0.0) ? REAL_C(1.0) : REAL_C(0.0);
    if (d->zeros.n && !(d->zeros.outermost + d->zeros.error < limit))
        return refuse_state(reason, ERR_RANGE, "zero",
                            "stable: the loop would hide a mode that grows", STATE_LOOP_NONE);
    return ERR_OK;
}

/* Everything but zeros and what the loop becomes. */
static enum err find_law(const struct state_model *model,
                         const struct state_decoupler_config *config,
                         const struct state_decoupler_goal *goal, struct state_decoupler_work *work,
                         struct state_decoupler *d, struct state_decoupler_refusal *reason)
{
    *d = (struct state_decoupler){0};
    enum err err = state_model_check(model, &reason->field, &reason->wanted);
    if (!err)
        err = check_state_config(config, reason);
    if (err)
        return err;
    if (model->c.rows != model->b.cols)
        return refuse_state(reason, ERR_RANGE, "outputs", "as many as inputs", STATE_LOOP_NONE);
    size_t loops = d->loops = model->b.cols, n = d->states = model->a.rows;
    bool in_z = model->period_s > REAL_C(0.0);
    err = check_goal(goal, loops, reason);
    if (err)
        return err;
    d->a_star.rows = d->b_star.rows = d->b_star.cols = (uint8_t)loops;
    d->a_star.cols = work->chain.cols = (uint8_t)n;
    work->chain.rows = 0;
    for (size_t i = 0; i < loops && !err; i++) {
        d->integral_s[i] = goal->integral_s[i];
        d->derivative_s[i] = goal->derivative_s[i];
        err = find_index(model, config, i, work, d, reason);
    }
    if (!err)
        err = judge_b_star(config, work, d, reason);
    for (size_t i = 0; i < loops && !err; i++)
        err = assign_poles(goal, in_z, i, d, reason);
    if (err)
        return err;
    find_gains(model, work, d);
    err = find_feedforward(model, goal->feedforward, work, d);
    if (err)
        return refuse_state(reason, err, "b", "of full rank", STATE_LOOP_NONE);
    count_needed(config, d);
    return ERR_OK;
}

static enum err judge_loop(const struct state_model *model, const struct state_decoupler_goal *goal,
                           struct state_decoupler_work *work, struct state_decoupler *d,
                           struct state_decoupler_refusal *reason)
{
    enum err err = model->period_s > REAL_C(0.0) ? ERR_OK : judge_modes_of_loops(d, reason);
    if (!err)
        err = judge_samples(model, goal->hold_s, work, d, reason);
    if (!err)
        *reason = (struct state_decoupler_refusal){"", "", STATE_LOOP_NONE};
    return err;
}

void state_decoupler_begin(struct state_decoupler_work *work)
{
    work->part = 0;
}

enum err state_decoupler_part(const struct state_model *model,
                              const struct state_decoupler_config *config,
                              const struct state_decoupler_goal *goal,
                              struct state_decoupler_work *work, struct state_decoupler *d,
                              struct state_decoupler_refusal *reason)
{
    enum err err;
    /* Whatever returns an error without a reason of its own leaves this one. */
    *reason =
        (struct state_decoupler_refusal){"model", "one that can be designed for", STATE_LOOP_NONE};
    switch (work->part++) {
    case 0:
        err = find_law(model, config, goal, work, d, reason);
        return err ? err : ERR_BUSY;
    case 1:
        err = judge_zeros(model, work, d, reason);
        return err ? err : ERR_BUSY;
    default:
        return judge_loop(model, goal, work, d, reason);
    }
}

enum err state_decoupler_design(const struct state_model *model,
                                const struct state_decoupler_config *config,
                                const struct state_decoupler_goal *goal,
                                struct state_decoupler_work *work, struct state_decoupler *d,
                                struct state_decoupler_refusal *reason)
{
    struct state_decoupler_refusal unused;
    enum err err;
    state_decoupler_begin(work);
    do {
        err = state_decoupler_part(model, config, goal, work, d, reason ? reason : &unused);
    } while (err == ERR_BUSY);
    return err;
}

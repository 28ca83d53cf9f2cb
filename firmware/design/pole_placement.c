#include "design/pole_placement.h"

#include <stddef.h>

#include "base/assertion.h"
#include "num/real_trig.h"

#define PI_REAL     REAL_C(3.141592653589793)
#define LN_50       REAL_C(3.912023005428146)
#define SAMPLES     512 /* of a step response: its peak comes before */
#define HALVINGS    40
#define FREQUENCIES 128
#define ROUNDING    REAL_C(0.001) /* of an overshoot that is to be 0 */

void pole_placement_goal_default(struct pole_placement_goal *goal)
{
    *goal = (struct pole_placement_goal){.overshoot = REAL_C(0.1),
                                         .settling_s = REAL_C(0.0),
                                         .observer = REAL_C(0.0),
                                         .condition_hi = REAL_C(1e4)};
}

static enum err refuse_placement(struct pole_placement_refusal *reason, enum err code,
                                 const char *field, const char *wanted)
{
    *reason = (struct pole_placement_refusal){field, wanted};
    return code;
}

static enum err check_placement(const struct polynomial *a, const struct polynomial *b,
                                real_t period_s, const struct pole_placement_goal *goal,
                                struct pole_placement_refusal *reason)
{
    const struct {
        const char *field, *wanted;
        bool fine;
    } rule[] = {
        {"period_s", "above 0, to 1e6 s", real_within(period_s, REAL_C(1e-6), REAL_C(1e6))},
        {"overshoot", "0 to 0.5", real_within(goal->overshoot, REAL_C(0.0), REAL_C(0.5))},
        {"settling_s", "2 to 200 periods",
         real_within(goal->settling_s, REAL_C(2.0) * period_s, REAL_C(200.0) * period_s)},
        {"observer", "0 to 0.95", real_within(goal->observer, REAL_C(0.0), REAL_C(0.95))},
        {"condition_hi", "10 to 1e6", real_within(goal->condition_hi, REAL_C(10.0), REAL_C(1e6))},
        {"a", "a polynomial that begins with 1",
         polynomial_check(a) == ERR_OK && a->n > 0 && a->value[0] == REAL_C(1.0)},
        {"b", "a polynomial that begins with 0",
         polynomial_check(b) == ERR_OK && b->n > 1 && b->value[0] == REAL_C(0.0)},
    };
    for (size_t k = 0; k < sizeof rule / sizeof rule[0]; k++)
        if (!rule[k].fine)
            return refuse_placement(reason, ERR_RANGE, rule[k].field, rule[k].wanted);
    return ERR_OK;
}

/* ---- what is asked for ---- */

struct pair_of_poles {
    real_t m1, m2; /* M = 1 + m1 z^-1 + m2 z^-2 */
};

static struct pair_of_poles poles_at(real_t radius, real_t angle)
{
    real_t sine, cosine;
    real_sincos(angle, &sine, &cosine);
    return (struct pair_of_poles){REAL_C(-2.0) * radius * cosine, radius * radius};
}

/* Largest value, or magnitude, of F M(1)/(at_rest M) on a step of 1 from rest. */
static real_t step_peak(const struct polynomial *f, real_t at_rest, struct pair_of_poles m,
                        bool magnitude)
{
    real_t gain = (REAL_C(1.0) + m.m1 + m.m2) / at_rest, sum = REAL_C(0.0), y1 = REAL_C(0.0),
           y2 = REAL_C(0.0), peak = REAL_C(0.0);
    for (unsigned t = 0; t < SAMPLES; t++) {
        if (t < f->n)
            sum += f->value[t];
        real_t y = gain * sum - m.m1 * y1 - m.m2 * y2;
        real_t size = magnitude ? real_abs(y) : y;
        peak = size > peak ? size : peak;
        y2 = y1;
        y1 = y;
    }
    return peak;
}

static enum err find_angle(const struct polynomial *b, const struct pole_placement_goal *goal,
                           struct pole_placement *result, struct pole_placement_refusal *reason)
{
    real_t rest = polynomial_value(b, REAL_C(1.0)), lo = REAL_C(0.0), hi = PI_REAL;
    real_t wanted = REAL_C(1.0) + goal->overshoot;
    real_t least = step_peak(b, rest, poles_at(result->radius, lo), false);
    if (!(least <= (goal->overshoot > ROUNDING ? wanted : wanted + ROUNDING)))
        return refuse_placement(reason, ERR_RANGE, "overshoot",
                                "larger: the zeros of B make more of any pair of poles");
    if (goal->overshoot > ROUNDING) {
        if (!(step_peak(b, rest, poles_at(result->radius, hi), false) >= wanted))
            return refuse_placement(reason, ERR_RANGE, "overshoot",
                                    "smaller, or a longer settling time");
        for (unsigned k = 0; k < HALVINGS; k++) {
            real_t half = REAL_C(0.5) * (lo + hi);
            if (step_peak(b, rest, poles_at(result->radius, half), false) < wanted)
                lo = half;
            else
                hi = half;
        }
    }
    result->angle = lo;
    result->overshoot = step_peak(b, rest, poles_at(result->radius, lo), false) - REAL_C(1.0);
    return ERR_OK;
}

/* O, of as many factors as A has poles and the equations have room for. */
static void take_observer(const struct pole_placement_goal *goal, unsigned order,
                          struct polynomial *o)
{
    const real_t one = REAL_C(1.0);
    polynomial_set(o, &one, 1);
    for (unsigned k = 0; k < order && goal->observer > REAL_C(0.0); k++) {
        REFLUX_ASSERT(o->n < POLYNOMIAL_MOST);
        o->value[o->n] = REAL_C(0.0);
        for (unsigned i = o->n; i > 0; i--)
            o->value[i] -= goal->observer * o->value[i - 1];
        o->n++;
    }
}

/* ---- the equations ---- */

static real_t coefficient_of(const struct polynomial *p, unsigned k)
{
    return k < p->n ? p->value[k] : REAL_C(0.0);
}

/* Row k is of z^-(k + 1); unknown are p[1] to p[nb - 1], then q[0] to q[na]. */
static void set_equations(const struct polynomial *ak, const struct polynomial *b, struct matrix *m)
{
    unsigned na = ak->n - 2u, nb = b->n - 1u;
    m->rows = m->cols = (uint8_t)(na + nb);
    for (unsigned row = 0; row < m->rows; row++)
        for (unsigned col = 0; col < m->cols; col++) {
            unsigned power = row + 1;
            unsigned less = col + 1 < nb ? col + 1 : col + 1 - nb;
            m->value[row][col] =
                power < less ? REAL_C(0.0) : coefficient_of(col + 1 < nb ? ak : b, power - less);
        }
}

/* Condition number with rows and columns brought to about one norm, by which the solution is then found. */
static enum err solve_equations(struct pole_placement_work *w, real_t *x, real_t *condition)
{
    real_t row[MATRIX_MAX], col[MATRIX_MAX];
    const struct matrix *m = &w->equations;
    matrix_equilibrate(m, false, row, col);
    w->scaled.rows = w->scaled.cols = m->rows;
    for (unsigned i = 0; i < m->rows; i++)
        for (unsigned j = 0; j < m->cols; j++)
            w->scaled.value[i][j] = row[i] * m->value[i][j] * col[j];
    enum err err = svd_decompose(&w->svd, &w->scaled);
    if (err)
        return err;
    *condition = svd_condition(&w->svd);
    err = lu_factor(&w->scaled, &w->lu);
    if (err)
        return err;
    for (unsigned i = 0; i < m->rows; i++)
        x[i] *= row[i];
    lu_solve(&w->lu, x, x);
    for (unsigned j = 0; j < m->cols; j++)
        x[j] *= col[j];
    return ERR_OK;
}

static enum err find_residual(const struct polynomial *ak, const struct polynomial *b,
                              struct pole_placement *result)
{
    struct polynomial left = {0};
    enum err err = polynomial_add_product(&left, REAL_C(1.0), ak, &result->p);
    if (!err)
        err = polynomial_add_product(&left, REAL_C(1.0), b, &result->q);
    result->residual = REAL_C(0.0);
    for (unsigned k = 0; k < POLYNOMIAL_MOST && !err; k++) {
        real_t away = real_abs(coefficient_of(&left, k) - coefficient_of(&result->poles, k));
        result->residual = away > result->residual ? away : result->residual;
    }
    return err;
}

static struct cplx on_circle(const struct polynomial *p, struct cplx z_inverse)
{
    struct cplx value = cplx(REAL_C(0.0), REAL_C(0.0));
    for (unsigned k = p->n; k-- > 0;) {
        value = cplx_mul(value, z_inverse);
        value.re += p->value[k];
    }
    return value;
}

static void find_sensitivity(const struct polynomial *ak, struct pole_placement *result)
{
    result->sensitivity = REAL_C(0.0);
    for (unsigned k = 1; k <= FREQUENCIES; k++) {
        real_t sine, cosine;
        real_sincos(PI_REAL * (real_t)k / (real_t)FREQUENCIES, &sine, &cosine);
        struct cplx z_inverse = cplx(cosine, -sine);
        real_t size = cplx_abs(on_circle(ak, z_inverse)) *
                      cplx_abs(on_circle(&result->p, z_inverse)) /
                      cplx_abs(on_circle(&result->poles, z_inverse));
        result->sensitivity = size > result->sensitivity ? size : result->sensitivity;
    }
}

static enum err place_poles(const struct polynomial *ak, const struct polynomial *b,
                            const struct pole_placement_goal *goal,
                            struct pole_placement_work *work, struct pole_placement *result,
                            struct pole_placement_refusal *reason)
{
    unsigned na = ak->n - 2u, nb = b->n - 1u, n = na + nb;
    real_t x[MATRIX_MAX] = {REAL_C(0.0)};
    set_equations(ak, b, &work->equations);
    for (unsigned k = 0; k < n; k++)
        x[k] = coefficient_of(&result->poles, k + 1) - coefficient_of(ak, k + 1);
    enum err err = solve_equations(work, x, &result->condition);
    if (err || !(result->condition <= goal->condition_hi))
        return refuse_placement(reason, ERR_SINGULAR, "a", "without a zero that b has, or nearly");
    result->p.n = (uint8_t)nb;
    result->p.value[0] = REAL_C(1.0);
    for (unsigned k = 1; k < nb; k++)
        result->p.value[k] = x[k - 1];
    polynomial_set(&result->q, &x[nb - 1], na + 1);
    return ERR_OK;
}

enum err pole_placement_design(const struct polynomial *a, const struct polynomial *b,
                               real_t period_s, const struct pole_placement_goal *goal,
                               struct pole_placement_work *work, struct pole_placement *result,
                               struct pole_placement_refusal *reason)
{
    struct pole_placement_refusal unused;
    reason = reason ? reason : &unused;
    enum err err = check_placement(a, b, period_s, goal, reason);
    if (err)
        return err;
    /* Whatever returns an error without a reason of its own leaves this one. */
    *reason = (struct pole_placement_refusal){"model", "one that can be designed for"};
    struct polynomial den = *a, num = *b, ak = {0};
    const struct polynomial k = {.n = 2, .value = {REAL_C(1.0), REAL_C(-1.0)}};
    *result = (struct pole_placement){0};
    polynomial_trim(&den);
    polynomial_trim(&num);
    if (num.n < 2 ||
        !(real_abs(polynomial_value(&num, REAL_C(1.0))) > REAL_C(1e-4) * polynomial_size(&num)))
        return refuse_placement(reason, ERR_SINGULAR, "b", "not 0 at rest");
    if (den.n - 1u + num.n - 1u > POLE_PLACEMENT_MOST)
        return refuse_placement(reason, ERR_FULL, "b",
                                "of a degree that with that of a is 16 at most");
    err = polynomial_add_product(&ak, REAL_C(1.0), &den, &k);
    if (err)
        return err;

    result->radius = real_exp(-LN_50 * period_s / goal->settling_s);
    err = find_angle(&num, goal, result, reason);
    if (err)
        return err;
    struct pair_of_poles m = poles_at(result->radius, result->angle);
    const struct polynomial pair = {.n = 3, .value = {REAL_C(1.0), m.m1, m.m2}};
    unsigned order = den.n - 1u, room = den.n - 1u + num.n - 1u;
    if (room < 2)
        return refuse_placement(reason, ERR_RANGE, "a",
                                "a pole, or b a delay: two poles are placed");
    take_observer(goal, order + 2 <= room ? order : room - 2, &result->r);
    err = polynomial_add_product(&result->poles, REAL_C(1.0), &pair, &result->r);
    if (!err)
        err = place_poles(&ak, &num, goal, work, result, reason);
    if (err)
        return err;
    /* M(1)/B(1), but from Q as it came out: no rounding of the equations is an offset. */
    real_t factor =
        polynomial_value(&result->q, REAL_C(1.0)) / polynomial_value(&result->r, REAL_C(1.0));
    for (unsigned i = 0; i < result->r.n; i++)
        result->r.value[i] *= factor;
    *reason = (struct pole_placement_refusal){"", ""};
    return ERR_OK;
}

enum err pole_placement_judge(const struct polynomial *a, const struct polynomial *b,
                              struct pole_placement *result)
{
    struct polynomial den = *a, num = *b, ak = {0};
    const struct polynomial k = {.n = 2, .value = {REAL_C(1.0), REAL_C(-1.0)}};
    polynomial_trim(&den);
    polynomial_trim(&num);
    enum err err = polynomial_add_product(&ak, REAL_C(1.0), &den, &k);
    if (!err)
        err = find_residual(&ak, &num, result);
    if (err)
        return err;
    find_sensitivity(&ak, result);
    result->input_peak = step_peak(&den, polynomial_value(&num, REAL_C(1.0)),
                                   poles_at(result->radius, result->angle), true);
    return ERR_OK;
}

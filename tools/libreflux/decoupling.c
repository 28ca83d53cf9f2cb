#include "decoupling.h"

#include <stdio.h>
#include <string.h>

#include "design/decoupler_shapes.h"
#include "design/pole_placement.h"
#include "design/polynomial_decoupler.h"
#include "libreflux.h"
#include "sampled.h"

static void say(char *reason, const char *field, const char *wanted, uint8_t output, uint8_t input)
{
    if (!reason || !field[0])
        return;
    int at = snprintf(reason, REFLUX_WHY_BYTES, "%s: %s", field, wanted);
    if (output != DECOUPLED_NONE && at > 0 && at < REFLUX_WHY_BYTES)
        (void)snprintf(reason + at, (size_t)(REFLUX_WHY_BYTES - at), " (output %u, input %u)",
                       output + 1u, input + 1u);
}

static int32_t give_polynomial(const struct polynomial *from, double *to)
{
    for (unsigned k = 0; k < REFLUX_POLYNOMIAL; k++)
        to[k] = k < from->n ? from->value[k] : 0.0;
    return from->n;
}

void reflux_polynomial_decoupler_defaults(double *settings)
{
    struct polynomial_decoupler_config c;
    polynomial_decoupler_config_default(&c);
    const double all[4] = {c.element_hi, c.determinant_lo, c.zero_hi, c.recursion_hi};
    memcpy(settings, all, sizeof all);
}

int32_t reflux_polynomial_decoupler(const struct reflux_sampled *model, const double *settings,
                                    double *g, int32_t *taps, double *h, int32_t *h_taps,
                                    int32_t *n_zeros, double *zeros, double *radius,
                                    double *numbers, char *reason)
{
    _Static_assert(REFLUX_POLYNOMIAL == POLYNOMIAL_MOST, "room for a polynomial");
    struct difference_model m;
    struct polynomial_decoupler_work work;
    struct polynomial_decoupler result;
    struct polynomial_decoupler_refusal why;
    const struct polynomial_decoupler_config config = {settings[0], settings[1], settings[2],
                                                       settings[3]};
    *n_zeros = 0;
    if (take_sampled(model, &m)) {
        say(reason, "model", "1 to 4 outputs and inputs, na 0 to 4, nb 1 to 8", DECOUPLED_NONE,
            DECOUPLED_NONE);
        return ERR_RANGE;
    }
    result = (struct polynomial_decoupler){0};
    enum err err = polynomial_decoupler_check(&m, &config, &why);
    if (!err)
        err = polynomial_decoupler_design(&m, &config, &work, &result, &why);
    enum err unknown = polynomial_decoupler_zeros(&result);
    if (!err && unknown) {
        say(reason, "zeros", "found", DECOUPLED_NONE, DECOUPLED_NONE);
        return unknown;
    }
    *n_zeros = unknown ? 0 : result.zeros.n;
    for (size_t k = 0; k < (size_t)*n_zeros; k++) {
        zeros[2 * k] = result.zeros.value[k].re;
        zeros[2 * k + 1] = result.zeros.value[k].im;
        radius[k] = result.zeros.radius[k];
    }
    numbers[0] = result.outermost;
    numbers[1] = result.recursive;
    numbers[2] = result.delay;
    if (err) {
        say(reason, why.field, why.wanted, why.output, why.input);
        return err;
    }
    size_t n = m.outputs;
    for (size_t i = 0; i < n; i++) {
        h_taps[i] = give_polynomial(&result.h[i], h + i * REFLUX_POLYNOMIAL);
        for (size_t j = 0; j < n; j++)
            taps[i * n + j] =
                give_polynomial(&result.g.value[i][j], g + (i * n + j) * REFLUX_POLYNOMIAL);
    }
    return ERR_OK;
}

void reflux_pole_placement_defaults(double *goal)
{
    struct pole_placement_goal c;
    pole_placement_goal_default(&c);
    const double all[4] = {c.overshoot, c.settling_s, c.observer, c.condition_hi};
    memcpy(goal, all, sizeof all);
}

int32_t reflux_pole_placement(int32_t na, const double *a, int32_t nb, const double *b,
                              double period_s, const double *goal, double *p, double *q, double *r,
                              double *poles, int32_t *counts, double *numbers, char *reason)
{
    struct pole_placement_work work;
    struct pole_placement result;
    struct pole_placement_refusal why;
    struct polynomial den, num;
    const struct pole_placement_goal wanted = {goal[0], goal[1], goal[2], goal[3]};
    if (na < 1 || na > REFLUX_POLYNOMIAL || nb < 1 || nb > REFLUX_POLYNOMIAL) {
        say(reason, na < 1 || na > REFLUX_POLYNOMIAL ? "a" : "b", "1 to 32 coefficients",
            DECOUPLED_NONE, DECOUPLED_NONE);
        return ERR_RANGE;
    }
    polynomial_set(&den, a, (unsigned)na);
    polynomial_set(&num, b, (unsigned)nb);
    enum err err = pole_placement_design(&den, &num, period_s, &wanted, &work, &result, &why);
    if (!err)
        err = pole_placement_judge(&den, &num, &result);
    if (err) {
        say(reason, why.field, why.wanted, DECOUPLED_NONE, DECOUPLED_NONE);
        return err;
    }
    counts[0] = give_polynomial(&result.p, p);
    counts[1] = give_polynomial(&result.q, q);
    counts[2] = give_polynomial(&result.r, r);
    counts[3] = give_polynomial(&result.poles, poles);
    const double all[7] = {result.radius,    result.angle,      result.condition,  result.residual,
                           result.overshoot, result.input_peak, result.sensitivity};
    memcpy(numbers, all, sizeof all);
    return ERR_OK;
}

/* ---- static ones ---- */

static enum err take_gains(int32_t n, const double *from, struct matrix *to)
{
    if (n < 1 || n > DECOUPLER_SHAPE_LOOPS)
        return ERR_RANGE;
    to->rows = to->cols = (uint8_t)n;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            to->value[i][j] = from[i * n + j];
    return ERR_OK;
}

static void give_shape(size_t n, const struct decoupler_shape *shape, double *d, double *gain,
                       double *left)
{
    for (size_t i = 0; i < n; i++) {
        gain[i] = shape->gain[i];
        left[i] = shape->left[i];
        for (size_t j = 0; j < n; j++)
            d[i * n + j] = shape->d.value[i][j];
    }
}

int32_t reflux_decoupler_partial(int32_t n, const double *gains, const double *factor, double *d,
                                 double *gain, double *left)
{
    struct matrix k;
    struct decoupler_shape_work work;
    struct decoupler_shape shape;
    real_t part[DECOUPLER_SHAPE_LOOPS][DECOUPLER_SHAPE_LOOPS] = {{0}};
    enum err err = take_gains(n, gains, &k);
    if (err)
        return err;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            part[i][j] = factor[i * n + j];
    err = decoupler_partial(&k, part, &work, &shape);
    if (!err)
        give_shape((size_t)n, &shape, d, gain, left);
    return err;
}

int32_t reflux_decoupler_one_way(int32_t n, const double *gains, const int32_t *rank, double *d,
                                 double *gain, double *left)
{
    struct matrix k;
    struct decoupler_shape_work work;
    struct decoupler_shape shape;
    uint8_t order[DECOUPLER_SHAPE_LOOPS];
    enum err err = take_gains(n, gains, &k);
    if (err)
        return err;
    for (int i = 0; i < n; i++)
        order[i] = rank[i] < 0 || rank[i] >= n ? UINT8_MAX : (uint8_t)rank[i];
    err = decoupler_one_way(&k, order, &work, &shape);
    if (!err)
        give_shape((size_t)n, &shape, d, gain, left);
    return err;
}

int32_t reflux_decoupler_by_directions(int32_t n, const double *gains, double condition_hi,
                                       double *d, double *gain, double *left, int32_t *limited)
{
    struct matrix k;
    struct decoupler_shape_work work;
    struct decoupler_shape shape;
    uint8_t weak = 0;
    enum err err = take_gains(n, gains, &k);
    if (!err)
        err = decoupler_by_directions(&k, condition_hi, &work, &shape, &weak);
    if (err)
        return err;
    give_shape((size_t)n, &shape, d, gain, left);
    *limited = weak;
    return ERR_OK;
}

#include "state_feedback.h"

#include <stdio.h>
#include <string.h>

#include "design/state_decoupler.h"
#include "libreflux.h"

static void take_matrix(const double *from, int32_t rows, int32_t cols, struct matrix *to)
{
    to->rows = (uint8_t)rows;
    to->cols = (uint8_t)cols;
    for (int32_t i = 0; i < rows; i++)
        for (int32_t j = 0; j < cols; j++)
            to->value[i][j] = from[i * cols + j];
}

static void give_matrix(const struct matrix *from, double *to)
{
    for (size_t i = 0; i < from->rows; i++)
        for (size_t j = 0; j < from->cols; j++)
            to[i * from->cols + j] = from->value[i][j];
}

static enum err take_state_model(const struct reflux_state_model *from, struct state_model *to)
{
    if (from->n < 1 || from->n > STATE_MODEL_STATES || from->loops < 1 ||
        from->loops > STATE_LOOPS || from->disturbances < 0 ||
        from->disturbances > STATE_MODEL_DISTURBANCES)
        return ERR_RANGE;
    to->period_s = from->period_s;
    take_matrix(from->a, from->n, from->n, &to->a);
    take_matrix(from->b, from->n, from->loops, &to->b);
    take_matrix(from->c, from->loops, from->n, &to->c);
    take_matrix(from->e, from->n, from->disturbances, &to->e);
    return ERR_OK;
}

void reflux_state_decoupler_defaults(double *settings)
{
    struct state_decoupler_config c;
    state_decoupler_config_default(&c);
    const double all[3] = {c.row_lo, c.condition_hi, c.weight_lo};
    memcpy(settings, all, sizeof all);
}

static void give_found(const struct state_decoupler *d, struct reflux_state_found *to)
{
    for (size_t i = 0; i < d->loops; i++) {
        to->index[i] = d->index[i];
        to->k_star[i] = d->k_star[i];
        for (size_t k = 0; k < STATE_POLES; k++)
            to->m[i * STATE_POLES + k] = d->m[i][k];
    }
    give_matrix(&d->f, to->f);
    give_matrix(&d->g, to->g);
    give_matrix(&d->tf, to->tf);
    give_matrix(&d->b_star, to->b_star);
    *to->n_zeros = d->zeros.n;
    *to->needed = d->needed;
    for (size_t k = 0; k < d->zeros.n; k++) {
        to->zeros[2 * k] = d->zeros.mode[k].re;
        to->zeros[2 * k + 1] = d->zeros.mode[k].im;
    }
    const double numbers[5] = {d->condition, d->neglected, d->zeros.outermost, d->zeros.error,
                               d->radius};
    memcpy(to->numbers, numbers, sizeof numbers);
}

int32_t reflux_state_decoupler(const struct reflux_state_model *model, const double *settings,
                               const struct reflux_state_goal *goal,
                               struct reflux_state_found *found, char *reason)
{
    _Static_assert(REFLUX_STATE_POLES == STATE_POLES, "places for poles");
    struct state_model m;
    struct state_decoupler d = {0};
    struct state_decoupler_work work;
    struct state_decoupler_refusal why = {
        "model", "1 to 16 states, 1 to 8 loops, 0 to 8 disturbances", STATE_LOOP_NONE};
    const struct state_decoupler_config config = {settings[0], settings[1], settings[2]};
    struct state_decoupler_goal g = {.hold_s = goal->hold_s,
                                     .feedforward = (enum state_feedforward)goal->feedforward};
    enum err err = take_state_model(model, &m);
    for (size_t i = 0; !err && i < (size_t)model->loops; i++) {
        g.integral_s[i] = goal->integral_s[i];
        g.derivative_s[i] = goal->derivative_s[i];
        for (size_t k = 0; k < STATE_POLES; k++) {
            const double *pole = goal->poles + 2 * (i * STATE_POLES + k);
            g.pole[i][k] = cplx(pole[0], pole[1]);
        }
    }
    if (!err)
        err = state_decoupler_design(&m, &config, &g, &work, &d, &why);
    give_found(&d, found);
    if (err && reason) {
        int at = snprintf(reason, REFLUX_WHY_BYTES, "%s: %s", why.field, why.wanted);
        if (why.loop != STATE_LOOP_NONE && at > 0 && at < REFLUX_WHY_BYTES)
            (void)snprintf(reason + at, (size_t)(REFLUX_WHY_BYTES - at), " (loop %u)",
                           why.loop + 1u);
    }
    return err;
}

int32_t reflux_state_sample(const struct reflux_state_model *model, double period_s, double *a,
                            double *b, double *e)
{
    struct state_model m, sampled;
    struct state_model_work work;
    enum err err = take_state_model(model, &m);
    if (!err)
        err = state_model_sample(&m, period_s, &work, &sampled);
    if (err)
        return err;
    give_matrix(&sampled.a, a);
    give_matrix(&sampled.b, b);
    give_matrix(&sampled.e, e);
    return ERR_OK;
}

#include "feedforward.h"

#include <stdalign.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "design/feedforward_rules.h"
#include "design/response_fit.h"
#include "identify/high_order.h"
#include "kinds/ff_tune/feedforward_search.h"
#include "libreflux.h"
#include "signal/lag.h"

#define MEMORY_BYTES 20000
#define SIGNALS      (1 + HIGH_ORDER_INPUTS)
#define LAGS         2

static enum err take_shape(const int32_t *from, struct high_order_shape *shape)
{
    memset(shape, 0, sizeof *shape);
    for (int i = 0; i < 2 || (i < 6 && i < 2 + 2 * from[1]); i++)
        if (from[i] < 0 || from[i] > UINT8_MAX)
            return ERR_RANGE;
    shape->na = (uint8_t)from[0];
    shape->inputs = (uint8_t)from[1];
    for (int j = 0; j < from[1] && j < HIGH_ORDER_INPUTS; j++) {
        shape->nb[j] = (uint8_t)from[2 + 2 * j];
        shape->delay[j] = (uint8_t)from[3 + 2 * j];
    }
    return ERR_OK;
}

static enum err begin_lags(struct lag lags[SIGNALS][LAGS], double time_constant_s, double h_s)
{
    enum err err = ERR_OK;
    for (int i = 0; i < SIGNALS; i++)
        for (int k = 0; k < LAGS && !err; k++)
            err = lag_init(&lags[i][k], (float)time_constant_s, (float)h_s);
    return err;
}

static num_t filtered(struct lag lags[LAGS], double x)
{
    num_t v = num_from_float((float)x);
    for (int k = 0; k < LAGS; k++)
        v = lag_step(&lags[k], v);
    return v;
}

int32_t reflux_high_order(const int32_t *shape, const double *settings, int32_t samples,
                          const double *y, const double *u, int32_t first, int32_t what,
                          int32_t points, const double *omega_h, double *out, char *reason)
{
    alignas(16) static _Thread_local uint8_t memory[MEMORY_BYTES];
    struct high_order *h = (struct high_order *)memory;
    struct high_order_shape of;
    struct high_order_settings how = {.forgetting = RLS_CONSTANT,
                                      .forget = (float)settings[3],
                                      .forget_least = 0.5F,
                                      .memory = 1.0F,
                                      .sigma0 = 1.0F,
                                      .trace = 1e9F,
                                      .p0 = (float)settings[4]};
    struct lag lags[SIGNALS][LAGS];
    const char *field = "shape", *wanted = "whole numbers, 0 to 255";
    enum err err = take_shape(shape, &of);
    if (!err)
        err = high_order_check(&of, &how, &field, &wanted);
    if (!err && (samples < 1 || first < 0 || points < 1 || what < -1 || what >= (int)of.inputs ||
                 (what < 0 && of.inputs < 2))) {
        field = "samples, first, points, what";
        wanted = "at least 1, 0 and 1; an input, or -1 with two inputs";
        err = ERR_RANGE;
    }
    if (!err && high_order_bytes(&of) > sizeof memory)
        err = ERR_MEMORY;
    if (!err) {
        field = "time constant, sampling period";
        wanted = "0 to 1e6 s, 0.001 to 1e5 s";
        err = begin_lags(lags, settings[1], settings[2]);
    }
    if (err) {
        if (reason)
            (void)snprintf(reason, REFLUX_WHY_BYTES, "%s: %s", field, wanted);
        return err;
    }
    high_order_init(h, &of, &how);
    for (int32_t k = 0; k < samples; k++) {
        num_t in[HIGH_ORDER_INPUTS];
        num_t now = filtered(lags[0], settings[0] * y[k]);
        for (int j = 0; j < of.inputs; j++)
            in[j] = filtered(lags[1 + j], settings[0] * u[(size_t)k * of.inputs + (size_t)j]);
        (void)high_order_step(h, now, in, k >= first);
    }
    for (int32_t i = 0; i < points && !err; i++) {
        struct high_order_point p = {0};
        err = what < 0 ? high_order_ratio(h, (real_t)omega_h[i], &p)
                       : high_order_response(h, (unsigned)what, (real_t)omega_h[i], &p);
        double *at = out + 3 * (ptrdiff_t)i;
        at[0] = p.value.re;
        at[1] = p.value.im;
        at[2] = p.sd;
    }
    return err;
}

int32_t reflux_feedforward_search(int32_t points, const double *omega, const double *weight,
                                  const double *ratio, const double *settings, double *found)
{
    struct feedforward_wanted wanted = {.h_s = (real_t)settings[0],
                                        .kick = (real_t)settings[1],
                                        .lag_most = (real_t)settings[2],
                                        .dead_most = (real_t)settings[3]};
    struct feedforward_search search;
    double pieces = 1;
    if (points < 1 || points > FEEDFORWARD_POINTS)
        return ERR_RANGE;
    wanted.points = (uint8_t)points;
    for (int32_t i = 0; i < points; i++) {
        wanted.omega[i] = (real_t)omega[i];
        wanted.weight[i] = (real_t)weight[i];
        wanted.ratio[i] =
            cplx((real_t)ratio[2 * (ptrdiff_t)i], (real_t)ratio[2 * (ptrdiff_t)i + 1]);
    }
    feedforward_search_begin(&search, &wanted);
    while (feedforward_search_piece(&search, &wanted))
        pieces += 1;
    found[0] = search.best.k;
    found[1] = search.best.lead;
    found[2] = search.best.lag;
    found[3] = search.best.dead;
    found[4] = search.j;
    found[5] = search.j0;
    found[6] = pieces;
    return ERR_OK;
}

static enum err fitted(int32_t points, const real_t *omega, const double *response,
                       double dead_most, struct fopdt *model, double *out)
{
    struct cplx g[FEEDFORWARD_POINTS];
    real_t error = 0;
    for (int32_t i = 0; i < points; i++)
        g[i] = cplx((real_t)response[2 * (ptrdiff_t)i], (real_t)response[2 * (ptrdiff_t)i + 1]);
    enum err err = fopdt_from_response((size_t)points, omega, g, (real_t)dead_most, model, &error);
    if (!err) {
        out[0] = model->gain;
        out[1] = model->dead_time_s;
        out[2] = model->time_constant_s;
        out[3] = error;
    }
    return err;
}

int32_t reflux_shinskey(int32_t points, const double *omega, const double *process,
                        const double *disturbance, const double *settings, double *models,
                        double *rule)
{
    real_t at[FEEDFORWARD_POINTS];
    struct fopdt gp, gd;
    struct feedforward_rule found;
    if (points < 1 || points > FEEDFORWARD_POINTS)
        return ERR_RANGE;
    for (int32_t i = 0; i < points; i++)
        at[i] = (real_t)omega[i];
    enum err err = fitted(points, at, process, settings[0], &gp, models);
    if (!err)
        err = fitted(points, at, disturbance, settings[0], &gd, models + 4);
    if (!err)
        err = feedforward_shinskey(&gp, &gd, (real_t)settings[1], &found);
    if (err)
        return err;
    rule[0] = found.gain;
    rule[1] = found.lead_s;
    rule[2] = found.lag_s;
    return ERR_OK;
}

int32_t reflux_feedforward_misses(int32_t points, const double *db, const double *degrees,
                                  double *out)
{
    struct feedforward_miss miss[FEEDFORWARD_POINTS], largest, together;
    if (points < 1 || points > FEEDFORWARD_POINTS)
        return ERR_RANGE;
    for (int32_t i = 0; i < points; i++)
        miss[i] = (struct feedforward_miss){(real_t)db[i], (real_t)degrees[i]};
    feedforward_misses((size_t)points, miss, &largest, &together);
    out[0] = largest.db;
    out[1] = largest.degrees;
    out[2] = together.db;
    out[3] = together.degrees;
    return ERR_OK;
}

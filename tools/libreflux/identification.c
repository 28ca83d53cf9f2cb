#include "identification.h"

#include <stdio.h>
#include <string.h>

#include "identify/arx_fit.h"
#include "identify/arx_select.h"
#include "identify/decimate.h"
#include "identify/prbs.h"
#include "libreflux.h"

static enum err take_record(const struct reflux_record *from, int32_t output, const int32_t *range,
                            struct arx_data *data)
{
    if (from->samples < 1 || from->outputs < 1 || from->outputs > DIFFERENCE_MOST ||
        from->inputs < 1 || from->inputs > DIFFERENCE_MOST)
        return ERR_RANGE;
    if (output < 0 || output >= from->outputs || range[0] < 0 || range[1] < range[0] ||
        range[1] > from->samples)
        return ERR_RANGE;
    *data = (struct arx_data){.samples = (uint32_t)from->samples,
                              .outputs = (uint8_t)from->outputs,
                              .inputs = (uint8_t)from->inputs,
                              .u = from->u,
                              .y = from->y};
    return arx_check(data);
}

static void say(char *reason, const char *field, const char *wanted)
{
    if (reason)
        (void)snprintf(reason, REFLUX_WHY_BYTES, "%s: %s", field, wanted);
}

static uint8_t small(int32_t n)
{
    return n < 0 || n > UINT8_MAX ? UINT8_MAX : (uint8_t)n;
}

static enum err take_orders(const int32_t *from, uint8_t inputs, struct arx_orders *orders,
                            char *reason)
{
    const char *field = "", *wanted = "";
    memset(orders, 0, sizeof *orders);
    orders->na = small(from[0]);
    orders->nc = small(from[1]);
    orders->constant = from[2] != 0;
    for (int j = 0; j < inputs; j++) {
        orders->first[j] = small(from[3 + 2 * j]);
        orders->last[j] = small(from[4 + 2 * j]);
    }
    enum err err = arx_orders_check(orders, inputs, &field, &wanted);
    if (err)
        say(reason, field, wanted);
    return err;
}

int32_t reflux_prbs(int32_t inputs, const int32_t *settings, const double *amplitude,
                    int32_t samples, double *u, int32_t *period, int32_t *memory, char *reason)
{
    const char *field = "", *wanted = "";
    struct prbs prbs;
    struct prbs_settings s = {
        .inputs = small(inputs),
        .bits = small(settings[0]),
        .independence = small(settings[1]),
        .clock = settings[2] < 0 || settings[2] > UINT16_MAX ? UINT16_MAX : (uint16_t)settings[2]};
    for (int j = 0; j < inputs && j < PRBS_INPUTS; j++)
        s.amplitude[j] = amplitude[j];
    enum err err = prbs_check(&s, &field, &wanted);
    if (err) {
        say(reason, field, wanted);
        return err;
    }
    *period = (int32_t)prbs_period(&s);
    *memory = (int32_t)prbs_memory(&s);
    prbs_init(&prbs, &s);
    for (int32_t k = 0; k < samples; k++)
        prbs_step(&prbs, u + (size_t)k * s.inputs);
    return ERR_OK;
}

int32_t reflux_decimate(int32_t ratio, double cutoff, int32_t samples, const double *x,
                        double *kept)
{
    struct decimator d;
    size_t n = 0;
    enum err err = decimator_init(&d, ratio < 0 ? 0 : (uint32_t)ratio, cutoff);
    for (int32_t k = 0; k < samples && !err; k++)
        if (decimator_step(&d, x[k], &kept[n]))
            n++;
    return err;
}

int32_t reflux_arx_select(const struct reflux_record *record, int32_t output, const int32_t *limits,
                          const int32_t *range, int32_t *n, int32_t *orders, double *numbers,
                          int32_t *best, int32_t *rows)
{
    static struct arx_search search; /* 60 KiB; the library is not for threads */
    struct arx_data data;
    enum err err = take_record(record, output, range, &data);
    if (!err && (limits[3] < ARX_BIC || limits[3] > ARX_AICC))
        err = ERR_RANGE;
    if (!err)
        err = arx_select(&data, (uint8_t)output, small(limits[0]), small(limits[1]), limits[2] != 0,
                         (enum arx_criterion)limits[3], (uint32_t)range[0], (uint32_t)range[1],
                         &search);
    if (err)
        return err;
    *n = search.trials;
    *best = search.best;
    *rows = (int32_t)search.rows;
    for (size_t t = 0; t < search.trials; t++) {
        const struct arx_trial *trial = &search.trial[t];
        int32_t *o = orders + t * (3u + 2u * data.inputs);
        o[0] = trial->orders.na;
        o[1] = 0;
        o[2] = trial->orders.constant;
        for (size_t j = 0; j < data.inputs; j++) {
            o[3 + 2 * j] = trial->orders.first[j];
            o[4 + 2 * j] = trial->orders.last[j];
        }
        const double all[4] = {trial->parameters, trial->squares, trial->criterion,
                               trial->err == ERR_OK};
        memcpy(numbers + 4 * t, all, sizeof all);
    }
    return ERR_OK;
}

int32_t reflux_arx_fit(const struct reflux_record *record, int32_t output, const int32_t *orders,
                       int32_t method, const int32_t *range, double *theta, double *sd,
                       double *numbers, char *reason)
{
    static struct arx_work work;
    struct arx_data data;
    struct arx_orders o;
    struct arx_fit fit;
    enum err err = take_record(record, output, range, &data);
    if (!err)
        err = take_orders(orders, data.inputs, &o, reason);
    if (!err && (method < ARX_LS || method > ARX_ELS))
        err = ERR_RANGE;
    if (!err)
        err = arx_fit(&data, (uint8_t)output, &o, (enum arx_method)method, (uint32_t)range[0],
                      (uint32_t)range[1], &work, &fit);
    if (err)
        return err;
    size_t parameters = arx_parameters(&fit.orders, data.inputs);
    memcpy(theta, fit.theta, parameters * sizeof theta[0]);
    memcpy(sd, fit.sd, parameters * sizeof sd[0]);
    const double all[5] = {(double)parameters, fit.variance, fit.rows, fit.passes, fit.settled};
    memcpy(numbers, all, sizeof all);
    return ERR_OK;
}

int32_t reflux_arx_judge(const struct reflux_record *record, int32_t output, const int32_t *orders,
                         const double *theta, const int32_t *range, double *numbers)
{
    struct arx_data data;
    struct arx_fit fit = {0};
    struct arx_judgement judged;
    enum err err = take_record(record, output, range, &data);
    if (!err)
        err = take_orders(orders, data.inputs, &fit.orders, NULL);
    if (err)
        return err;
    memcpy(fit.theta, theta, arx_parameters(&fit.orders, data.inputs) * sizeof theta[0]);
    err = arx_judge(&data, (uint8_t)output, &fit, (uint32_t)range[0], (uint32_t)range[1], &judged);
    if (err)
        return err;
    const double all[4] = {judged.rows, judged.step_squares, judged.simulated_squares,
                           judged.squares};
    memcpy(numbers, all, sizeof all);
    return ERR_OK;
}

#include "identify/arx.h"

#include <string.h>

#include "base/assertion.h"
#include "identify/common.h"

enum err arx_check(const struct arx_data *d)
{
    if (d->outputs < 1 || d->outputs > DIFFERENCE_MOST || d->inputs < 1 ||
        d->inputs > DIFFERENCE_MOST || d->samples > UINT32_C(0x80000000))
        return ERR_RANGE;
    const size_t values[2] = {(size_t)d->samples * d->inputs, (size_t)d->samples * d->outputs};
    for (size_t which = 0; which < 2; which++) {
        const real_t *x = which == 0 ? d->u : d->y;
        for (size_t k = 0; k < values[which]; k++) {
            enum err err = check_real(x[k], -VALUE_MAX, VALUE_MAX);
            if (err)
                return err;
        }
    }
    return ERR_OK;
}

static bool lags_fit(uint8_t first, uint8_t last)
{
    return last == 0 || (first >= 1 && first <= last && last <= DIFFERENCE_B_MOST);
}

enum err arx_orders_check(const struct arx_orders *o, uint8_t inputs, const char **field,
                          const char **wanted)
{
    const char *unused;
    field = field ? field : &unused;
    wanted = wanted ? wanted : &unused;
    *field = "na";
    *wanted = "0 to 4";
    if (o->na > DIFFERENCE_A_MOST)
        return ERR_RANGE;
    *field = "nc";
    if (o->nc > ARX_C_MOST)
        return ERR_RANGE;
    *field = "first, last";
    *wanted = "1 <= first <= last <= 8, or last 0";
    for (size_t j = 0; j < inputs; j++)
        if (!lags_fit(o->first[j], o->last[j]))
            return ERR_RANGE;
    *field = "na, last, constant";
    *wanted = "at least one parameter";
    return arx_parameters(o, inputs) > 0 ? ERR_OK : ERR_RANGE;
}

size_t arx_parameters(const struct arx_orders *o, uint8_t inputs)
{
    size_t n = (size_t)o->na + o->nc + (o->constant ? 1u : 0u);
    for (size_t j = 0; j < inputs; j++)
        n += o->last[j] > 0 ? o->last[j] - o->first[j] + 1u : 0u;
    return n;
}

size_t arx_before(const struct arx_orders *o, uint8_t inputs)
{
    size_t most = o->na > o->nc ? o->na : o->nc;
    for (size_t j = 0; j < inputs; j++)
        most = o->last[j] > most ? o->last[j] : most;
    return most;
}

void arx_regressor(const struct arx_orders *o, uint8_t inputs, const struct arx_history *h,
                   real_t *phi)
{
    REFLUX_ASSERT(inputs <= DIFFERENCE_MOST && o->na <= DIFFERENCE_A_MOST && o->nc <= ARX_C_MOST);
    size_t n = 0;
    for (size_t k = 0; k < o->na; k++)
        phi[n++] = -h->y[k];
    for (size_t j = 0; j < inputs; j++)
        for (size_t k = o->first[j]; k <= o->last[j] && o->last[j] > 0; k++)
            phi[n++] = h->u[j][k - 1];
    for (size_t k = 0; k < o->nc; k++)
        phi[n++] = h->e[k];
    if (o->constant)
        phi[n] = ONE;
}

static void move_in(real_t *newest_first, size_t n, real_t x)
{
    memmove(newest_first + 1, newest_first, (n - 1u) * sizeof x);
    newest_first[0] = x;
}

void arx_push(struct arx_history *h, uint8_t inputs, real_t y, const real_t *u, real_t e)
{
    REFLUX_ASSERT(inputs <= DIFFERENCE_MOST);
    move_in(h->y, DIFFERENCE_A_MOST, y);
    for (size_t j = 0; j < inputs; j++)
        move_in(h->u[j], DIFFERENCE_B_MOST, u[j]);
    move_in(h->e, ARX_C_MOST, e);
}

enum err arx_collect_begin(struct arx_collecting *c, const struct arx_data *d, uint8_t output,
                           const struct arx_orders *o, uint32_t from, uint32_t to, uint32_t skip,
                           struct arx_work *w)
{
    REFLUX_ASSERT(output < d->outputs && d->inputs <= DIFFERENCE_MOST &&
                  arx_parameters(o, d->inputs) <= ARX_MOST);
    size_t n = arx_parameters(o, d->inputs);
    memset(c, 0, sizeof *c);
    if (to > d->samples || from > to || to - from < skip || to - from - skip < n + 2)
        return ERR_EMPTY;
    c->data = d;
    c->output = output;
    c->orders = *o;
    c->from = c->k = from;
    c->to = to;
    c->skip = skip;
    c->work = w;
    triangle_begin(&w->triangle, n + 1, 0, w->cells);
    return ERR_OK;
}

bool arx_collect_piece(struct arx_collecting *c, uint32_t most)
{
    REFLUX_ASSERT(c->to <= c->data->samples && c->output < c->data->outputs);
    const struct arx_data *d = c->data;
    size_t n = arx_parameters(&c->orders, d->inputs);
    for (; c->k < c->to && most > 0; c->k++, most--) {
        real_t row[ARX_MOST + 1], y = d->y[(size_t)c->k * d->outputs + c->output];
        if (c->k - c->from >= c->skip) {
            arx_regressor(&c->orders, d->inputs, &c->history, row);
            row[n] = y;
            triangle_row(&c->work->triangle, row);
            c->rows++;
        }
        arx_push(&c->history, d->inputs, y, &d->u[(size_t)c->k * d->inputs], ZERO);
    }
    return c->k < c->to;
}

enum err arx_collect(const struct arx_data *d, uint8_t output, const struct arx_orders *o,
                     uint32_t from, uint32_t to, uint32_t skip, struct arx_work *w, uint32_t *rows)
{
    struct arx_collecting c;
    enum err err = arx_collect_begin(&c, d, output, o, from, to, skip, w);
    if (!err)
        (void)arx_collect_piece(&c, to - from);
    *rows = c.rows;
    return err;
}

enum err arx_take(const struct triangle *t, struct arx_fit *fit)
{
    REFLUX_ASSERT(t->columns >= 1 && t->columns - 1u <= ARX_MOST);
    size_t n = t->columns - 1u;
    enum err err = triangle_solve(t, fit->theta);
    if (err)
        return err;
    fit->squares = triangle_rest(t);
    fit->variance = fit->squares / (real_t)(fit->rows - n);
    triangle_spread(t, fit->sd);
    for (size_t i = 0; i < n; i++)
        fit->sd[i] *= real_sqrt(fit->variance);
    return ERR_OK;
}

enum err arx_judge_begin(struct arx_judging *j, const struct arx_data *d, uint8_t output,
                         const struct arx_fit *fit, uint32_t from, uint32_t to)
{
    memset(j, 0, sizeof *j);
    if (to > d->samples || from > to || to - from <= arx_before(&fit->orders, d->inputs))
        return ERR_EMPTY;
    j->data = d;
    j->fit = fit;
    j->output = output;
    j->from = j->k = from;
    j->to = to;
    return ERR_OK;
}

static void judge_errors(struct arx_judging *j, real_t y, real_t x, real_t e)
{
    j->rows += ONE;
    real_t off = y - j->mean;
    j->mean += off / j->rows;
    j->about += off * (y - j->mean);
    j->step += (e * e - j->step) / j->rows;
    j->alone += ((y - x) * (y - x) - j->alone) / j->rows;
}

bool arx_judge_piece(struct arx_judging *j, uint32_t most)
{
    REFLUX_ASSERT(j->to <= j->data->samples && j->output < j->data->outputs);
    const struct arx_data *d = j->data;
    const struct arx_fit *fit = j->fit;
    size_t n = arx_parameters(&fit->orders, d->inputs),
           before = arx_before(&fit->orders, d->inputs);
    real_t phi[ARX_MOST] = {ZERO};
    for (; j->k < j->to && most > 0; j->k++, most--) {
        const real_t *u = &d->u[(size_t)j->k * d->inputs];
        real_t y = d->y[(size_t)j->k * d->outputs + j->output], x = y, e = ZERO;
        if (j->k - j->from >= before) {
            arx_regressor(&fit->orders, d->inputs, &j->history, phi);
            e = y - arx_sum(phi, fit->theta, n);
            arx_regressor(&fit->orders, d->inputs, &j->simulated, phi);
            x = arx_sum(phi, fit->theta, n);
            if (!(real_abs(x) <= VALUE_MAX)) /* diverges: stays there */
                x = VALUE_MAX;
            judge_errors(j, y, x, e);
        }
        arx_push(&j->history, d->inputs, y, u, e);
        arx_push(&j->simulated, d->inputs, x, u, ZERO);
    }
    return j->k < j->to;
}

void arx_judge_take(const struct arx_judging *j, struct arx_judgement *judged)
{
    judged->rows = j->to - j->from - (uint32_t)arx_before(&j->fit->orders, j->data->inputs);
    judged->step_squares = j->step;
    judged->simulated_squares = j->alone;
    judged->squares = j->about / j->rows;
}

enum err arx_judge(const struct arx_data *d, uint8_t output, const struct arx_fit *fit,
                   uint32_t from, uint32_t to, struct arx_judgement *judged)
{
    struct arx_judging j;
    memset(judged, 0, sizeof *judged);
    enum err err = arx_judge_begin(&j, d, output, fit, from, to);
    if (err)
        return err;
    (void)arx_judge_piece(&j, to - from);
    arx_judge_take(&j, judged);
    return ERR_OK;
}

void arx_model(const struct arx_fit *fits, uint8_t outputs, uint8_t inputs, real_t period_s,
               struct difference_model *model)
{
    REFLUX_ASSERT(outputs <= DIFFERENCE_MOST && inputs <= DIFFERENCE_MOST);
    memset(model, 0, sizeof *model);
    model->outputs = outputs;
    model->inputs = inputs;
    model->period_s = period_s;
    model->nb = 1;
    for (size_t i = 0; i < outputs; i++) {
        const struct arx_orders *o = &fits[i].orders;
        size_t n = 0;
        model->na = o->na > model->na ? o->na : model->na;
        for (size_t k = 0; k < o->na; k++)
            model->a[i][k] = fits[i].theta[n++];
        for (size_t j = 0; j < inputs; j++) {
            model->nb = o->last[j] > model->nb ? o->last[j] : model->nb;
            for (size_t k = o->first[j]; k <= o->last[j] && o->last[j] > 0; k++)
                model->b[i][j][k - 1] = fits[i].theta[n++];
        }
    }
}

#include "identify/arx_select.h"

#include "identify/common.h"

/* The largest model, and what the trials have in common. */
struct grid {
    const struct arx_data *data;
    struct arx_orders all;
    enum arx_criterion criterion;
};

static real_t criterion_of(const struct grid *g, const struct arx_search *s, real_t squares,
                           real_t p)
{
    real_t rows = (real_t)s->rows,
           least = rows * (real_t)s->work.triangle.columns * REAL_EPSILON * REAL_EPSILON * s->of_y;
    if (squares < least)
        squares = least;
    real_t misfit = squares > ZERO ? rows * real_log(squares / rows) : ZERO;
    if (g->criterion == ARX_BIC)
        return misfit + p * real_log(rows);
    return misfit + TWO * p + TWO * p * (p + ONE) / (rows - p - ONE);
}

/* Columns that a lower model has of the largest's, and that of y. */
static size_t columns_of(const struct grid *g, const struct arx_orders *o, uint8_t *column)
{
    size_t n = 0, at = g->all.na;
    for (size_t k = 0; k < o->na; k++)
        column[n++] = (uint8_t)k;
    for (size_t j = 0; j < g->data->inputs; j++)
        for (size_t k = 1; k <= g->all.last[j]; k++, at++)
            if (o->last[j] > 0 && k >= o->first[j] && k <= o->last[j])
                column[n++] = (uint8_t)at;
    if (o->constant)
        column[n++] = (uint8_t)at++;
    column[n++] = (uint8_t)at;
    return n;
}

static bool tried(const struct arx_search *s, const struct arx_orders *o, uint8_t inputs)
{
    for (size_t t = 0; t < s->trials; t++) {
        const struct arx_orders *was = &s->trial[t].orders;
        bool same = was->na == o->na;
        for (size_t j = 0; j < inputs; j++)
            same = same && was->last[j] == o->last[j] && was->first[j] == o->first[j];
        if (same)
            return true;
    }
    return false;
}

static void try_orders(const struct grid *g, const struct arx_orders *o, struct arx_search *s)
{
    uint8_t column[ARX_MOST + 1];
    size_t n = arx_parameters(o, g->data->inputs);
    if (s->trials >= ARX_TRIALS || n < 1 || tried(s, o, g->data->inputs))
        return;
    struct arx_trial *t = &s->trial[s->trials++];
    *t = (struct arx_trial){.orders = *o, .parameters = (uint8_t)n};
    s->fit.rows = s->rows;
    triangle_select(&s->work.triangle, column, columns_of(g, o, column), &s->lower, s->of);
    t->err = arx_take(&s->lower, &s->fit);
    if (t->err)
        return;
    t->squares = s->fit.squares;
    t->criterion = criterion_of(g, s, t->squares, (real_t)n);
    const struct arx_trial *best = &s->trial[s->best];
    if (best->err || t->criterion < best->criterion)
        s->best = (uint16_t)(s->trials - 1u);
}

/* The best with one coefficient less at either end of an input. Returns whether one of them is better. */
static bool drop_one(const struct grid *g, struct arx_search *s)
{
    uint16_t best = s->best;
    const struct arx_orders from = s->trial[best].orders;
    for (size_t j = 0; j < g->data->inputs; j++)
        for (int end = 0; end < 2; end++) {
            struct arx_orders o = from;
            if (o.last[j] == 0)
                continue;
            if (o.first[j] == o.last[j])
                o.first[j] = o.last[j] = 0;
            else if (end == 0)
                o.first[j]++;
            else
                o.last[j]--;
            try_orders(g, &o, s);
        }
    return s->best != best;
}

/* Sum of y squared: of its column in the triangle. */
static real_t squares_of_y(const struct triangle *t)
{
    real_t sum = ZERO;
    size_t n = t->columns - 1u;
    for (size_t i = 0; i <= n; i++) {
        real_t part = triangle_at(t, i)[n - i];
        sum += part * part;
    }
    return sum;
}

enum err arx_select(const struct arx_data *d, uint8_t output, uint8_t na, uint8_t nb, bool constant,
                    enum arx_criterion criterion, uint32_t from, uint32_t to, struct arx_search *s)
{
    struct grid g = {.data = d, .criterion = criterion, .all = {.na = na, .constant = constant}};
    if (na > DIFFERENCE_A_MOST || nb < 1 || nb > DIFFERENCE_B_MOST)
        return ERR_RANGE;
    for (size_t j = 0; j < d->inputs; j++) {
        g.all.first[j] = 1;
        g.all.last[j] = nb;
    }
    s->trials = s->best = 0;
    enum err err = arx_collect(d, output, &g.all, from, to, (uint32_t)arx_before(&g.all, d->inputs),
                               &s->work, &s->rows);
    if (err)
        return err;
    s->of_y = squares_of_y(&s->work.triangle);
    for (uint8_t a = 0; a <= na; a++)
        for (uint8_t b = 1; b <= nb; b++) {
            struct arx_orders o = g.all;
            o.na = a;
            for (size_t j = 0; j < d->inputs; j++)
                o.last[j] = b;
            try_orders(&g, &o, s);
        }
    if (s->trial[s->best].err)
        return ERR_SINGULAR;
    for (int round = 0; round < DIFFERENCE_MOST * DIFFERENCE_B_MOST && drop_one(&g, s); round++)
        ;
    return ERR_OK;
}

#include "identify/arx_select.h"

#include <string.h>

#include "base/assertion.h"
#include "identify/common.h"

enum search_stage { SEARCH_ROWS, SEARCH_GRID, SEARCH_DROPS, SEARCH_OVER };

static real_t criterion_of(const struct arx_searching *g, real_t squares, real_t p)
{
    const struct arx_search *s = g->search;
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
static size_t columns_of(const struct arx_searching *g, const struct arx_orders *o, uint8_t *column)
{
    REFLUX_ASSERT(g->rows.data->inputs <= DIFFERENCE_MOST);
    const struct arx_orders *all = &g->rows.orders;
    size_t n = 0, at = all->na;
    for (size_t k = 0; k < o->na; k++)
        column[n++] = (uint8_t)k;
    for (size_t j = 0; j < g->rows.data->inputs; j++)
        for (size_t k = 1; k <= all->last[j]; k++, at++)
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

static void try_orders(struct arx_searching *g, const struct arx_orders *o)
{
    struct arx_search *s = g->search;
    uint8_t column[ARX_MOST + 1], inputs = g->rows.data->inputs;
    size_t n = arx_parameters(o, inputs);
    if (s->trials >= ARX_TRIALS || n < 1 || tried(s, o, inputs))
        return;
    struct arx_trial *t = &s->trial[s->trials++];
    *t = (struct arx_trial){.orders = *o, .parameters = (uint8_t)n};
    s->fit.rows = s->rows;
    triangle_select(&s->work.triangle, column, columns_of(g, o, column), &s->lower, s->cells);
    t->err = arx_take(&s->lower, &s->fit);
    if (t->err)
        return;
    t->squares = s->fit.squares;
    t->criterion = criterion_of(g, t->squares, (real_t)n);
    const struct arx_trial *best = &s->trial[s->best];
    if (best->err || t->criterion < best->criterion)
        s->best = (uint16_t)(s->trials - 1u);
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

static void end_orders_search(struct arx_searching *g, enum err err)
{
    g->err = err;
    g->stage = SEARCH_OVER;
}

void arx_select_begin(struct arx_searching *g, const struct arx_data *d, uint8_t output, uint8_t na,
                      uint8_t nb, bool constant, enum arx_criterion criterion, uint32_t from,
                      uint32_t to, struct arx_search *s)
{
    REFLUX_ASSERT(d->inputs <= DIFFERENCE_MOST);
    struct arx_orders all = {.na = na, .constant = constant};
    memset(g, 0, sizeof *g);
    g->search = s;
    g->nb = nb;
    g->criterion = (uint8_t)criterion;
    if (na > DIFFERENCE_A_MOST || nb < 1 || nb > DIFFERENCE_B_MOST) {
        end_orders_search(g, ERR_RANGE);
        return;
    }
    for (size_t j = 0; j < d->inputs; j++) {
        all.first[j] = 1;
        all.last[j] = nb;
    }
    s->trials = s->best = 0;
    enum err err = arx_collect_begin(&g->rows, d, output, &all, from, to,
                                     (uint32_t)arx_before(&all, d->inputs), &s->work);
    if (err)
        end_orders_search(g, err);
}

static void begin_grid(struct arx_searching *g)
{
    g->search->rows = g->rows.rows;
    g->search->of_y = squares_of_y(&g->search->work.triangle);
    g->stage = SEARCH_GRID;
}

/* All inputs alike, from na = 0 and nb = 1 on. */
static void try_of_grid(struct arx_searching *g)
{
    REFLUX_ASSERT(g->nb >= 1);
    struct arx_orders o = g->rows.orders;
    o.na = (uint8_t)(g->next / g->nb);
    for (size_t j = 0; j < g->rows.data->inputs; j++)
        o.last[j] = (uint8_t)(g->next % g->nb + 1);
    try_orders(g, &o);
    if (++g->next < ((unsigned)g->rows.orders.na + 1u) * g->nb)
        return;
    if (g->search->trial[g->search->best].err)
        end_orders_search(g, ERR_SINGULAR);
    g->next = 0;
    if (g->stage != SEARCH_OVER)
        g->stage = SEARCH_DROPS;
}

/* The best with one coefficient less at either end of an input, one of them at a time, until a round finds none that is better. */
static void try_a_drop(struct arx_searching *g)
{
    REFLUX_ASSERT(g->search->best < g->search->trials && g->next / 2u < DIFFERENCE_MOST);
    struct arx_search *s = g->search;
    if (g->next == 0) {
        g->best = s->best;
        g->from = s->trial[s->best].orders;
    }
    struct arx_orders o = g->from;
    size_t j = g->next / 2u;
    if (o.last[j] != 0) {
        if (o.first[j] == o.last[j])
            o.first[j] = o.last[j] = 0;
        else if (g->next % 2u == 0)
            o.first[j]++;
        else
            o.last[j]--;
        try_orders(g, &o);
    }
    if (++g->next < 2u * g->rows.data->inputs)
        return;
    g->next = 0;
    if (++g->round >= DIFFERENCE_MOST * DIFFERENCE_B_MOST || s->best == g->best)
        end_orders_search(g, ERR_OK);
}

bool arx_select_piece(struct arx_searching *g, uint32_t most)
{
    if (g->stage == SEARCH_ROWS) {
        if (!arx_collect_piece(&g->rows, most))
            begin_grid(g);
    } else if (g->stage == SEARCH_GRID) {
        try_of_grid(g);
    } else if (g->stage == SEARCH_DROPS) {
        try_a_drop(g);
    }
    return g->stage != SEARCH_OVER;
}

enum err arx_select(const struct arx_data *d, uint8_t output, uint8_t na, uint8_t nb, bool constant,
                    enum arx_criterion criterion, uint32_t from, uint32_t to, struct arx_search *s)
{
    struct arx_searching g;
    arx_select_begin(&g, d, output, na, nb, constant, criterion, from, to, s);
    /* The rows, the grid, and drops of either end of each input in each round. */
    const unsigned most = 1u + (DIFFERENCE_A_MOST + 1u) * DIFFERENCE_B_MOST +
                          2u * DIFFERENCE_MOST * DIFFERENCE_MOST * DIFFERENCE_B_MOST;
    for (unsigned piece = 0; piece < most && arx_select_piece(&g, to - from); piece++)
        ;
    return g.err;
}

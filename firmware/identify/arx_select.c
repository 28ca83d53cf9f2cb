#include "identify/arx_select.h"

#include <string.h>

#include "identify/common.h"

enum select_stage { SELECT_ROWS, SELECT_GRID, SELECT_DROP, SELECT_OVER };

static real_t criterion_of(const struct arx_selecting *g, real_t squares, real_t p)
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
static size_t columns_of(const struct arx_selecting *g, const struct arx_orders *o, uint8_t *column)
{
    size_t n = 0, at = g->all.na;
    for (size_t k = 0; k < o->na; k++)
        column[n++] = (uint8_t)k;
    for (size_t j = 0; j < g->rows.data->inputs; j++)
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

static void try_orders(struct arx_selecting *g, const struct arx_orders *o)
{
    struct arx_search *s = g->search;
    uint8_t column[ARX_MOST + 1];
    size_t n = arx_parameters(o, g->rows.data->inputs);
    if (s->trials >= ARX_TRIALS || n < 1 || tried(s, o, g->rows.data->inputs))
        return;
    struct arx_trial *t = &s->trial[s->trials++];
    *t = (struct arx_trial){.orders = *o, .parameters = (uint8_t)n};
    s->fit.rows = s->rows;
    triangle_select(&s->work.triangle, column, columns_of(g, o, column), &s->lower, s->of);
    t->err = arx_take(&s->lower, &s->fit);
    if (t->err)
        return;
    t->squares = s->fit.squares;
    t->criterion = criterion_of(g, t->squares, (real_t)n);
    const struct arx_trial *best = &s->trial[s->best];
    if (best->err || t->criterion < best->criterion)
        s->best = (uint16_t)(s->trials - 1u);
}

/* ---- rounds: the best with one coefficient less at either end of an input ---- */

static void begin_round(struct arx_selecting *g)
{
    g->before = g->search->best;
    g->from = g->search->trial[g->before].orders;
    g->input = g->end = 0;
    g->stage = SELECT_DROP;
}

/* The next of the round; behind the last the next round, if one of them was better. */
static void drop_one(struct arx_selecting *g)
{
    struct arx_orders o = g->from;
    uint8_t j = g->input;
    if (j >= g->rows.data->inputs) {
        g->round++;
        if (g->search->best != g->before && g->round < DIFFERENCE_MOST * DIFFERENCE_B_MOST)
            begin_round(g);
        else
            g->stage = SELECT_OVER;
        return;
    }
    if (o.last[j] > 0) {
        if (o.first[j] == o.last[j])
            o.first[j] = o.last[j] = 0;
        else if (g->end == 0)
            o.first[j]++;
        else
            o.last[j]--;
        try_orders(g, &o);
    }
    g->input = (uint8_t)(j + g->end);
    g->end = !g->end;
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

/* ---- the grid ---- */

static void begin_grid(struct arx_selecting *g)
{
    struct arx_search *s = g->search;
    s->rows = g->rows.rows;
    s->of_y = squares_of_y(&s->work.triangle);
    g->at = g->all;
    g->at.na = 0;
    g->nb = 1;
    g->stage = SELECT_GRID;
}

static void try_next(struct arx_selecting *g)
{
    for (size_t j = 0; j < g->rows.data->inputs; j++)
        g->at.last[j] = g->nb;
    try_orders(g, &g->at);
    g->nb++;
    if (g->nb > g->all.last[0]) {
        g->nb = 1;
        g->at.na++;
    }
    if (g->at.na <= g->all.na)
        return;
    g->err = g->search->trial[g->search->best].err ? ERR_SINGULAR : ERR_OK;
    if (g->err)
        g->stage = SELECT_OVER;
    else
        begin_round(g);
}

/* ---- all of it ---- */

void arx_select_begin(struct arx_selecting *g, const struct arx_data *d, uint8_t output, uint8_t na,
                      uint8_t nb, bool constant, enum arx_criterion criterion, uint32_t from,
                      uint32_t to, struct arx_search *s)
{
    memset(g, 0, sizeof *g);
    g->search = s;
    g->criterion = (uint8_t)criterion;
    g->all = (struct arx_orders){.na = na, .constant = constant};
    s->trials = s->best = 0;
    g->err = na > DIFFERENCE_A_MOST || nb < 1 || nb > DIFFERENCE_B_MOST ? ERR_RANGE : ERR_OK;
    for (size_t j = 0; !g->err && j < d->inputs; j++) {
        g->all.first[j] = 1;
        g->all.last[j] = nb;
    }
    if (!g->err)
        g->err = arx_collect_begin(&g->rows, d, output, &g->all, from, to,
                                   (uint32_t)arx_before(&g->all, d->inputs), &s->work);
    g->rows.data = d;
    if (g->err)
        g->stage = SELECT_OVER;
}

bool arx_select_piece(struct arx_selecting *g, uint32_t most)
{
    if (g->stage == SELECT_ROWS && g->rows.k < g->rows.to)
        (void)arx_collect_piece(&g->rows, most);
    else if (g->stage == SELECT_ROWS)
        begin_grid(g);
    else if (g->stage == SELECT_GRID)
        try_next(g);
    else if (g->stage == SELECT_DROP)
        drop_one(g);
    return g->stage != SELECT_OVER;
}

enum err arx_select(const struct arx_data *d, uint8_t output, uint8_t na, uint8_t nb, bool constant,
                    enum arx_criterion criterion, uint32_t from, uint32_t to, struct arx_search *s)
{
    struct arx_selecting g;
    arx_select_begin(&g, d, output, na, nb, constant, criterion, from, to, s);
    /* Rounds end by themselves; each has two trials of an input and one piece that ends it. */
    unsigned pieces =
        3u + ARX_TRIALS + DIFFERENCE_MOST * DIFFERENCE_B_MOST * (2u * DIFFERENCE_MOST + 1u);
    for (unsigned piece = 0; piece < pieces && arx_select_piece(&g, to - from); piece++)
        ;
    return g.err;
}

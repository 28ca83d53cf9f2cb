/* Complete innovation: what a temperature says moves every mole fraction and what nobody measures of the feed, by gains that were found
 * from their covariance (kinds/composition/composition_job.c). Scalar by scalar, Frau (7.5): each deviation is taken after the ones before it
 * have moved the estimate. */
#include "kinds/composition/composition.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

/* The feed as it is found cannot be more than so many times what it is said to be, nor less than that part of it. */
#define FEED_MOST  REAL_C(2.0)
#define FEED_LEAST REAL_C(0.25)

void composition_stands_here(struct composition *c)
{
    if (c->column.config == &c->table.config)
        return;
    column_table_moved(&c->table);
    c->column.config = &c->table.config;
    c->column.vle.component = c->table.config.component;
    c->column.vle.activity_context = c->table.config.activity_context;
}

static real_t kept_within(real_t x, real_t lo, real_t hi)
{
    return x < lo ? lo : x > hi ? hi : x;
}

void composition_inputs(const struct composition *c, struct column_inputs *inputs)
{
    const struct composition_gains *g = &c->gains;
    size_t m = c->table.config.components - 1;
    *inputs = c->inputs;
    if (g->has_feed) {
        real_t room = ONE;
        for (size_t j = 0; j < m; j++) {
            inputs->feed_fraction[j] =
                kept_within(inputs->feed_fraction[j] + g->extra[j], ZERO, room);
            room -= inputs->feed_fraction[j];
        }
        inputs->feed_fraction[m] = room;
    }
    if (g->has_flow)
        inputs->feed_flow *= ONE + g->extra[g->feed - 1u];
}

/* The feed's composition also changes the moles of a flow that is given by mass or volume. */
void composition_push(const struct composition_gains *g, struct column *column, const real_t *x,
                      real_t *push, real_t *flow, real_t *work)
{
    size_t n = column->n_fractions, m = column->config->components - 1;
    if (!g->feed)
        return;
    bool by_flow = g->has_flow || column->inputs.feed_basis != COLUMN_FLOW_MOLAR;
    if (by_flow)
        column_feed_flow_slope(column, x, flow, work);
    for (size_t j = 0; g->has_feed && j < m; j++, push += n) {
        real_t moles = column_feed_moles_slope(column, j);
        column_feed_slopes(column, x, j, push);
        for (size_t i = 0; by_flow && i < n; i++)
            push[i] = real_fma(moles, flow[i], push[i]);
    }
    for (size_t i = 0; g->has_flow && i < n; i++)
        push[i] = flow[i];
}

/* What is found of the feed stays something a feed can be: otherwise it would have to come all the way back. */
static void keep_feed_possible(struct composition *c)
{
    struct composition_gains *g = &c->gains;
    size_t m = c->table.config.components - 1;
    for (size_t j = 0; g->has_feed && j < m; j++)
        g->extra[j] =
            kept_within(g->extra[j], -c->inputs.feed_fraction[j], ONE - c->inputs.feed_fraction[j]);
    if (g->has_flow)
        g->extra[g->feed - 1u] =
            kept_within(g->extra[g->feed - 1u], FEED_LEAST - ONE, FEED_MOST - ONE);
}

void composition_move_extras(struct composition *c, const real_t *gain, real_t e)
{
    for (size_t k = 0; k < c->gains.extras; k++)
        c->gains.extra[k] = real_fma(gain[c->column.n_fractions + k], e, c->gains.extra[k]);
    keep_feed_possible(c);
}

void composition_innovate(struct composition *c, struct composition_sensor *s, unsigned k,
                          const real_t *dt)
{
    size_t n = c->column.n_fractions, m = c->table.config.components - 1;
    const real_t *gain = c->gains.of + k * composition_moved(c);
    real_t e = s->e, drawn = ZERO;
    for (size_t i = 0; i < n; i++)
        c->blocks.change[i] = real_fma(gain[i], e, c->blocks.change[i]);
    composition_move_extras(c, gain, e);
    for (size_t j = 0; j < m; j++)
        drawn += dt[j] * gain[s->stage * m + j];
    s->correction = drawn * e / c->h;
}

#include "columns/newton_holdups.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Derivatives of the flows by relative holdups, mol/s. Where a holdup does not move they are 0. */
struct slopes {
    double reflux, distillate; /* by the drum's */
    double boilup, bottoms;    /* by the reboiler's */
    double internal;           /* internal reflux by reflux */
    /* by the boil-up: 1 where subcooled reflux condenses all vapour there is, else 0 */
    double condensed;
};

struct tray {
    double by_holdup; /* of the liquid leaving it, by its relative holdup, mol/s */
    double by_vapour; /* the same by the vapour reaching it */
};

/* Changes on a stage with the holdups, of the last solution. */
struct change {
    double relative, liquid_in, vapour_in, vapour_out;
};

struct newton_holdups {
    const struct column_config *config;
    size_t stages, m;
    bool levels, trays, held;
    double a, c;
    struct slopes slopes;
    struct tray *tray;     /* [stages] */
    double *pull;          /* [stages 4 m], what a stage's rates gain by one of struct change */
    double *by_reboiler;   /* [stages] of each relative holdup, by the reboiler's */
    double reboiler_pivot; /* what the reboiler's row comes down to */
    struct change *change; /* [stages] */
    double *right;         /* [stages m] */
};

struct newton_holdups *newton_holdups_create(const struct column_config *config)
{
    struct newton_holdups *h = calloc(1, sizeof *h);
    if (!h)
        return NULL;
    h->config = config;
    h->stages = config->stages;
    h->m = config->components - 1;
    h->levels = config->levels == COLUMN_LEVELS_HOLDUPS;
    h->trays = config->hydraulic_time > 0.0;
    h->tray = calloc(h->stages, sizeof *h->tray);
    h->pull = calloc(h->stages * 4 * h->m, sizeof(double));
    h->by_reboiler = calloc(h->stages, sizeof(double));
    h->change = calloc(h->stages, sizeof *h->change);
    h->right = calloc(h->stages * h->m, sizeof(double));
    if (h->tray && h->pull && h->by_reboiler && h->change && h->right)
        return h;
    newton_holdups_destroy(h);
    return NULL;
}

void newton_holdups_destroy(struct newton_holdups *h)
{
    if (!h)
        return;
    free(h->tray);
    free(h->pull);
    free(h->by_reboiler);
    free(h->change);
    free(h->right);
    free(h);
}

/* Slope of part(relative) * flow, where the flow itself moves by flow_slope and runs empty below the softness. */
static double given_slope(const struct newton_holdups *h, double relative, double flow,
                          double flow_slope)
{
    double soft = h->config->limit_softness;
    if (relative >= soft)
        return flow_slope;
    return flow / soft + fmax(relative, 0.0) / soft * flow_slope;
}

static void read_vessels(struct newton_holdups *h, const struct column *column, const double *x)
{
    const struct column_config *config = h->config;
    const struct column_flows *f = &column->flows;
    double drum = column_relative_holdup(column, x, h->stages - 1);
    double reboiler = column_relative_holdup(column, x, 0);
    const struct {
        double *slope;
        const struct column_level *level;
        enum column_level_by by;
        double wanted, relative, nominal;
    } flows[] = {
        {&h->slopes.reflux, &config->condenser_level, COLUMN_LEVEL_BY_INTERNAL, f->reflux_wanted,
         drum, config->holdup_condenser},
        {&h->slopes.distillate, &config->condenser_level, COLUMN_LEVEL_BY_PRODUCT,
         f->distillate_wanted, drum, config->holdup_condenser},
        {&h->slopes.boilup, &config->reboiler_level, COLUMN_LEVEL_BY_INTERNAL, f->boilup_wanted,
         reboiler, config->holdup_reboiler},
        {&h->slopes.bottoms, &config->reboiler_level, COLUMN_LEVEL_BY_PRODUCT, f->bottoms_wanted,
         reboiler, config->holdup_reboiler},
    };
    for (size_t i = 0; i < 4; i++) {
        bool moved = flows[i].level->by == flows[i].by && flows[i].wanted > 0.0;
        *flows[i].slope = given_slope(h, flows[i].relative, flows[i].wanted,
                                      moved ? flows[i].level->gain * flows[i].nominal : 0.0);
    }
    if (drum > config->level_capacity)
        h->slopes.distillate += COLUMN_OVERFLOW_RATE * config->holdup_condenser;
    if (reboiler > config->level_capacity)
        h->slopes.bottoms += COLUMN_OVERFLOW_RATE * config->holdup_reboiler;
    bool all = f->condensed_by_reflux >= f->vapour_enriching;
    h->slopes.internal = f->reflux > 0.0 && !all ? 1.0 + f->condensed_by_reflux / f->reflux : 1.0;
    h->slopes.condensed = all ? 1.0 : 0.0;
}

static void read_trays(struct newton_holdups *h, const struct column *column, const double *x)
{
    const struct column_config *config = h->config;
    double by_holdup = config->holdup_tray / config->hydraulic_time;

    for (size_t s = 1; s + 1 < h->stages; s++) {
        double relative = column_relative_holdup(column, x, s), soft = config->limit_softness;
        double given = relative >= soft ? 1.0 : fmax(relative, 0.0) / soft;
        bool flows = column->liquid[s] > 0.0;
        double flow = flows ? column->liquid[s] / given : 0.0;
        h->tray[s].by_holdup = flows ? given_slope(h, relative, flow, by_holdup) : 0.0;
        h->tray[s].by_vapour = flows ? given * config->hydraulic_vapour : 0.0;
    }
}

/* Slopes of the rates of a stage's mole fractions by each part of struct change. */
static void read_pull(struct newton_holdups *h, const struct column *column, const double *x,
                      size_t s)
{
    size_t m = h->m, c = m + 1, top = h->stages - 1;
    const double *here = &x[s * m], *v = &column->vapour[s * c];
    double *relative = &h->pull[s * 4 * m], *liquid = relative + m, *in = liquid + m, *out = in + m;
    double nominal = s == 0     ? h->config->holdup_reboiler
                     : s == top ? h->config->holdup_condenser
                                : h->config->holdup_tray;
    bool moves = column_holdup_state(column, s) < column->n_states,
         fed = s + 1 == h->config->feed_stage;

    for (size_t j = 0; j < m; j++) {
        liquid[j] = s == top ? 0.0 : here[m + j] - here[j];
        in[j] = s == 0 ? 0.0 : v[j - c] - here[j];
        out[j] = here[j] - v[j];
        double net = column->vapour_flow[s] * out[j];
        if (s < top)
            net += column->liquid[s + 1] * liquid[j];
        if (s > 0)
            net += column->vapour_flow[s - 1] * in[j];
        if (fed)
            net += column->flows.feed * (column->inputs.feed_fraction[j] - here[j]);
        relative[j] = moves ? -nominal * net / column->holdup[s] : 0.0;
    }
    for (size_t j = 0; j < 4 * m; j++)
        relative[j] /= column->holdup[s];
}

void newton_holdups_read(struct newton_holdups *h, const struct column *column, const double *x)
{
    if (h->levels)
        read_vessels(h, column, x);
    if (h->trays)
        read_trays(h, column, x);
    for (size_t s = 0; s < h->stages; s++)
        read_pull(h, column, x, s);
}

void newton_holdups_copy(const struct newton_holdups *from, struct newton_holdups *to)
{
    to->slopes = from->slopes;
    to->held = from->held;
    memcpy(to->tray, from->tray, from->stages * sizeof *from->tray);
    memcpy(to->pull, from->pull, from->stages * 4 * from->m * sizeof(double));
}

void newton_holdups_hold(struct newton_holdups *h, bool held)
{
    h->held = held;
}

static bool constant(const struct newton_holdups *h, const struct column_level *level)
{
    return h->held && level->by == COLUMN_LEVEL_FREE;
}

static double drum_pivot(const struct newton_holdups *h)
{
    const struct slopes *of = &h->slopes;
    double out = of->internal * of->reflux + of->distillate;
    return h->a * h->config->holdup_condenser -
           (constant(h, &h->config->condenser_level) ? 0.0 : h->c * out);
}

static double tray_pivot(const struct newton_holdups *h, size_t s)
{
    return h->a * h->config->holdup_tray - h->c * h->tray[s].by_holdup;
}

static bool usable(double pivot)
{
    return fabs(pivot) > 0.0 && fabs(pivot) < 1e300;
}

/* By the reboiler's holdup alone, from the drum down. */
bool newton_holdups_factor(struct newton_holdups *h, double a, double c)
{
    const struct slopes *of = &h->slopes;
    size_t top = h->stages - 1;
    double liquid = 0.0; /* coming down, by the reboiler's holdup */

    h->a = a;
    h->c = c;
    h->reboiler_pivot = 1.0;
    if (h->levels) {
        double pivot = drum_pivot(h);
        if (!usable(pivot))
            return false;
        h->by_reboiler[top] = constant(h, &h->config->condenser_level)
                                  ? 0.0
                                  : -c * (1.0 - of->condensed) * of->boilup / pivot;
        liquid = of->internal * of->reflux * h->by_reboiler[top] + of->condensed * of->boilup;
    }
    for (size_t s = top; h->trays && s-- > 1;) {
        double pivot = tray_pivot(h, s), driven = h->tray[s].by_vapour * of->boilup;
        if (!usable(pivot))
            return false;
        h->by_reboiler[s] = c * (driven - liquid) / pivot;
        liquid = h->tray[s].by_holdup * h->by_reboiler[s] + driven;
    }
    if (!h->levels)
        return true;
    h->by_reboiler[0] = 1.0;
    h->reboiler_pivot = a * h->config->holdup_reboiler;
    if (!constant(h, &h->config->reboiler_level))
        h->reboiler_pivot += c * (liquid - of->boilup - of->bottoms);
    return usable(h->reboiler_pivot);
}

/* Changes of the flows of all stages, from those of the holdups. */
static void flows_change(const struct newton_holdups *h)
{
    const struct slopes *of = &h->slopes;
    struct change *change = h->change;
    size_t top = h->stages - 1;
    double reflux = of->reflux * change[top].relative, boilup = of->boilup * change[0].relative;
    double condensed = (of->internal - 1.0) * reflux + of->condensed * boilup;
    double liquid = reflux + condensed; /* coming down */

    for (size_t s = top + 1; s-- > 0;) {
        change[s].vapour_out = s == top ? 0.0 : boilup;
        change[s].vapour_in = s == 0 ? 0.0 : boilup;
        change[s].liquid_in = s == top ? 0.0 : liquid;
        if (h->trays && s < top)
            liquid = h->tray[s].by_holdup * change[s].relative + h->tray[s].by_vapour * boilup;
    }
    /* subcooled reflux condenses vapour on the top tray, which adds to what comes down from there */
    change[top].vapour_in -= condensed;
    change[top - 1].vapour_out = change[top].vapour_in;
    change[top - 1].liquid_in = reflux;
}

/* Takes the effect of the changes on the rates of the mole fractions off b. */
static const double *shifted(const struct newton_holdups *h, const double *b)
{
    size_t m = h->m;

    for (size_t s = 0; s < h->stages; s++) {
        const struct change *by = &h->change[s];
        const double *pull = &h->pull[s * 4 * m];
        for (size_t j = 0; j < m; j++)
            h->right[s * m + j] =
                b[s * m + j] -
                h->c * (pull[j] * by->relative + pull[m + j] * by->liquid_in +
                        pull[2 * m + j] * by->vapour_in + pull[3 * m + j] * by->vapour_out);
    }
    return h->right;
}

const double *newton_holdups_solve(const struct newton_holdups *h, const double *all, double *x)
{
    const double *b = all + h->stages * h->m;
    double *holdup = x + h->stages * h->m;
    const struct slopes *of = &h->slopes;
    struct change *change = h->change;
    size_t top = h->stages - 1, first = h->levels ? 0 : 1;
    double liquid = 0.0; /* coming down, apart from what the reboiler's holdup does */

    if (h->levels) {
        change[top].relative = h->config->holdup_condenser * b[h->trays ? top : 1] / drum_pivot(h);
        liquid = of->internal * of->reflux * change[top].relative;
    }
    for (size_t s = top; h->trays && s-- > 1;) {
        double right = h->config->holdup_tray * b[s - first] - h->c * liquid;
        change[s].relative = right / tray_pivot(h, s);
        liquid = h->tray[s].by_holdup * change[s].relative;
    }
    if (h->levels) {
        double right = h->config->holdup_reboiler * b[0];
        if (!constant(h, &h->config->reboiler_level))
            right -= h->c * liquid;
        double reboiler = right / h->reboiler_pivot;
        for (size_t s = 1; s <= top; s++)
            change[s].relative += h->by_reboiler[s] * reboiler;
        change[0].relative = reboiler;
        holdup[0] = reboiler;
        holdup[h->trays ? top : 1] = change[top].relative;
    }
    for (size_t s = 1; h->trays && s < top; s++)
        holdup[s - first] = change[s].relative;
    flows_change(h);
    return shifted(h, all);
}

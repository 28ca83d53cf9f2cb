#include "columns/column_carry.h"

/* One list of fields serves both ways, so that they cannot differ. */
struct carrier {
    double *write;      /* the next one, written */
    const double *read; /* or read */
};

static void real(struct carrier *k, real_t *x)
{
    if (k->write)
        *k->write++ = (double)*x;
    else if (k->read)
        *x = (real_t)*k->read++;
}

static void reals(struct carrier *k, real_t *x, size_t n)
{
    for (size_t i = 0; i < n; i++)
        real(k, &x[i]);
}

static void whole(struct carrier *k, size_t *x)
{
    real_t value = (real_t)*x;
    real(k, &value);
    *x = (size_t)value;
}

static void component(struct carrier *k, struct component *c)
{
    reals(k, c->antoine, 7);
    real(k, &c->molar_mass);
    reals(k, c->density, 2);
    real(k, &c->vaporisation_heat);
    real(k, &c->boiling_point);
    real(k, &c->critical_temperature);
    real(k, &c->heat_capacity);
}

static void level(struct carrier *k, struct column_level *l)
{
    size_t by = l->by;
    whole(k, &by);
    l->by = (enum column_level_by)by;
    real(k, &l->gain);
}

static void config(struct carrier *k, struct column_config *c)
{
    size_t holdup = c->holdup, levels = c->levels;

    whole(k, &c->stages);
    whole(k, &c->components);
    whole(k, &c->feed_stage);
    real(k, &c->efficiency);
    real(k, &c->pressure_drop);
    whole(k, &holdup);
    c->holdup = (enum column_holdup)holdup;
    real(k, &c->holdup_reboiler);
    real(k, &c->holdup_tray);
    real(k, &c->holdup_condenser);
    real(k, &c->holdup_temperature_bottom);
    real(k, &c->holdup_temperature_top);
    real(k, &c->temperature_min);
    real(k, &c->temperature_max);
    real(k, &c->limit_softness);
    real(k, &c->hydraulic_time);
    real(k, &c->hydraulic_vapour);
    whole(k, &levels);
    c->levels = (enum column_levels)levels;
    level(k, &c->condenser_level);
    level(k, &c->reboiler_level);
    real(k, &c->level_capacity);
}

/* activity.components 0: an ideal liquid. Absent tables are carried as zeros, which mean the same. */
static void activity(struct carrier *k, struct column_carried *c)
{
    size_t model = c->activity.model, n = c->activity.components;

    whole(k, &model);
    whole(k, &n);
    c->activity.model = (enum activity_model)model;
    c->activity.components = n;
    reals(k, c->a, n * n);
    reals(k, c->b, n * n);
    reals(k, c->alpha, n * n);
}

/* Reference of level controllers and hydraulics. */
static void flows(struct carrier *k, struct column_flows *f)
{
    real(k, &f->reflux);
    real(k, &f->distillate);
    real(k, &f->bottoms);
    real(k, &f->liquid_enriching);
    real(k, &f->liquid_stripping);
    real(k, &f->vapour_enriching);
    real(k, &f->vapour_stripping);
    real(k, &f->vapour_top);
}

static void carry(struct carrier *k, struct column_carried *c)
{
    config(k, &c->config);
    for (size_t j = 0; j < c->config.components; j++)
        component(k, &c->component[j]);
    activity(k, c);
    flows(k, &c->reference);
}

static void copy_table(const real_t *from, real_t *to, size_t n)
{
    for (size_t i = 0; i < n * n && from; i++)
        to[i] = from[i];
}

bool column_carry_out(const struct column_config *of, const struct column_flows *reference,
                      double *number)
{
    struct carrier k = {.write = number};
    struct column_carried copy = {.config = *of, .reference = *reference};

    if (of->activity && of->activity != activity_coefficients)
        return false;
    for (size_t j = 0; j < of->components; j++)
        copy.component[j] = of->component[j];
    if (of->activity) {
        const struct activity *from = of->activity_context;
        copy.activity = *from;
        copy_table(from->a, copy.a, from->components);
        copy_table(from->b, copy.b, from->components);
        copy_table(from->alpha, copy.alpha, from->components);
    }
    carry(&k, &copy);
    return true;
}

void column_carry_in(const double *number, struct column_carried *to)
{
    struct carrier k = {.read = number};

    *to = (struct column_carried){0};
    carry(&k, to);
    to->config.component = to->component;
    if (to->activity.components > 0) {
        to->activity.a = to->a;
        to->activity.b = to->b;
        to->activity.alpha = to->alpha;
        to->config.activity = activity_coefficients;
        to->config.activity_context = &to->activity;
    }
}

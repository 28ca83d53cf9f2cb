/* What `block N` shows of the kind `composition`. */
#include "kinds/composition/composition_block.h"

enum { VALUE_E, VALUE_PULL, VALUE_NIS, VALUE_RHO, VALUE_SLOPE, VALUES };

static const char *const of_sensor[VALUES][SENSORS_MAX] = {
    {"e_1", "e_2", "e_3", "e_4", "e_5", "e_6", "e_7", "e_8", "e_9", "e_10", "e_11", "e_12"},
    {"pull_1", "pull_2", "pull_3", "pull_4", "pull_5", "pull_6", "pull_7", "pull_8", "pull_9",
     "pull_10", "pull_11", "pull_12"},
    {"nis_1", "nis_2", "nis_3", "nis_4", "nis_5", "nis_6", "nis_7", "nis_8", "nis_9", "nis_10",
     "nis_11", "nis_12"},
    {"rho_1", "rho_2", "rho_3", "rho_4", "rho_5", "rho_6", "rho_7", "rho_8", "rho_9", "rho_10",
     "rho_11", "rho_12"},
    {"slope_1", "slope_2", "slope_3", "slope_4", "slope_5", "slope_6", "slope_7", "slope_8",
     "slope_9", "slope_10", "slope_11", "slope_12"},
};
_Static_assert(SENSORS_MAX == 12, "names");

static float value_of(const struct composition_sensor *s, unsigned which)
{
    switch (which) {
    case VALUE_E:
        return s->e;
    case VALUE_PULL:
        return s->pull;
    case VALUE_NIS:
        return s->square;
    case VALUE_RHO:
        return s->square > 0 ? s->product / s->square : 0;
    default:
        return s->slope;
    }
}

/* What complete innovation has besides: how sure the points are, what was found of the feed, and whether there is a workspace. */
static const char *filter_value(const struct composition_block *b, size_t i, float *value)
{
    static const char *const sd[] = {"sd_1", "sd_2", "sd_3", "sd_4",
                                     "sd_5", "sd_6", "sd_7", "sd_8"};
    static const char *const feed[] = {"feed_1", "feed_2", "feed_3"};
    _Static_assert(sizeof sd / sizeof sd[0] == BLOCK_POINTS_MAX, "names");
    _Static_assert(sizeof feed / sizeof feed[0] == COLUMN_COMPONENTS_MAX - 1, "names");
    static const char *const fixed[] = {"workspace", "cycles", "sd_least", "sd_most"};
    const float fixed_values[] = {b->filter.job ? 1.0f : 0.0f, (float)b->filter.count,
                                  b->filter.least, b->filter.most};
    const struct composition_gains *g = &b->c.gains;
    size_t n = sizeof fixed / sizeof fixed[0];
    if (i < n) {
        *value = fixed_values[i];
        return fixed[i];
    }
    i -= n;
    if (i < b->points) {
        *value = composition_point_sd(b, (unsigned)i);
        return sd[i];
    }
    i -= b->points;
    if (i >= g->feed)
        return NULL;
    *value = g->extra[i];
    return g->has_flow && i + 1u == g->feed ? "feed_flow" : feed[i];
}

const char *composition_describe(const void *state, size_t i, float *value)
{
    const struct composition_block *b = state;
    const struct column_flows *f = &b->c.column.flows;
    static const char *const names[] = {"states", "clipped", "bounced", "distillate", "bottoms"};
    const float values[] = {(float)column_table_states(&b->c.table), (float)b->c.clipped,
                            (float)b->c.bounced, f->distillate, f->bottoms};
    size_t fixed = sizeof values / sizeof values[0];
    if (i < fixed) {
        *value = values[i];
        return names[i];
    }
    static const char *const corrections[ANALYSES_MAX] = {"correction_1", "correction_2"};
    size_t sensor = (i - fixed) / VALUES, which = (i - fixed) % VALUES;
    if (sensor >= b->c.sensors) {
        size_t k = i - fixed - (size_t)b->c.sensors * VALUES;
        if (k < b->analyses) {
            *value = b->analysis[k].correction;
            return corrections[k];
        }
        return composition_is_complete(&b->c) ? filter_value(b, k - b->analyses, value) : NULL;
    }
    const struct composition_sensor *s = &b->c.sensor[sensor];
    *value = value_of(s, (unsigned)which);
    return of_sensor[which][s->input];
}

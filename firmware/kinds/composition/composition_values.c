#include "kinds/composition/composition_values.h"

#include "kinds/composition/composition_filter.h"
#include "kinds/composition/composition_judge.h"

enum { VALUE_E, VALUE_PULL, VALUE_NIS, VALUE_RHO, VALUE_SLOPE, VALUES };

static const char *const sensor_names[VALUES][SENSORS_MAX] = {
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

static float sensor_value(const struct composition_parts *p, unsigned k, unsigned which)
{
    switch (which) {
    case VALUE_E:
        return composition_sensors_e(p->sensors, k);
    case VALUE_PULL:
        return composition_watch_pull(p->watch, k);
    case VALUE_NIS:
        return composition_watch_square(p->watch, k);
    case VALUE_RHO:
        return composition_watch_correlation(p->watch, k);
    default:
        return composition_sensors_slope(p->sensors, k);
    }
}

/* Complete innovation: the workspace, how sure the points are, and what was found of the feed. */
static const char *filter_value(const struct composition_parts *p, size_t i, float *value)
{
    static const char *const sd[] = {"sd_1", "sd_2", "sd_3", "sd_4",
                                     "sd_5", "sd_6", "sd_7", "sd_8"};
    static const char *const feed[] = {"feed_1", "feed_2", "feed_3"};
    _Static_assert(sizeof sd / sizeof sd[0] == BLOCK_POINTS_MAX, "names");
    _Static_assert(sizeof feed / sizeof feed[0] == COLUMN_COMPONENTS_MAX - 1, "names");
    const char *fixed = composition_filter_describe(p->filter, i, value);
    if (fixed)
        return fixed;
    i -= COMPOSITION_FILTER_VALUES;
    if (i < p->points) {
        *value = composition_judge_sd(p, (unsigned)i);
        return sd[i];
    }
    i -= p->points;
    if (i >= composition_model_feed_extras(p->model))
        return NULL;
    *value = composition_model_extra(p->model, i);
    return composition_model_is_flow(p->model, i) ? "feed_flow" : feed[i];
}

const char *composition_values(const struct composition_parts *p, size_t i, float *value)
{
    static const char *const corrections[ANALYSES_MAX] = {"correction_1", "correction_2"};
    const char *fixed = composition_model_describe(p->model, i, value);
    if (fixed)
        return fixed;
    i -= COMPOSITION_MODEL_VALUES;
    unsigned sensor = (unsigned)(i / VALUES), which = (unsigned)(i % VALUES);
    if (sensor < composition_sensors_count(p->sensors)) {
        *value = sensor_value(p, sensor, which);
        return sensor_names[which][composition_sensors_input(p->sensors, sensor) - 1u];
    }
    i -= (size_t)composition_sensors_count(p->sensors) * VALUES;
    size_t analyses = composition_analyses_count(p->analyses);
    if (i < analyses) {
        *value = composition_analyses_correction(p->analyses, (unsigned)i);
        return corrections[i];
    }
    return composition_is_complete(p->settings) ? filter_value(p, i - analyses, value) : NULL;
}

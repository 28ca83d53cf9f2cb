#include "columns/column_profile.h"

#include <stdio.h>

#include "columns/column_plant.h"

/* The columns of the table that are no compositions. */
enum { STAGE, TEMPERATURE, DIFFERENCE, LIQUID_FLOW, VAPOUR_FLOW, HOLDUP, FIELDS };
static const char *const name_of[FIELDS] = {"stage", "T", "dT", "liquid", "vapour", "holdup"};
static const char *const unit_of[FIELDS] = {"", "[K]", "[K]", "[mol/s]", "[mol/s]", "[mol]"};

static double field(const struct column *c, const double *x, size_t s, int which)
{
    switch (which) {
    case STAGE:
        return (double)(s + 1);
    case TEMPERATURE:
        return c->temperature[s];
    case DIFFERENCE: /* to the stage below */
        return s > 0 ? c->temperature[s] - c->temperature[s - 1] : 0.0;
    case LIQUID_FLOW:
        return c->liquid[s];
    case VAPOUR_FLOW:
        return c->vapour_flow[s];
    default:
        return column_terms_holdup(c, x, s);
    }
}

/* No vapour leaves the condenser. */
static bool has_vapour(const struct column *c, size_t s)
{
    return s + 1 < c->config->stages;
}

static void print_csv(const struct column *c, const double *x)
{
    const struct column_config *config = c->config;
    for (int k = 0; k < FIELDS; k++) {
        (void)printf("%s%s%s", k > 0 ? "," : "", name_of[k], unit_of[k]);
    }
    for (int phase = 0; phase < 2; phase++) {
        for (size_t j = 0; j < config->components; j++) {
            (void)printf(",%c.%s", phase == 0 ? 'x' : 'y', config->component[j].name);
        }
    }
    for (size_t s = 0; s < config->stages; s++) {
        (void)printf("\n%zu", s + 1);
        for (int k = STAGE + 1; k < FIELDS; k++) {
            (void)printf(",%.12g", field(c, x, s, k));
        }
        for (size_t j = 0; j < config->components; j++) {
            (void)printf(",%.12g", column_fraction(c, x, s, j));
        }
        for (size_t j = 0; j < config->components; j++) {
            if (has_vapour(c, s)) {
                (void)printf(",%.12g", c->vapour[s * config->components + j]);
            } else {
                (void)printf(",");
            }
        }
    }
    (void)printf("\n");
}

static void print_json(const struct plant_class *class, const struct column *c, const double *x)
{
    const struct column_config *config = c->config;
    (void)printf("{\n  \"plant\": \"%s\",\n  \"feed_stage\": %zu,\n  \"components\": [",
                 class->name, config->feed_stage);
    for (size_t j = 0; j < config->components; j++) {
        (void)printf("%s\"%s\"", j > 0 ? ", " : "", config->component[j].name);
    }
    (void)printf("],\n  \"stages\": [");
    for (size_t s = 0; s < config->stages; s++) {
        (void)printf("%s\n    {", s > 0 ? "," : "");
        for (int k = 0; k < FIELDS; k++) {
            (void)printf("\"%s\": %.17g, ", name_of[k], field(c, x, s, k));
        }
        for (int phase = 0; phase < (has_vapour(c, s) ? 2 : 1); phase++) {
            (void)printf("%s\"%c\": [", phase > 0 ? ", " : "", phase == 0 ? 'x' : 'y');
            for (size_t j = 0; j < config->components; j++) {
                (void)printf("%s%.17g", j > 0 ? ", " : "",
                             phase == 0 ? column_fraction(c, x, s, j)
                                        : c->vapour[s * config->components + j]);
            }
            (void)printf("]");
        }
        (void)printf("}");
    }
    (void)printf("\n  ]\n}\n");
}

void column_profile_print(const struct plant_class *class, const struct plant *p, bool json)
{
    const struct column *c = column_plant_column(p);
    const double *x = column_plant_state(p);
    if (json) {
        print_json(class, c, x);
    } else {
        print_csv(c, x);
    }
}

/* Balances of the columns as plants: at rest every equation to the solver's tolerance, and in motion every component
 * from what flows in, what flows out and what is in the column. */
#include "columns/column_plant.h"
#include "plants/plant_library.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define STAGES_MAX     37
#define COMPONENTS_MAX 6

/* Numbers that a plant's channels do not tell, from plants/pilot.json and plants/splitter.json. */
struct subject {
    const char *name;
    size_t stages, components;
    double (*holdup)(const double *x, size_t stage); /* mol; x full composition */
    void (*flows)(double feed[], double *distillate,
                  double *bottoms); /* mol/s, by component for the feed */
    const char *heat, *feed;
    double heat_step, feed_step;
};

static const struct plant_class *class;
static const struct component *property; /* of its components */
static struct plant *plant;
static char err[256];
static double x[STAGES_MAX][COMPONENTS_MAX];

static size_t channel(const char *name)
{
    for (size_t i = 0; i < class->n_channels; i++)
        if (strcmp(class->channels[i].name, name) == 0)
            return i;
    TEST_FAIL_MESSAGE(name);
    return 0;
}

static double get(const char *name)
{
    return class->value(plant, channel(name));
}

static void set(const char *name, double value)
{
    TEST_ASSERT_TRUE_MESSAGE(class->set_input(plant, channel(name), value, err, sizeof err), err);
}

static double pilot_holdup(const double *at, size_t stage)
{
    (void)at;
    return stage == 0 ? 1.5 * 9.1 : stage == 11 ? 0.15 * 10.3 : 0.025 * 9.7;
}

static void pilot_flows(double feed[], double *distillate, double *bottoms)
{
    const double litre_per_hour = 1e-3 / 3600.0;
    double w[2] = {get("xF"), 100.0 - get("xF")}, z[2];
    mole_from_mass_fractions(property, 2, w, z);
    double f = get("F") * litre_per_hour / mixture_molar_volume(property, 2, z, get("TF") + 273.15);
    feed[0] = f * z[0];
    feed[1] = f * z[1];
    /* the drum's bubble point is not among the channels: all that is not bottoms is distillate */
    *bottoms =
        get("B") * litre_per_hour / mixture_molar_volume(property, 2, x[0], get("TB") + 273.15);
    *distillate = f - *bottoms;
}

static double splitter_holdup(const double *at, size_t stage)
{
    double t = 375.0 + (322.0 - 375.0) * (double)stage / 36.0;
    return (stage == 0 || stage == 36 ? 4.0 : 0.2) / mixture_molar_volume(property, 6, at, t);
}

static void splitter_flows(double feed[], double *distillate, double *bottoms)
{
    static const char *const name[6] = {"zC2", "zC3", "ziC4", "ziC5", "znC5", "znC4"};
    double z[6], sum = 0.0;
    for (int j = 0; j < 6; j++)
        sum += z[j] = get(name[j]);
    for (int j = 0; j < 6; j++)
        z[j] /= sum;
    double f = get("F") / 3600.0 / mixture_molar_volume(property, 6, z, get("TF"));
    for (int j = 0; j < 6; j++)
        feed[j] = f * z[j];
    *distillate = get("D") / 3.6;
    *bottoms = get("B") / 3.6;
}

static const struct subject pilot = {"pilot", 12,  2,    pilot_holdup, pilot_flows,
                                     "Qrb",   "F", 0.05, 0.5};
static const struct subject splitter = {"splitter", 37,    6,  splitter_holdup, splitter_flows, "Q",
                                        "F",        100.0, 5.0};

static void look(const struct subject *s)
{
    static double state[STAGES_MAX * COMPONENTS_MAX];
    size_t m = s->components - 1;
    class->states->get(plant, state);
    for (size_t i = 0; i < s->stages; i++) {
        x[i][m] = 1.0;
        for (size_t j = 0; j < m; j++) {
            x[i][j] = state[i * m + j];
            x[i][m] -= x[i][j];
        }
        for (size_t j = 0; j <= m; j++)
            TEST_ASSERT_TRUE(x[i][j] >= -1e-14 && x[i][j] <= 1.0 + 1e-14);
    }
}

static void contents(const struct subject *s, double *n)
{
    for (size_t j = 0; j < s->components; j++)
        n[j] = 0.0;
    for (size_t i = 0; i < s->stages; i++)
        for (size_t j = 0; j < s->components; j++)
            n[j] += s->holdup(x[i], i) * x[i][j];
}

static void net_flows(const struct subject *s, double *fed, double *net)
{
    double d, b;
    s->flows(fed, &d, &b);
    for (size_t j = 0; j < s->components; j++)
        net[j] = fed[j] - d * x[s->stages - 1][j] - b * x[0][j];
}

static void begin(const struct subject *s)
{
    class = plant_open(s->name, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(class, err);
    property = class->column->config->component;
    plant = plant_create(class, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(plant, err);
}

void setUp(void) {}

void tearDown(void)
{
    class->destroy(plant);
    plant_library_free();
}

/* Half an hour in ticks of a second after steps of heat and feed, flows summed up by trapezoids. */
static void in_motion(const struct subject *s)
{
    double before[COMPONENTS_MAX], after[COMPONENTS_MAX], gathered[COMPONENTS_MAX] = {0}, all = 0.0;
    double fed[COMPONENTS_MAX], net[2][COMPONENTS_MAX], moved = 0.0, worst = 0.0;

    begin(s);
    look(s);
    contents(s, before);
    set(s->heat, get(s->heat) + s->heat_step);
    set(s->feed, get(s->feed) + s->feed_step);
    net_flows(s, fed, net[0]);
    for (int k = 1; k <= 1800; k++) {
        TEST_ASSERT_TRUE_MESSAGE(class->advance(plant, k, err, sizeof err), err);
        look(s);
        net_flows(s, fed, net[k % 2]);
        for (size_t j = 0; j < s->components; j++) {
            gathered[j] += 0.5 * (net[0][j] + net[1][j]);
            all += fed[j];
        }
    }
    contents(s, after);
    for (size_t j = 0; j < s->components; j++) {
        worst = fmax(worst, fabs(after[j] - before[j] - gathered[j]) / all);
        moved = fmax(moved, fabs(after[j] - before[j]) / all);
    }
    printf("%s: contents moved by up to %.2g of what was fed, balances open by %.2g of it\n",
           s->name, moved, worst);
    TEST_ASSERT_TRUE(moved > 1e-3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, worst);
}

static void in_motion_every_component_of_the_pilot_column_balances(void)
{
    in_motion(&pilot);
}

static void in_motion_every_component_of_the_splitter_balances(void)
{
    in_motion(&splitter);
}

/* No mole fraction changes by more than the solver's residual in an hour, and products carry what is fed. */
static void at_rest(const struct subject *s, double heat, double feed)
{
    static double rates[STAGES_MAX * COMPONENTS_MAX];
    double fed[COMPONENTS_MAX], net[COMPONENTS_MAX], all = 0.0, worst = 0.0;

    set(s->heat, heat);
    set(s->feed, feed);
    TEST_ASSERT_TRUE_MESSAGE(class->settle(plant, err, sizeof err), err);
    look(s);
    TEST_ASSERT_TRUE_MESSAGE(class->states->rates(plant, rates, err, sizeof err), err);
    for (size_t i = 0; i < class->states->count(plant); i++)
        worst = fmax(worst, 3600.0 * fabs(rates[i]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, worst);
    net_flows(s, fed, net);
    for (size_t j = 0; j < s->components; j++)
        all += fed[j];
    for (size_t j = 0; j < s->components; j++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-8 * all, 0, net[j]);
}

static void at_rest_everywhere(const struct subject *s)
{
    begin(s);
    double heat = get(s->heat), feed = get(s->feed);
    for (int i = -2; i <= 2; i++)
        for (int j = -2; j <= 2; j++)
            at_rest(s, heat + i * s->heat_step, feed + j * s->feed_step);
}

static void at_rest_every_equation_of_the_pilot_column_holds(void)
{
    at_rest_everywhere(&pilot);
}

static void at_rest_every_equation_of_the_splitter_holds(void)
{
    at_rest_everywhere(&splitter);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(in_motion_every_component_of_the_pilot_column_balances);
    RUN_TEST(in_motion_every_component_of_the_splitter_balances);
    RUN_TEST(at_rest_every_equation_of_the_pilot_column_holds);
    RUN_TEST(at_rest_every_equation_of_the_splitter_holds);
    return UNITY_END();
}

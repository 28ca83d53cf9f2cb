/* Balances of every column that comes with the simulator, over a day of moving inputs: what is in the column of every
 * component, and in all, from what flowed in and out. Flows are summed up by trapezoids, closer together after a change. */
#include "columns/column_plant.h"
#include "plants/plant_library.h"
#include "random_source.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define CHANGES   24
#define BETWEEN_S 3600.0
#define SHARE     0.05 /* of its span, that an input may be from its nominal value */

static char err[256];
static const struct plant_class *class;
static struct plant *plant;

void setUp(void) {}

void tearDown(void)
{
    if (plant)
        class->destroy(plant);
    plant_library_free();
}

static double fraction(size_t stage, size_t j)
{
    return column_fraction(column_plant_column(plant), column_plant_state(plant), stage, j);
}

/* moles[components]: all there is. */
static void contents(double *moles)
{
    const struct column *c = column_plant_column(plant);
    for (size_t j = 0; j < c->config->components; j++) {
        moles[j] = 0.0;
        for (size_t s = 0; s < c->config->stages; s++)
            moles[j] += c->holdup[s] * fraction(s, j);
    }
}

/* mol/s of every component, in less out. */
static void net(double *gain)
{
    const struct column *c = column_plant_column(plant);
    for (size_t j = 0; j < c->config->components; j++)
        gain[j] = c->flows.feed * c->inputs.feed_fraction[j] -
                  c->flows.distillate * fraction(c->config->stages - 1, j) -
                  c->flows.bottoms * fraction(0, j);
}

static void move_inputs(struct random_source *r)
{
    for (size_t i = 0; i < class->n_channels; i++) {
        const struct plant_channel *c = &class->channels[i];
        if (c->kind != PLANT_MV && c->kind != PLANT_DISTURBANCE)
            continue;
        double part = 2.0 * (double)(random_next(r) >> 11) / 9007199254740992.0 - 1.0;
        double value = fmin(fmax(c->nominal + SHARE * part * (c->hi - c->lo), c->lo), c->hi);
        TEST_ASSERT_TRUE_MESSAGE(class->set_input(plant, i, value, err, sizeof err), err);
    }
}

static void balances_of_a_day(const char *name)
{
    double before[COLUMN_COMPONENTS_MAX], after[COLUMN_COMPONENTS_MAX];
    double gathered[COLUMN_COMPONENTS_MAX] = {0}, rate[2][COLUMN_COMPONENTS_MAX];
    double t = 0.0, fed = 0.0, moved = 0.0, worst = 0.0;
    struct random_source r = {7};

    class = plant_open(name, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(class, err);
    plant = plant_create(class, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(plant, err);
    size_t components = column_plant_column(plant)->config->components;
    contents(before);
    for (int k = 0; k < CHANGES; k++) {
        move_inputs(&r);
        net(rate[0]);
        double begun = t, step;
        for (int i = 1; t - begun < BETWEEN_S - 1e-9; i++, t += step) {
            step = t - begun < 30.0 ? 0.25 : t - begun < 300.0 ? 2.0 : 10.0;
            TEST_ASSERT_TRUE_MESSAGE(class->advance(plant, t + step, err, sizeof err), err);
            net(rate[i % 2]);
            for (size_t j = 0; j < components; j++)
                gathered[j] += 0.5 * step * (rate[0][j] + rate[1][j]);
            fed += step * column_plant_column(plant)->flows.feed;
        }
    }
    contents(after);
    double all = 0.0;
    for (size_t j = 0; j < components; j++) {
        double open = after[j] - before[j] - gathered[j];
        worst = fmax(worst, fabs(open) / fed);
        moved = fmax(moved, fabs(after[j] - before[j]) / fed);
        all += open;
    }
    printf("%s: contents moved by up to %.2g of what a day fed, components open by %.2g of it, the "
           "total by %.2g\n",
           name, moved, worst, fabs(all) / fed);
    TEST_ASSERT_TRUE(moved > 1e-6);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, worst);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, all / fed);
}

#define DAY(title, name)                                                                           \
    static void title(void)                                                                        \
    {                                                                                              \
        balances_of_a_day(name);                                                                   \
    }
DAY(a_day_of_the_pilot_column_balances, "pilot")
DAY(a_day_of_the_splitter_balances, "splitter")
DAY(a_day_of_a_column_whose_holdups_all_move_balances, "column-a")
DAY(a_day_of_a_column_with_activity_coefficients_balances, "methanol-water")
DAY(a_day_of_a_column_whose_reflux_holds_a_level_balances, "c3-splitter")

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_day_of_the_pilot_column_balances);
    RUN_TEST(a_day_of_the_splitter_balances);
    RUN_TEST(a_day_of_a_column_whose_holdups_all_move_balances);
    RUN_TEST(a_day_of_a_column_with_activity_coefficients_balances);
    RUN_TEST(a_day_of_a_column_whose_reflux_holds_a_level_balances);
    return UNITY_END();
}

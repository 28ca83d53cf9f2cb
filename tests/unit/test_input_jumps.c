/* No sequence of inputs inside their ranges ends a run: random campaign over the columns.
 *
 * Every tick each input stays, jumps anywhere in its range, or jumps to one of its ends; ticks are of 30, 10, 1 and
 * 300 s. After every tick all values are finite, all mole fractions in [0, 1] and no holdup negative. As a test 4 seeds, in the full
 * tier 10; 200 with
 *
 *   build/host/tests/unit/test_input_jumps 200 */
#include "plants/plant_library.h"
#include "random_source.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TICKS 100
#define FIRST 1 /* seed */

static int seeds = 4;
static char err[256];

void setUp(void) {}
void tearDown(void) {}

static double uniform(struct random_source *r)
{
    return (double)(random_next(r) >> 11) / 9007199254740992.0;
}

static bool is_input(const struct plant_channel *c)
{
    return c->kind == PLANT_MV || c->kind == PLANT_DISTURBANCE;
}

/* A refusal is allowed where several inputs make a composition and it has no sum; then the old value stays. */
static void jump(const struct plant_class *class, struct plant *p, struct random_source *r)
{
    for (size_t i = 0; i < class->n_channels; i++) {
        const struct plant_channel *c = &class->channels[i];
        if (!is_input(c))
            continue;
        double how = uniform(r), where = uniform(r);
        if (how > 0.8)
            continue;
        double value = how < 0.2 ? c->lo : how < 0.4 ? c->hi : c->lo + where * (c->hi - c->lo);
        bool taken = class->set_input(p, i, value, err, sizeof err);
        TEST_ASSERT_TRUE_MESSAGE(taken || strstr(err, "add up"), err);
    }
}

/* m: mole fractions of a stage that are states; the last one closes the sum. Behind them are the holdups that move. */
static void sane(const struct plant_class *class, struct plant *p, size_t stages, size_t m,
                 const char *when)
{
    static double x[2000];
    for (size_t i = 0; i < class->n_channels; i++)
        TEST_ASSERT_TRUE_MESSAGE(isfinite(class->value(p, i)), when);
    size_t n = class->states->count(p);
    TEST_ASSERT_TRUE(n <= sizeof x / sizeof *x);
    class->states->get(p, x);
    TEST_ASSERT_TRUE(n >= stages * m);
    for (size_t i = stages * m; i < n; i++)
        TEST_ASSERT_TRUE_MESSAGE(x[i] >= 0, when);
    for (size_t i = 0; i < stages * m; i += m) {
        double last = 1.0;
        for (size_t j = i; j < i + m; j++) {
            TEST_ASSERT_TRUE_MESSAGE(x[j] >= 0 && x[j] <= 1, when);
            last -= x[j];
        }
        TEST_ASSERT_TRUE_MESSAGE(last >= -1e-14, when); /* rounding of the sum */
    }
}

static void campaign(const char *name, size_t stages, size_t m)
{
    static const double tick[] = {30, 10, 1, 300};
    const struct plant_class *class = plant_open(name, err, sizeof err);
    char when[400];

    TEST_ASSERT_NOT_NULL_MESSAGE(class, err);

    for (int seed = FIRST; seed < FIRST + seeds; seed++) {
        struct random_source r = {(uint64_t)seed};
        struct plant *p = plant_create(class, err, sizeof err);
        TEST_ASSERT_NOT_NULL_MESSAGE(p, err);
        double t = 0;
        for (int k = 0; k < TICKS; k++) {
            snprintf(when, sizeof when, "%s, seed %d, tick %d", name, seed, k);
            jump(class, p, &r);
            t += tick[seed % 4];
            if (!class->advance(p, t, err, sizeof err)) {
                snprintf(when, sizeof when, "%s, seed %d, tick %d: %s", name, seed, k, err);
                TEST_FAIL_MESSAGE(when);
            }
            sane(class, p, stages, m, when);
        }
        class->destroy(p);
    }
    plant_library_free();
    printf("input jumps %s: %d seeds from %d, %d ticks, none failed\n", name, seeds, FIRST,
           seeds * TICKS);
}

static void the_pilot_column_survives_every_jump_of_its_inputs(void)
{
    campaign("pilot", 12, 1);
}

static void the_splitter_survives_every_jump_of_its_inputs(void)
{
    campaign("splitter", 37, 5);
}

static void a_column_whose_holdups_all_move_survives_every_jump_of_its_inputs(void)
{
    campaign("column-a", 41, 1);
}

static void a_column_with_activity_coefficients_survives_every_jump_of_its_inputs(void)
{
    campaign("methanol-water", 32, 1);
}

static void
a_column_of_110_trays_with_its_level_held_by_reflux_survives_every_jump_of_its_inputs(void)
{
    campaign("c3-splitter", 111, 1);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        seeds = atoi(argv[1]);
    if (seeds < 1)
        seeds = 1;
    UNITY_BEGIN();
    RUN_TEST(the_pilot_column_survives_every_jump_of_its_inputs);
    RUN_TEST(the_splitter_survives_every_jump_of_its_inputs);
    RUN_TEST(a_column_whose_holdups_all_move_survives_every_jump_of_its_inputs);
    RUN_TEST(a_column_with_activity_coefficients_survives_every_jump_of_its_inputs);
    RUN_TEST(a_column_of_110_trays_with_its_level_held_by_reflux_survives_every_jump_of_its_inputs);
    return UNITY_END();
}

/* The C3-C4 splitter against its committed, independent reference (tests/reference/splitter_reference.py):
 * both steady states, 24 h after steps of the feed and of the duty, and a day of changes, run tick by tick. */
#include "csv.h"
#include "plant_bench.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define STAGES  37
#define OUTPUTS (STAGES + 4) /* temperatures, iC4_D, C3_B, D, B */
#define COLUMNS (2 + OUTPUTS)

void setUp(void)
{
    bench_open("splitter");
}

void tearDown(void)
{
    bench_close();
}

/* Largest deviation from a row of outputs: temperatures (K) and impurities (relative). */
static void deviations(const double *row, double *kelvin, double *relative)
{
    for (int s = 1; s <= STAGES; s++) {
        char name[16];
        snprintf(name, sizeof name, "T%d", s);
        *kelvin = fmax(*kelvin, fabs(get(name) - row[s - 1]));
    }
    *relative = fmax(*relative, fabs(get("iC4_D") / row[STAGES] - 1));
    *relative = fmax(*relative, fabs(get("C3_B") / row[STAGES + 1] - 1));
}

static void both_steady_states_are_those_of_the_reference(void)
{
    double row[COLUMNS], kelvin = 0, relative = 0;
    FILE *f = csv_open("reference/splitter_steady.csv");
    int rows = 0;
    while (csv_row(f, row, COLUMNS)) {
        set("R", row[0]);
        set("Q", row[1]);
        settle();
        deviations(row + 2, &kelvin, &relative);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, row[2 + STAGES + 2], get("D"));
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, row[2 + STAGES + 3], get("B"));
        rows++;
    }
    fclose(f);
    printf("steady states: within %.2g K, impurities within %.2g of their value\n", kelvin,
           relative);
    TEST_ASSERT_EQUAL(2, rows);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, kelvin);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, relative);
}

static void begin_step(int number)
{
    bench_close();
    setUp();
    if (number == 1) {
        set("Q", 4200.0);
        return;
    }
    set("F", 95.0); /* the mean of the source's first scenario */
    set("TF", 317.0);
    set("zC2", 0.002);
    set("zC3", 0.27);
    set("ziC4", 0.2232);
    set("znC4", 0.5);
}

static void a_day_after_a_step_every_temperature_is_that_of_the_reference(void)
{
    double row[COLUMNS], kelvin = 0, relative = 0;
    FILE *f = csv_open("reference/splitter_steps.csv");
    int rows = 0, ticks = 0, step = -1;
    while (csv_row(f, row, COLUMNS)) {
        if ((int)row[0] != step) {
            step = (int)row[0];
            ticks = 0;
            begin_step(step);
        }
        for (; ticks < (int)lround(row[1] * 120); ticks++)
            run_to(30.0 * (ticks + 1));
        deviations(row + 2, &kelvin, &relative);
        rows++;
    }
    fclose(f);
    printf("24 h after steps: within %.2g K, impurities within %.2g of their value\n", kelvin,
           relative);
    TEST_ASSERT_EQUAL(20, rows);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, kelvin);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, relative);
}

static void a_day_of_changes_runs_as_that_of_the_reference(void)
{
    static const char *const input[] = {"R",   "Q",    "F",    "TF",   "zC2",
                                        "zC3", "ziC4", "ziC5", "znC5", "znC4"};
    double row[11 + OUTPUTS], kelvin = 0, relative = 0;
    FILE *f = csv_open("reference/splitter_day.csv");
    int rows = 0, ticks = 0;
    for (; csv_row(f, row, 11 + OUTPUTS); rows++) {
        for (int i = 0; i < 10; i++)
            set(input[i], row[1 + i]);
        for (; ticks < (int)lround(row[0] * 120); ticks++)
            TEST_ASSERT_TRUE_MESSAGE(kind->advance(plant, 30.0 * (ticks + 1), err, sizeof err),
                                     err);
        deviations(row + 11, &kelvin, &relative);
    }
    fclose(f);
    printf("24 h of changes: within %.2g K, impurities within %.2g of their value\n", kelvin,
           relative);
    TEST_ASSERT_EQUAL(24, rows);
    TEST_ASSERT_EQUAL(24 * 120, ticks);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, kelvin);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, relative);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(both_steady_states_are_those_of_the_reference);
    RUN_TEST(a_day_after_a_step_every_temperature_is_that_of_the_reference);
    RUN_TEST(a_day_of_changes_runs_as_that_of_the_reference);
    return UNITY_END();
}

/* The cold pilot column against its committed, independent reference: eight hours with start, running, loss of cooling, a
 * reboiler that runs dry, and shut-down; and its running state. */
#include "csv.h"
#include "plant_bench.h"

#include <math.h>

#define COLUMNS     22
#define FIRST_LEVEL 15 /* before it are temperatures */

static const char *const names[COLUMNS] = {
    "time", "T1", "T2",      "T3",  "T4",      "T5", "T6", "T7", "T8", "T9", "T10",
    "TB",   "TD", "Theater", "Tcw", "LB_true", "LD", "xD", "xB", "Lr", "D",  "B"};

/* As SCHEDULE in tests/reference/pilot_cold_reference.py. */
static const struct {
    double t;
    const char *name;
    double value;
} schedule[] = {
    {0, "vCW", 100},      {60, "Qrb", 1.0},     {1080, "vLr", 100},  {1920, "Qrb", 0.823},
    {1920, "vLr", 37.5},  {1920, "vD", 40},     {1920, "vB", 39.6},  {1920, "vF", 50},
    {10800, "supply", 0}, {11400, "supply", 1}, {16200, "leak", 60}, {16500, "leak", 0},
    {16800, "Qrb", 0},    {16800, "vF", 0},     {16800, "vD", 0},    {16800, "vB", 0},
    {16800, "vLr", 100},  {18600, "vCW", 0},
};

void setUp(void)
{
    bench_open("pilot-cold");
}

void tearDown(void)
{
    bench_close();
}

static void act(double now)
{
    for (size_t k = 0; k < sizeof schedule / sizeof schedule[0]; k++)
        if (schedule[k].t == now)
            set(schedule[k].name, schedule[k].value);
}

/* Aim 0.01 K. */
static void eight_hours_from_cold_to_cold_are_those_of_the_reference(void)
{
    double row[COLUMNS], worst[COLUMNS] = {0}, when[COLUMNS] = {0}, now = 0;
    int rows = 0;
    FILE *f = csv_open("reference/pilot_cold_run.csv");
    act(0);
    while (csv_row(f, row, COLUMNS)) {
        while (now < row[0]) {
            now += 10;
            run_to(now);
            if (now < row[0])
                act(now);
        }
        for (int k = 1; k < COLUMNS; k++) {
            double off = fabs(get(names[k]) - row[k]);
            if (off > worst[k]) {
                worst[k] = off;
                when[k] = now;
            }
        }
        act(now);
        rows++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL(240, rows);
    double kelvin = 0, rest = 0;
    for (int k = 1; k < COLUMNS; k++) {
        printf("%s %.2g at %.0f s\n", names[k], worst[k], when[k]);
        if (k < FIRST_LEVEL)
            kelvin = fmax(kelvin, worst[k]);
        else
            rest = fmax(rest, worst[k]);
    }
    printf("temperatures within %.2g K, levels, compositions and flows within %.2g cm, %%, l/h\n",
           kelvin, rest);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, kelvin);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0, rest);
}

static void the_running_state_is_that_of_the_reference(void)
{
    double row[COLUMNS];
    FILE *f = csv_open("reference/pilot_cold_steady.csv");
    TEST_ASSERT_TRUE(csv_row(f, row, COLUMNS));
    fclose(f);
    for (size_t k = 0; k < sizeof schedule / sizeof schedule[0]; k++)
        if (schedule[k].t == 1920 || schedule[k].t == 0)
            set(schedule[k].name, schedule[k].value);
    settle();
    for (int k = 1; k < COLUMNS; k++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, row[k], get(names[k]));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_running_state_is_that_of_the_reference);
    RUN_TEST(eight_hours_from_cold_to_cold_are_those_of_the_reference);
    return UNITY_END();
}

/* The kind `ff_tune` on processes and paths that are unlike Siddha's. To add one: a row of situations[]. By default each row meets half
 * of the methods, with the argument `all` every one. */
#include "sample.h"
#include "unlike_bench.h"

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

static const struct situation situations[] = {
    {"as Siddha's", 1, 1, "0.65", "13.2", 300, 1, ACTS, {0}},
    {"second order", 2, 1, "0.94", "17", 300, 1, ACTS, {0}},
    {"inverse response", 3, 1, "0.68", "15", 300, 1, ACTS, {0}},
    {"inverse response of both", 3, 6, "0.68", "15", 300, 1, ACTS, {0}},
    {"gain below 0", 5, 1, "-0.65", "13.2", 300, 1, ACTS, {0}},
    {"swings", 8, 1, "0.3", "8", 300, 1, ACTS, {0}},
    {"integrates", 4, 1, "2", "80", 300, 1, DOES_NO_HARM, {0}},
    {"integrates as the disturbance does", 4, 4, "2", "80", 300, 1, ACTS, {0}},
    {"faster than the sample", 7, 1, "0.4", "1.3", 300, 1, DOES_NO_HARM, {0}},
    {"faster than the sample, disturbance too", 7, 2, "0.4", "1.3", 300, 1, PROMISES_TOO_MUCH, {0}},
    {"disturbance at once", 1, 2, "0.65", "13.2", 300, 1, DOES_NO_HARM, {0}},
    {"disturbance slow",
     1,
     3,
     "0.65",
     "13.2",
     600,
     1,
     DOES_NO_HARM,
     {"set block1.dead_most 60", "set block1.lag_most 200"}},
    {"disturbance slower than lag_most",
     1,
     3,
     "0.65",
     "13.2",
     600,
     1,
     DOES_NO_HARM,
     {"set block1.dead_most 0"}},
    {"an hour to rest",
     6,
     5,
     "0.8",
     "700",
     600,
     20,
     DOES_NO_HARM,
     {"set block1.learn 60000", "set block1.check 24000", "set block1.step_period 12000",
      "set block1.lag_most 1200", "set block1.dead_most 400"}},
    {"an hour to rest, settings of a fast one",
     6,
     5,
     "0.8",
     "700",
     600,
     20,
     DOES_NO_HARM,
     {"set block1.learn 3000"}},
};
#define SITUATIONS (sizeof situations / sizeof situations[0])

static void judge(const struct situation *c, unsigned method, double before)
{
    int verdict = tune_value("verdict");
    double promised = value_of(1, "promised");
    tune_seconds(1200);
    double taken = 100 * (1 - mean_square(4 * c->d_period) / before);
    bool off = gain_is_off("ff1");
    printf("%-11s %-40s verdict %2d, %s, promised %5.1f, less by %5.1f %%\n", methods[method],
           c->name, verdict, off ? "off" : "on ", promised, taken);
    TEST_ASSERT_TRUE_MESSAGE(off == (verdict != ADOPTED || tune_value("verdict") == WORSE),
                             c->name);
    TEST_ASSERT_TRUE_MESSAGE(taken > -3, c->name);
    if (!off && c->expected != PROMISES_TOO_MUCH)
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(15, promised, taken, c->name);
    if (c->expected == ACTS)
        TEST_ASSERT_TRUE_MESSAGE(!off && taken > 85, c->name);
}

static void what_is_adopted_does_what_was_promised_and_what_is_not_does_nothing(void)
{
    for (unsigned k = 0; k < SITUATIONS; k++)
        for (unsigned m = 0; m < METHODS; m++) {
            if (!sample_has(k + m, 2))
                continue;
            begin_unlike(&situations[k], m);
            double before = mean_square(4 * situations[k].d_period);
            tune_whole(m);
            judge(&situations[k], m, before);
            plant_power_off();
        }
}

int main(int argc, char **argv)
{
    sample_arguments(argc, argv);
    UNITY_BEGIN();
    RUN_TEST(what_is_adopted_does_what_was_promised_and_what_is_not_does_nothing);
    return UNITY_END();
}

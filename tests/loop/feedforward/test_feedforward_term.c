/* The kind `ff_tune` tunes a term of a feedforward element blockN, and switches it off; and the dead band of that element keeps the noise
 * of a sensor away from the MV. */
#include "tune_bench.h"

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

/* Two terms from the disturbance to the MV, in place of ff1; the second is tuned. */
static void two_terms(void)
{
    static const char *const lines[] = {"begin",
                                        "set ff1.from -",
                                        "set ff1.to -",
                                        "set block2.kind leadlag",
                                        "set block2.inputs dm",
                                        "set block2.points u",
                                        "set block2.from.1 1,1,0,0,0,0,0,0",
                                        "set block2.to.1 1,1,0,0,0,0,0,0",
                                        "set block1.element 2",
                                        "set block1.block 2",
                                        "set block1.tries 0",
                                        "apply"};
    tune_begin(FEEDFORWARD, 5, 1);
    for (unsigned i = 0; i < sizeof lines / sizeof lines[0]; i++)
        ask_ok(lines[i]);
    tune_seconds(1200);
}

/* The tuned term's value in a row of the element. */
static double in_row(const char *row)
{
    double first = 1, second = 0;
    char line[40];
    (void)snprintf(line, sizeof line, "get block2.%s.1", row);
    ask_ok(line);
    TEST_ASSERT_EQUAL(2, sscanf(strstr(board.said, " = "), " = %lf,%lf,", &first, &second));
    TEST_ASSERT_EQUAL_DOUBLE(0, first);
    return second;
}

static void a_term_is_tuned_adopted_and_watched(void)
{
    two_terms();
    double alone = mean_square(900);
    tune_stages(false, 1u << RUNS, 20);
    TEST_ASSERT_EQUAL(ADOPTED, tune_value("verdict"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)value_of(1, "found_k"), in_row("gain"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, (double)value_of(1, "found_lead"), in_row("lead"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, (double)value_of(1, "found_lag"), in_row("lag"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, (double)value_of(1, "found_dead"), in_row("dead"));
    tune_seconds(1200);
    TEST_ASSERT_TRUE(value_of(1, "does") > 85);
    TEST_ASSERT_TRUE(mean_square(900) < 0.15 * alone);
}

static void one_that_is_worse_is_off_at_once(void)
{
    two_terms();
    tune_stages(false, 1u << RUNS, 20);
    ask_ok("begin");
    ask_ok("set block2.gain.1 0,0.5,0,0,0,0,0,0");
    ask_ok("set block1.k 0.5");
    ask_ok("apply");
    ask_ok("begin");
    board_forget();
    for (unsigned s = 0; s < 1800 && !said("SWITCHED_OFF"); s++)
        tune_second();
    TEST_ASSERT_TRUE(said(" warning SWITCHED_OFF block2.term2 1 "));
    double bad = mean_square(900);
    ANSWERS("apply", "# switched off meanwhile: block1.k, block2.gain.1");
    tune_seconds(2);
    TEST_ASSERT_EQUAL_DOUBLE(0, in_row("gain"));
    TEST_ASSERT_DOUBLE_WITHIN(0.2 * bad, bad, mean_square(900));
}

/* Range of what the element adds to the MV in a quarter of an hour: largest less least. */
static double unrest_of_mv(void)
{
    double least = INFINITY, most = -INFINITY;
    for (unsigned k = 0; k < 900; k++) {
        tune_second();
        least = fmin(least, value_of(2, "added_1"));
        most = fmax(most, value_of(2, "added_1"));
    }
    return most - least;
}

/* A twentieth of the disturbance is noise. Returns the mean square under feedback alone. */
static double noisy_disturbance(bool dead_band)
{
    char line[60];
    two_terms();
    plant_event("dm.noise=0.05");
    TEST_ASSERT_EQUAL_DOUBLE(0, value_of(1, "noise_d")); /* the disturbance has not rested yet */
    course.quiet = true;
    tune_seconds(7000);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.05, value_of(1, "noise_d"));
    (void)snprintf(line, sizeof line, "set block2.dead_band.1 0,%.4g,0,0,0,0,0,0",
                   4 * value_of(1, "noise_d"));
    if (dead_band)
        ask_ok(line);
    course.quiet = false;
    tune_seconds(600);
    double alone = mean_square(900);
    tune_stages(false, 1u << RUNS, 20);
    TEST_ASSERT_EQUAL(ADOPTED, tune_value("verdict"));
    tune_seconds(1200);
    return alone;
}

/* As docs/methods/adaptive-feedforward.md has it: the block says how large the noise is at rest, and somebody sets four times as much. */
static void with_a_dead_band_against_noise_the_mv_is_calm_at_rest_and_the_element_stays(void)
{
    double alone = noisy_disturbance(true);
    TEST_ASSERT_TRUE(mean_square(900) < 0.15 * alone);
    course.quiet = true;
    tune_seconds(6000);
    TEST_ASSERT_TRUE(unrest_of_mv() < 0.002);
    TEST_ASSERT_EQUAL(0, tune_value("tried"));
    TEST_ASSERT_EQUAL(RUNS, tune_value("stage"));
}

static void without_one_noise_at_rest_switches_the_element_off(void)
{
    (void)noisy_disturbance(false);
    course.quiet = true;
    tune_seconds(6000);
    TEST_ASSERT_EQUAL(WORSE, tune_value("verdict"));
}

/* A sample of the models is a mean of five readings; the element sees each of them. */
static void the_noise_at_rest_is_that_of_a_reading_whatever_the_period(void)
{
    two_terms();
    ask_ok("set block1.period 5");
    plant_event("dm.noise=0.05");
    tune_seconds(1200); /* who has never seen it move takes noise for movement */
    course.quiet = true;
    tune_seconds(8000);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.05, value_of(1, "noise_d"));
}

static void another_block_than_a_leadlag_is_refused(void)
{
    two_terms();
    ask_refused("set block1.block 1", "UNKNOWN");
    ask_refused("set block1.block 3", "UNKNOWN");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_term_is_tuned_adopted_and_watched);
    RUN_TEST(one_that_is_worse_is_off_at_once);
    RUN_TEST(with_a_dead_band_against_noise_the_mv_is_calm_at_rest_and_the_element_stays);
    RUN_TEST(without_one_noise_at_rest_switches_the_element_off);
    RUN_TEST(the_noise_at_rest_is_that_of_a_reading_whatever_the_period);
    RUN_TEST(another_block_than_a_leadlag_is_refused);
    return UNITY_END();
}

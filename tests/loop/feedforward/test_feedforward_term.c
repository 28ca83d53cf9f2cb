/* The kind `ff_tune` tunes a term of an element with a record, and switches it off. */
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
    RUN_TEST(another_block_than_a_leadlag_is_refused);
    return UNITY_END();
}

/* The kind `ff_tune` switches its element off while settings are not free. */
#include "tune_bench.h"

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

/* An element that acts, of the wrong sign; nobody has tuned it. */
static void wrong_element(const char *const *lines)
{
    tune_begin(FEEDFORWARD, 5, 1);
    ask_ok("begin");
    ask_ok("set ff1.gain 0.5");
    ask_ok("set block1.k 0.5");
    for (; *lines; lines++)
        ask_ok(*lines);
    ask_ok("apply");
    tune_seconds(10);
}

/* Effect of a step of the disturbance on the MV at once, noise aside. */
static double added(void)
{
    course.quiet = true;
    tune_seconds(60);
    double before = (double)board.command.output[0].value;
    set_disturbance(2);
    plant_steps(2);
    double after = (double)board.command.output[0].value;
    set_disturbance(0);
    return fabs(after - before);
}

#define WITH(...) wrong_element((const char *const[]){__VA_ARGS__, NULL})

static void silence_acts_behind_an_open_transaction(void)
{
    WITH("set block1.learn 3000");
    TEST_ASSERT_TRUE(added() > 1);
    ask_ok("begin");
    ask_ok("block 1 silence");
    tune_seconds(100);
    TEST_ASSERT_TRUE(added() < 0.5);
    ANSWERS("apply", "# switched off meanwhile: block1.k, ff1.gain");
    tune_seconds(2);
    ask_ok("get ff1.gain");
    TEST_ASSERT_TRUE(said("ff1.gain = 0 "));
}

static void what_makes_the_loop_worse_is_off_behind_an_open_transaction(void)
{
    WITH("set block1.tries 0");
    tune_seconds(1200);
    tune_stages(false, 1u << TESTS, 20);
    TEST_ASSERT_EQUAL(TESTS, tune_value("stage"));
    ask_ok("begin");
    board_forget();
    for (unsigned s = 0; s < 600 && !said("SWITCHED_OFF"); s++)
        tune_second();
    TEST_ASSERT_TRUE(said(" alarm BLOCK_ALARM block1.worse "));
    TEST_ASSERT_TRUE(said(" warning SWITCHED_OFF ff1 1 "));
    TEST_ASSERT_TRUE(added() < 0.5);
    ask_ok("abandon");
    tune_seconds(2);
    ask_ok("get ff1.gain");
    TEST_ASSERT_TRUE(said("ff1.gain = 0 "));
}

static void where_somebody_has_to_agree_it_acts_until_then(void)
{
    WITH("set block1.protect off", "set block1.adopt ask");
    ask_ok("block 1 silence");
    tune_seconds(100);
    TEST_ASSERT_TRUE(added() > 1);
    ask_ok("proposal accept");
    TEST_ASSERT_TRUE(added() < 0.5);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(silence_acts_behind_an_open_transaction);
    RUN_TEST(what_makes_the_loop_worse_is_off_behind_an_open_transaction);
    RUN_TEST(where_somebody_has_to_agree_it_acts_until_then);
    return UNITY_END();
}

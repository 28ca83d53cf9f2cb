/* Mistakes on a loop that acts: what would turn its sense is refused while it acts, and an alarm tells of a PV that stays far from its
 * setpoint, without an entry for it. */
#include "board_bench.h"

void setUp(void)
{
    running();
    ask_ok("mode bottom auto");
    samples(2);
    board_forget();
}
void tearDown(void) {}

#define ACTS                                                                                       \
    "acts: its action, PV, MV, units, spans and calibration change in manual only; `mode LOOP "    \
    "manual` first"

static void what_turns_an_acting_loop_is_refused_with_its_name_and_the_way(void)
{
    ask_refused("set loop2.action direct", "STATE");
    TEST_ASSERT_TRUE_MESSAGE(said("loop2.action: 'bottom' " ACTS), board.said);
    ask_refused("set loop2.pv T1", "STATE");
    TEST_ASSERT_TRUE(said("loop2.pv: 'bottom' " ACTS));
    ask_refused("set loop2.out reflux", "STATE");
    ask_refused("set loop2.out nowhere", "UNKNOWN"); /* the typing error, not the loop */
    ask_refused("set meas2.unit K", "STATE");
    TEST_ASSERT_TRUE(said("loop2.pv: 'bottom' " ACTS));
    ask_refused("set meas2.hi 180", "STATE");
    ask_refused("set meas2.zero 1", "STATE");
    ask_refused("set mv2.hi 3", "STATE");
    ask_refused("set mv2.unit W", "STATE");
    TEST_ASSERT_TRUE(said("loop2.out: 'bottom' " ACTS));
    samples(2);
    ANSWERS("get loop2.action", "loop2.action = reverse");
    ask_ok("mode top manual"); /* another loop's mode is no hindrance */
    ask_ok("set loop1.action reverse");
}

static void in_a_transaction_apply_refuses_it_and_it_stays_open(void)
{
    ask_ok("begin");
    ask_ok("set loop2.action direct");
    ask_ok("set loop2.gain 2");
    ask_refused("apply", "STATE");
    ask_ok("set loop2.action reverse");
    ask_ok("apply");
    samples(1);
    ANSWERS("get loop2.gain", "loop2.gain = 2 fraction/fraction");
}

static void in_manual_it_is_taken(void)
{
    ask_ok("mode bottom manual");
    ask_ok("set loop2.action direct");
    ask_ok("set loop2.pv T1");
    samples(2);
    ask_ok("mode bottom auto");
}

static void what_keeps_the_sense_of_an_acting_loop_is_taken(void)
{
    ask_ok("set loop2.gain 3");
    ask_ok("set meas2.filter 5");
    ask_ok("set mv2.max 1.9");
    samples(2);
    ask_ok("loop bottom");
    TEST_ASSERT_TRUE_MESSAGE(said("bottom auto"), board.said);
}

static void a_pv_far_from_its_setpoint_for_long_is_an_alarm_without_an_entry(void)
{
    ask_ok("sp bottom 130"); /* 15 % of the span away */
    samples(3590);
    TEST_ASSERT_EQUAL(0, times_said(" DEVIATION bottom"));
    samples(20);
    TEST_ASSERT_EQUAL(1, times_said("alarm DEVIATION bottom 1"));
    ask_ok("alarm");
    TEST_ASSERT_TRUE(said("DEVIATION bottom is far from its setpoint"));
    board.values[1] = 122.5; /* 7.5 %: near enough */
    samples(3);
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("info DEVIATION_OVER bottom 7."), board.said);
    ask_ok("alarm");
    TEST_ASSERT_FALSE(said("is far from its setpoint"));
}

static void in_manual_there_is_no_such_alarm(void)
{
    ask_ok("set deviation.delay 10");
    ask_ok("sp bottom 130");
    samples(15);
    TEST_ASSERT_EQUAL(1, times_said("alarm DEVIATION bottom 1"));
    ask_ok("mode bottom manual");
    samples(2);
    TEST_ASSERT_EQUAL(1, times_said("info DEVIATION_OVER bottom "));
}

static void width_0_and_an_entry_of_the_loops_own_switch_it_off(void)
{
    ask_ok("set deviation.delay 10");
    ask_ok("set deviation.width 0");
    ask_ok("sp bottom 130");
    samples(20);
    TEST_ASSERT_EQUAL(0, times_said(" DEVIATION bottom"));
    ask_ok("begin");
    ask_ok("set deviation.width 0.1");
    ask_ok("set alarm1.on bottom");
    ask_ok("set alarm1.side deviation");
    ask_ok("set alarm1.limit 20");
    ask_ok("apply");
    samples(20);
    TEST_ASSERT_EQUAL(0, times_said(" DEVIATION bottom"));
    ask_ok("set alarm1.limit 5");
    samples(3);
    ask_ok("alarm");
    TEST_ASSERT_TRUE_MESSAGE(said("bottom.dev alarm1"), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said("= 115 degC, limit 5 degC from the setpoint\n"), board.said);
}

/* The night of a stranger's pilot plant: a thermometer drops out for longer than meas.hold, comes back, and nobody is there. */
static void a_loop_that_the_board_took_says_so_until_somebody_sets_its_mode(void)
{
    board.quality[1] = QUALITY_BAD;
    samples(70);
    board.quality[1] = QUALITY_GOOD;
    samples(5);
    TEST_ASSERT_EQUAL_MESSAGE(1,
                              times_said("alarm MANUAL_BY_BOARD bottom 0 the board has put this "
                                         "loop into manual: its measurement was bad\n"),
                              board.said);
    samples(600);
    ask_ok("alarm");
    TEST_ASSERT_FALSE(said("MEASUREMENT_BAD"));
    TEST_ASSERT_TRUE_MESSAGE(
        said("MANUAL_BY_BOARD bottom is in manual, put there by the board at "), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said(" s: T10 was bad\n"), board.said);
    ask_ok("status");
    TEST_ASSERT_TRUE_MESSAGE(said("in manual by the board's decision: bottom (`alarm` says why)\n"),
                             board.said);
    ask_ok("mode bottom manual");
    samples(1);
    TEST_ASSERT_EQUAL(1, times_said("info MANUAL_BY_BOARD_OVER bottom 0 somebody has set"));
    ask_ok("alarm");
    TEST_ASSERT_FALSE(said("MANUAL_BY_BOARD bottom is"));
    ask_ok("status");
    TEST_ASSERT_FALSE(said("by the board's decision"));
}

static void silence_of_the_link_takes_every_loop_that_acted(void)
{
    board.mute = true;
    pass(20000);
    board.mute = false;
    pass(3000);
    samples(5);
    ask_ok("status");
    TEST_ASSERT_TRUE_MESSAGE(said("in manual by the board's decision: bottom ("), board.said);
    ask_ok("alarm");
    TEST_ASSERT_TRUE_MESSAGE(said("MANUAL_BY_BOARD bottom is in manual"), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said(" s: the safe state\n"), board.said);
    ask_ok("mode bottom auto");
    samples(1);
    ask_ok("alarm");
    TEST_ASSERT_FALSE(said("MANUAL_BY_BOARD"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_turns_an_acting_loop_is_refused_with_its_name_and_the_way);
    RUN_TEST(in_a_transaction_apply_refuses_it_and_it_stays_open);
    RUN_TEST(in_manual_it_is_taken);
    RUN_TEST(what_keeps_the_sense_of_an_acting_loop_is_taken);
    RUN_TEST(a_pv_far_from_its_setpoint_for_long_is_an_alarm_without_an_entry);
    RUN_TEST(in_manual_there_is_no_such_alarm);
    RUN_TEST(a_loop_that_the_board_took_says_so_until_somebody_sets_its_mode);
    RUN_TEST(silence_of_the_link_takes_every_loop_that_acted);
    RUN_TEST(width_0_and_an_entry_of_the_loops_own_switch_it_off);
    return UNITY_END();
}

/* The kind `composition` and `return.k`: an outer loop on an estimate moves the setpoint of `bottom`, a loop on T33. When thermometers of
 * the estimator fail, that setpoint returns. The settings are those kept in tests/reference/stored/splitter-estimate.bin. */
#include <math.h>

#include "plant_board.h"

#define HOLD_TICKS 30u /* of both points, 300 s */

/* The plant of this bench does not announce the instruments of the feed. */
static const char *const common[] = {"begin",
                                     "set block1.kind -",
                                     "set block3.inputs T30,T31,R,Q",
                                     "set block3.place.3 0,1",
                                     "set block3.is.3 reflux",
                                     "set block3.si.3 0.000277777778,0",
                                     "set block3.is.4 heat",
                                     "set block3.si.4 1162.22222,0",
                                     "set block3.is.5 pressure",
                                     "set block3.is.6 pressure",
                                     "set block3.is.7 pressure",
                                     "set block3.alone 60",
                                     "set block3.return.1 330,0.3",
                                     "set block3.return.2 329.5,0",
                                     "set meas6.hold 300",
                                     "set meas7.hold 300",
                                     "set loop2.name outer",
                                     "set loop2.pv est_iC4",
                                     "set loop2.out bottom",
                                     "set loop2.gain 10",
                                     "set loop2.ti 3000",
                                     NULL};

static const char *const one_lost[] = {"T30.quality=3", NULL};
static const char *const all_lost[] = {"T30.quality=3", "T31.quality=3", NULL};

void setUp(void) {}

void tearDown(void)
{
    plant_power_off();
}

static void all_ok(const char *const *lines)
{
    for (; lines && *lines; lines++)
        ask_ok(*lines);
}

static double setpoint_below(void)
{
    ask_ok("loop");
    const char *line = strstr(board.said, "bottom ");
    TEST_ASSERT_NOT_NULL(line);
    const char *at = strstr(line, "  sp ");
    TEST_ASSERT_NOT_NULL(at);
    return strtod(at + 5, NULL);
}

static void expect_setpoint_below(double expected)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, expected, setpoint_below());
}

/* The estimate is good and the outer loop has moved the setpoint below. `more` settings; `goal` of the outer loop. */
static void cascade(const char *const *more, const char *goal)
{
    char command[40];
    plant_flash_from(STORED_IMAGES "/splitter-estimate.bin");
    plant_power_on("splitter", 10000, 1, 0.0);
    pass(3000); /* without a plant the settings are read after 2 s */
    all_ok(common);
    all_ok(more);
    ask_ok("apply");
    plant_connect();
    plant_steps(2);
    ask_ok("out R 61.62");
    ask_ok("out bottom 4143.046");
    plant_steps(400);
    ask_ok("mode bottom auto");
    plant_steps(2);
    ask_ok("mode bottom cascade");
    plant_step();
    double before = setpoint_below();
    ask_ok("mode outer auto");
    snprintf(command, sizeof command, "sp outer %s", goal);
    ask_ok(command);
    plant_steps(200);
    TEST_ASSERT_TRUE_MESSAGE(loop_is("outer", "auto"), board.said);
    TEST_ASSERT_TRUE(fabs(setpoint_below() - before) > 0.2);
}

static void fail(const char *const *faults)
{
    for (; *faults; faults++)
        plant_event(*faults);
}

/* The outer loop acts for as long as `hold` allows. */
static void until_hold_is_over(void)
{
    plant_steps(HOLD_TICKS);
    TEST_ASSERT_TRUE_MESSAGE(loop_is("outer", "auto"), board.said);
    plant_steps(2);
}

static void has_returned_to(double expected)
{
    TEST_ASSERT_TRUE_MESSAGE(loop_is("outer", "manual"), board.said);
    TEST_ASSERT_TRUE_MESSAGE(loop_is("bottom", "cascade"), board.said);
    expect_setpoint_below(expected);
}

static void while_the_estimate_is_uncertain_the_setpoint_stays_near_the_last_good_one(void)
{
    cascade(NULL, "0.03");
    double good = setpoint_below();
    fail(one_lost);
    plant_step();
    ask_ok("sp outer 0.2");
    plant_steps(HOLD_TICKS - 2);
    TEST_ASSERT_TRUE_MESSAGE(loop_is("outer", "auto"), board.said);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, good + 0.3, setpoint_below());
}

static void after_hold_the_setpoint_below_returns_and_the_loop_below_follows_it(void)
{
    cascade(NULL, "0.03");
    fail(one_lost);
    until_hold_is_over();
    has_returned_to(330);
    TEST_ASSERT_TRUE(events_say(" alarm DOUBTFUL est_iC4 "));
    plant_steps(720);
    has_returned_to(330);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 330, truly("T33"));
}

static void with_all_thermometers_lost_it_returns_likewise(void)
{
    cascade(NULL, "0.03");
    fail(all_lost);
    until_hold_is_over();
    ask_ok("status");
    const char *line = strstr(board.said, "est_iC4 = ");
    TEST_ASSERT_NOT_NULL(line);
    const char *bad = strstr(line, " bad");
    TEST_ASSERT_TRUE_MESSAGE(bad && bad < strchr(line, '\n'), board.said);
    has_returned_to(330);
}

static void the_setpoint_limits_of_the_loop_below_hold_for_the_return(void)
{
    static const char *const limits[] = {"set loop1.sp_lo 320", "set loop1.sp_hi 329.75", NULL};
    cascade(limits, "0.03");
    fail(one_lost);
    until_hold_is_over();
    has_returned_to(329.75);
}

static void each_point_has_its_own_return(void)
{
    static const char *const second[] = {"set loop2.pv est_T23", "set loop2.gain 1", NULL};
    cascade(second, "355");
    fail(one_lost);
    until_hold_is_over();
    has_returned_to(329.5);
}

static void repaired_the_outer_loop_begins_at_the_setpoint_of_the_return(void)
{
    cascade(NULL, "0.03");
    fail(one_lost);
    until_hold_is_over();
    ask_ok("mode outer auto");
    plant_steps(2);
    has_returned_to(330); /* the board refuses the mode */
    plant_event("T30.quality=0");
    plant_steps(100);
    ask_ok("mode outer auto");
    plant_steps(2);
    TEST_ASSERT_TRUE_MESSAGE(loop_is("outer", "auto"), board.said);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 330, setpoint_below());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(while_the_estimate_is_uncertain_the_setpoint_stays_near_the_last_good_one);
    RUN_TEST(after_hold_the_setpoint_below_returns_and_the_loop_below_follows_it);
    RUN_TEST(with_all_thermometers_lost_it_returns_likewise);
    RUN_TEST(the_setpoint_limits_of_the_loop_below_hold_for_the_return);
    RUN_TEST(each_point_has_its_own_return);
    RUN_TEST(repaired_the_outer_loop_begins_at_the_setpoint_of_the_return);
    return UNITY_END();
}

/* Channels of the kind `derived` on the whole firmware, over the link: values and qualities, a loop and an interlock on them, a volume over
 * losses, absences and a restart.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include <math.h>

#include "board_bench.h"

enum { T1, SUMP, HEAD, FLOW };
enum { REFLUX, HEAT };

static void set_all(const char *const *lines)
{
    char line[120];
    for (; *lines; lines++) {
        snprintf(line, sizeof line, "set %s", *lines);
        ask_ok(line);
    }
}
#define SET(...) set_all((const char *const[]){__VA_ARGS__, NULL})

static void measurement(unsigned i, const char *name, const char *unit, double lo, double hi)
{
    char line[80];
    snprintf(line, sizeof line, "set meas%u.name %s", i, name);
    ask_ok(line);
    snprintf(line, sizeof line, "set meas%u.unit %s", i, unit);
    ask_ok(line);
    snprintf(line, sizeof line, "set meas%u.lo %g", i, lo);
    ask_ok(line);
    snprintf(line, sizeof line, "set meas%u.hi %g", i, hi);
    ask_ok(line);
    snprintf(line, sizeof line, "set meas%u.hold 3", i);
    ask_ok(line);
}

/* Sump and head pressure, a tray's temperature, the distillate's flow; and what is derived from them. */
static void set_up(void)
{
    ask_ok("begin");
    measurement(1, "T1", "degC", 60, 160);
    measurement(2, "sump", "mbar", 900, 1200);
    measurement(3, "head", "mbar", 900, 1200);
    measurement(4, "D", "l/h", 0, 20);
    measurement(5, "drop", "mbar", 0, 150);
    measurement(6, "T1c", "degC", 60, 160);
    measurement(7, "mean", "mbar", 900, 1200);
    measurement(8, "drawn", "l", 0, 50);
    SET("mv1.name reflux", "mv1.unit l/h", "mv1.hi 10", "mv1.max 10", "mv2.name heat",
        "mv2.unit kW", "mv2.hi 2", "mv2.max 2", "mv2.safe 0.5");
    SET("loop1.name top", "loop1.pv T1c", "loop1.out reflux", "loop1.action direct",
        "loop1.ti 200");
    SET("block1.kind derived", "block1.inputs T1,sump,head,D", "block1.points drop,T1c,mean,drawn");
    SET("block1.weight.1 0,1,-1,0,0,0,0,0");
    SET("block1.is.2 boil", "block1.weight.2 1,0,0,0,0,0,0,0", "block1.by.2 3",
        "block1.at.2 1013.25", "block1.slope.2 0.028");
    SET("block1.is.3 mean", "block1.weight.3 0,1,1,0,0,0,0,0", "block1.least.3 1");
    SET("block1.is.4 total", "block1.weight.4 0,0,0,1,0,0,0,0", "block1.per.4 h");
    ask_ok("apply");
}

static void plant_is(double t1, double sump, double head, double flow)
{
    board.values[T1] = t1;
    board.values[SUMP] = sump;
    board.values[HEAD] = head;
    board.values[FLOW] = flow;
}

void setUp(void)
{
    static const char *const names[] = {"T1", "sump", "head", "D"};
    static const char *const units[] = {"degC", "mbar", "mbar", "l/h"};
    memory_port_erase_all();
    power_on();
    memcpy(board.names, names, sizeof names);
    memcpy(board.units, units, sizeof units);
    plant_is(80, 1040, 1000, 18);
    set_up();
    connect_plant();
    samples(5);
}
void tearDown(void) {}

/* ---- what `status` says ---- */

static const char *line_of(const char *name)
{
    char begin[40];
    ask_ok("status");
    snprintf(begin, sizeof begin, "%s = ", name);
    for (unsigned i = 0; i < n_reply; i++) {
        const char *at = strstr(reply[i], begin);
        if (at && (at == reply[i] || at[-1] == ' '))
            return at + strlen(begin);
    }
    TEST_FAIL_MESSAGE(name);
    return "";
}

static void reads(const char *name, double value, double within, const char *quality)
{
    const char *line = line_of(name);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(within, value, atof(line), name);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(line, quality), line);
}

static void is_bad(const char *name)
{
    const char *line = line_of(name);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(line, "bad"), line);
}

/* Shift of the boiling point, as set up. */
static double shift(double head)
{
    double l = log(head / 1013.25);
    return 0.028 * 1013.25 * l / (1 - 0.1 * l);
}

/* ---- values and qualities ---- */

static void channels_are_what_their_equations_say(void)
{
    reads("drop", 40, 0.01, "good");
    reads("T1c", 80 - shift(1000), 0.001, "good");
    reads("mean", 1020, 0.01, "good");
    plant_is(81, 1100, 1020, 18);
    samples(1);
    reads("drop", 80, 0.01, "good");
    reads("T1c", 81 - shift(1020), 0.001, "good");
    reads("mean", 1060, 0.01, "good");
}

/* What a held reading stands for is known to a loop, and not to an estimator. */
static void a_channel_is_lost_with_the_source_that_it_needs(void)
{
    board.quality[SUMP] = QUALITY_BAD;
    samples(1);
    reads("drop", 40, 0.01, "uncertain"); /* held */
    reads("mean", 1000, 0.01, "uncertain");
    reads("T1c", 80 - shift(1000), 0.001, "good");
    samples(5);
    is_bad("drop");
    board.quality[HEAD] = QUALITY_BAD;
    samples(6);
    is_bad("mean");
    is_bad("T1c");
    board.quality[SUMP] = board.quality[HEAD] = QUALITY_GOOD;
    samples(1);
    reads("drop", 40, 0.01, "good");
    reads("mean", 1020, 0.01, "good");
}

static void an_uncertain_source_makes_an_uncertain_channel(void)
{
    board.quality[HEAD] = QUALITY_UNCERTAIN;
    samples(1);
    reads("drop", 40, 0.01, "uncertain");
    reads("mean", 1020, 0.01, "uncertain");
}

static void a_loop_acts_on_a_compensated_temperature_and_goes_to_manual_without_a_pressure(void)
{
    ask_ok("out top 5");
    samples(1);
    ask_ok("mode top auto");
    samples(2);
    float before = board.command.output[REFLUX].value;
    plant_is(80, 1050, 1010, 18); /* 10 mbar more: 0.28 K less of the compensated temperature */
    samples(1);
    TEST_ASSERT_TRUE(board.command.output[REFLUX].value < before - 0.01f);
    board.quality[HEAD] = QUALITY_BAD;
    samples(10);
    ask_ok("loop");
    TEST_ASSERT_TRUE_MESSAGE(said("top manual"), board.said);
}

/* The pressure drop rises, and the heat goes down. When the column is free again, the operator may raise it. */
static void an_interlock_on_the_drop_takes_heat_from_a_flooding_column(void)
{
    ask_ok("begin");
    SET("lock1.meas drop", "lock1.mv heat", "lock1.side above", "lock1.limit 80",
        "lock1.hysteresis 30", "lock1.value 0.7");
    SET("block1.ahead.1 20", "block1.lag.1 5");
    ask_ok("apply");
    ask_ok("out heat 1.5");
    samples(3);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 1.5f, board.command.output[HEAT].value);
    unsigned steps = 0;
    for (double drop = 40; board.command.output[HEAT].value > 1 && drop < 120; drop += 1, steps++) {
        plant_is(80, 1000 + drop, 1000, 18);
        samples(1);
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.7f, board.command.output[HEAT].value);
    /* 1 mbar/s, 20 s ahead: at 60 to 65 mbar, behind the lag. */
    TEST_ASSERT_UINT_WITHIN(4, 24, steps);
    ask_ok("alarm");
    TEST_ASSERT_TRUE_MESSAGE(said("INTERLOCK_ON lock1 holds heat"), board.said);
    plant_is(80, 1040, 1000, 18);
    samples(60);
    ask_ok("alarm");
    TEST_ASSERT_FALSE_MESSAGE(said("INTERLOCK_ON"), board.said);
    ask_ok("out heat 1.5");
    samples(1);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 1.5f, board.command.output[HEAT].value);
}

/* ---- volume ---- */

static void begin_volume(void)
{
    ask_ok("block 1 reset 4");
    samples(1); /* a request is met after the channels of its tick have been computed */
}

static void a_volume_is_bad_until_it_is_reset_and_then_counts(void)
{
    is_bad("drawn");
    ask_ok("block 1");
    TEST_ASSERT_TRUE(said("total_4"));
    begin_volume();
    samples(100); /* 18 l/h: 5 ml/s */
    reads("drawn", 0.5, 1e-5, "good");
}

static void lost_samples_cost_no_volume(void)
{
    begin_volume();
    sample_after(1000);
    board.number++;
    sample_after(2000);
    sample_after(1000);
    reads("drawn", 0.02, 1e-5, "good");
}

static void a_volume_says_what_it_missed(void)
{
    begin_volume();
    samples(10);
    board.quality[FLOW] = QUALITY_BAD;
    samples(20);
    is_bad("drawn");
    board.quality[FLOW] = QUALITY_GOOD;
    samples(10);
    reads("drawn", 0.095, 1e-5, "uncertain");
    ask_ok("block 1");
    TEST_ASSERT_TRUE_MESSAGE(said("missed_4 = 21"), board.said);
    begin_volume();
    samples(10);
    reads("drawn", 0.05, 1e-5, "good");
}

static void a_volume_over_an_absence_of_the_plant_is_uncertain(void)
{
    begin_volume();
    samples(10);
    board.mute = true;
    pass(20000);
    board.session++;
    connect_plant();
    board.time_ms += 20000;
    samples(3);
    reads("drawn", 0.06, 1e-5, "uncertain");
}

static void a_volume_does_not_survive_a_restart(void)
{
    begin_volume();
    samples(100);
    ask_ok("save");
    pass(2000);
    const char *names[4], *units[4];
    memcpy(names, board.names, sizeof names);
    memcpy(units, board.units, sizeof units);
    power_on();
    memcpy(board.names, names, sizeof names);
    memcpy(board.units, units, sizeof units);
    plant_is(80, 1040, 1000, 18);
    connect_plant();
    samples(5);
    reads("drop", 40, 0.01, "good");
    is_bad("drawn");
}

static void what_cannot_be_is_refused_with_its_reason(void)
{
    ask_ok("begin");
    SET("block1.weight.1 0,0,0,0,0,0,0,1");
    ask_refused("apply", "RANGE");
    TEST_ASSERT_TRUE_MESSAGE(said("block1.weight"), board.said);
    ask_ok("abandon");
    ask_ok("block 1 reset 2");
    board_forget();
    samples(2);
    TEST_ASSERT_TRUE_MESSAGE(said("BLOCK_REFUSED no_total 1"), board.said);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(channels_are_what_their_equations_say);
    RUN_TEST(a_channel_is_lost_with_the_source_that_it_needs);
    RUN_TEST(an_uncertain_source_makes_an_uncertain_channel);
    RUN_TEST(a_loop_acts_on_a_compensated_temperature_and_goes_to_manual_without_a_pressure);
    RUN_TEST(an_interlock_on_the_drop_takes_heat_from_a_flooding_column);
    RUN_TEST(a_volume_is_bad_until_it_is_reset_and_then_counts);
    RUN_TEST(lost_samples_cost_no_volume);
    RUN_TEST(a_volume_says_what_it_missed);
    RUN_TEST(a_volume_over_an_absence_of_the_plant_is_uncertain);
    RUN_TEST(a_volume_does_not_survive_a_restart);
    RUN_TEST(what_cannot_be_is_refused_with_its_reason);
    return UNITY_END();
}

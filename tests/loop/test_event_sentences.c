/* Events as people read them: sentences with values in their units. Scripts read code, number and text as before. */
#include "board_bench.h"

#include "console/event_sentence.h"
#include "exchange/alarm_names.h"

static struct config config;

void setUp(void)
{
    memset(&config, 0, sizeof config);
    strcpy(config.measurement[0].name, "T10");
    strcpy(config.measurement[0].unit, "degC");
    strcpy(config.measurement[1].name, "feed");
    strcpy(config.measurement[1].unit, "l/h");
    strcpy(config.mv[0].name, "heat");
    strcpy(config.mv[0].unit, "kW");
    strcpy(config.loop[0].name, "bottom");
    strcpy(config.loop[0].pv, "T10");
    strcpy(config.loop[0].out, "heat");
    strcpy(config.loop[1].name, "outer");
    strcpy(config.loop[1].pv, "feed");
    strcpy(config.loop[1].out, "bottom");
}
void tearDown(void) {}

static void reads_in_detail(uint8_t code, const char *subject, float value, uint8_t detail,
                            const char *wanted)
{
    char line[240];
    struct text t = text_on(line, sizeof line);
    struct event e = event_make(5000, EVENT_STARTED, subject, value, detail);
    e.code = code;
    event_sentence(&config, &e, &t);
    TEST_ASSERT_EQUAL_STRING(wanted, line);
}

static void reads(uint8_t code, const char *subject, float value, const char *wanted)
{
    reads_in_detail(code, subject, value, 0, wanted);
}

static void setpoints_modes_and_outputs_are_short_and_have_their_units(void)
{
    reads(EVENT_SETPOINT, "bottom", 112.5f, "5.000 info bottom setpoint 112.5 degC");
    reads(EVENT_MODE, "bottom", 1.0f, "5.000 info bottom AUTO");
    reads(EVENT_MODE, "bottom", 2.0f, "5.000 info bottom CASCADE");
    reads(EVENT_MODE, "bottom", 7.0f, "5.000 info bottom ?");
    reads(EVENT_OUTPUT, "heat", 0.5f, "5.000 info heat output 0.5 kW");
    reads(EVENT_OUTPUT, "bottom", 0.5f, "5.000 info bottom output 0.5 kW");
    reads(EVENT_OUTPUT, "outer", 110.0f, "5.000 info outer output 110 degC");
    reads(EVENT_OUTPUT, "gone", 110.0f, "5.000 info gone output 110");
}

static void the_start_keeps_its_code(void)
{
    reads(EVENT_STARTED, "power-on", 0.0f,
          "5.000 info started in the safe state: power-on (STARTED)");
}

static void values_have_four_digits_and_counts_all(void)
{
    reads(EVENT_SETPOINT, "bottom", 112.34567f, "5.000 info bottom setpoint 112.3 degC");
    reads(EVENT_SAMPLE_MISSING, NULL, 123456.0f,
          "5.000 warning 123456 samples missing (SAMPLE_MISSING)");
}

static void the_value_stands_behind_the_words_that_say_what_it_is(void)
{
    reads(EVENT_CONFIG_APPLIED, NULL, 1.0f, "5.000 info configuration applied, base tick 1 s");
    reads(EVENT_NOT_FOLLOWING, "heat", 0.25f,
          "5.000 warning heat: output does not follow its command, read-back 0.25 kW "
          "(NOT_FOLLOWING)");
    reads(EVENT_SAMPLE_OVERDUE, NULL, 5.0f,
          "5.000 alarm plant connected but sends no sample 5 s (SAMPLE_OVERDUE)");
    reads(
        EVENT_DEVIATION, "bottom", -12.25f,
        "5.000 alarm bottom: the PV has been far from its setpoint for long, distance -12.25 degC "
        "(DEVIATION)");
    reads(EVENT_LOOP_DIVISOR, "bottom", 5.0f,
          "5.000 warning bottom: divisor is no multiple of the ticks between samples of its "
          "measurement, ticks 5 (LOOP_DIVISOR)");
    reads(EVENT_TEST_STEP, "heat", 0.025f,
          "5.000 info heat: test of this input, amplitude 2.5 % of span");
    reads(EVENT_SEQUENCE_STEP, "start", 3.0f, "5.000 info start: sequence waits at step 3");
}

/* A loop may have the name of its output, or of a measurement that is not its PV. */
static void a_value_has_the_unit_of_what_the_event_is_about(void)
{
    strcpy(config.loop[0].name, "heat");
    strcpy(config.loop[1].name, "T10");
    reads(EVENT_NOT_FOLLOWING, "heat", 0.25f,
          "5.000 warning heat: output does not follow its command, read-back 0.25 kW "
          "(NOT_FOLLOWING)");
    reads(EVENT_DEVIATION_OVER, "heat", 0.5f,
          "5.000 info heat: the PV is near its setpoint again, or the loop in manual, distance "
          "0.5 degC");
    reads(EVENT_WATCH_LOOP, "heat", 0.5f,
          "5.000 info heat: watched, see `commission watched`, largest error 0.5 degC");
    reads(EVENT_SETPOINT, "heat", 99.0f, "5.000 info heat setpoint 99 degC");
    reads(EVENT_SETPOINT, "T10", 2.0f, "5.000 info T10 setpoint 2 l/h");
    reads(EVENT_MEASUREMENT_GOOD, "T10", 99.0f, "5.000 info T10 usable again, 99 degC");
    reads(EVENT_DOUBTFUL_OVER, "T10", 99.0f,
          "5.000 info T10: no loop acts on an uncertain reading any more, reading 99 degC");
    reads(EVENT_OFFSET, "T10", 1.5f, "5.000 info 1.5 degC subtracted from T10");
    reads(EVENT_TEST_SMALLER, "T10", 0.01f,
          "5.000 info T10: step too large, test repeated with a smaller one, amplitude 1 % of "
          "span");
    strcpy(config.alarm[0].on, "T10");
    strcpy(config.alarm[1].on, "T10");
    config.alarm[1].side = ALARM_DEVIATION;
    reads(EVENT_ALARM_ON, "T10.hi_hi", 121.0f,
          "5.000 alarm T10.hi_hi: 121 degC, beyond its limit (ALARM_ON)");
    reads(EVENT_ALARM_ON, "T10.dev", 0.5f,
          "5.000 alarm T10.dev: 0.5 l/h, beyond its limit (ALARM_ON)");
}

/* A long name is cut for the side of its alarm, "pressure_at.hi_hi". */
static void an_alarm_whose_name_is_cut_has_its_unit(void)
{
    strcpy(config.measurement[0].name, "pressure_at_top");
    strcpy(config.measurement[0].unit, "mbar");
    strcpy(config.alarm[0].on, "pressure_at_top");
    char name[CHANNEL_NAME_SIZE];
    alarm_name(&config, 0, name);
    TEST_ASSERT_EQUAL_STRING("pressure_.hi_hi", name);
    reads(EVENT_ALARM_OFF, name, 20.0f, "5.000 info pressure_.hi_hi: 20 mbar, the alarm is over");
}

static void interlocks_name_what_they_watch_where_it_is_sure(void)
{
    strcpy(config.interlock[0].mv, "heat");
    strcpy(config.interlock[0].measurement, "T10");
    reads(EVENT_INTERLOCK_ON, "heat", 125.0f,
          "5.000 alarm interlock holds heat, T10 125 degC: lock1 (INTERLOCK_ON)");
    strcpy(config.interlock[1].mv, "heat");
    strcpy(config.interlock[1].measurement, "feed");
    reads_in_detail(EVENT_INTERLOCK_OFF, "heat", 3.0f, 1,
                    "5.000 info interlock releases heat, feed 3 l/h: lock2");
    reads_in_detail(EVENT_INTERLOCK_OFF, "heat", 3.0f, CONFIG_INTERLOCKS,
                    "5.000 info interlock releases heat, measurement 3: lock9");
    strcpy(config.interlock[1].mv, "other"); /* the settings have changed since */
    reads_in_detail(EVENT_INTERLOCK_OFF, "heat", 3.0f, 1,
                    "5.000 info interlock releases heat, measurement 3: lock2");
}

static void alarms_say_their_code_and_the_fault_in_words(void)
{
    strcpy(config.alarm[0].on, "T10");
    config.alarm[0].side = ALARM_HI;
    reads(EVENT_ALARM_ON, "T10.hi", 121.0f,
          "5.000 alarm T10.hi: 121 degC, beyond its limit (ALARM_ON)");
    reads_in_detail(EVENT_MEASUREMENT_BAD, "T10", 312.0f, 1,
                    "5.000 alarm T10 not usable at 312 degC, last value held: missing "
                    "(MEASUREMENT_BAD)");
    reads_in_detail(EVENT_SEQUENCE_HELD, "T10", 3.0f, 0x11,
                    "5.000 warning T10: sequence held at step 3: start, time-out (SEQUENCE_HELD)");
}

static void blocks_are_named_by_number_and_kind(void)
{
    reads(EVENT_BLOCK_VERB, "block2.settle", 0.0f, "5.000 info block 2: settle done");
    reads(EVENT_BLOCK_ON, "gmv", 2.0f, "5.000 info block 2 (gmv) acts for its loops again");
    reads(EVENT_BLOCK_GAVE_UP, "T10", 2.0f,
          "5.000 alarm block 2 (T10) gave up, its loops go on without it (BLOCK_GAVE_UP)");
    reads(EVENT_EXCITATION_ENDED, "limit", 1.0f,
          "5.000 info block 1 (limit): the test signal of a block is over");
}

static void repeats_are_counted(void)
{
    reads(EVENT_NOT_FOLLOWING | EVENT_REPEATED, "heat", 12.0f,
          "5.000 warning heat: output does not follow its command, 12 times so far, this is the "
          "latest (NOT_FOLLOWING)");
}

static void zero_is_said_in_words_of_its_own(void)
{
    reads(EVENT_ALARM_SHELVED, "T10.hi", 60.0f, "5.000 info alarm T10.hi silent for 60 s");
    reads(EVENT_ALARM_SHELVED, "T10.hi", 0.0f, "5.000 info alarm T10.hi no longer silent");
    reads(EVENT_RESTART_DONE, NULL, 1.0f,
          "5.000 warning as before the reset: outputs (RESTART_DONE)");
    reads(EVENT_RESTART_DONE, NULL, 2.0f,
          "5.000 warning as before the reset: outputs, modes, setpoints (RESTART_DONE)");
}

static void actions_say_who_did_it(void)
{
    reads_in_detail(EVENT_DO_SET, "loop1.gain", 2.0f, EVENT_ENGINEER,
                    "5.000 action loop1.gain set to 2, by engineer");
    reads(EVENT_DO_SETPOINT, "bottom", 112.5f,
          "5.000 action bottom setpoint 112.5 degC requested, by operator");
    reads(EVENT_DO_MODE, "bottom", 1.0f, "5.000 action bottom AUTO requested, by operator");
}

/* No text of the list may leave a mark of a pattern, a blank at an end, or a semicolon before a value that is missing. */
static void every_event_makes_a_sentence(void)
{
    char line[240];
    for (unsigned code = 0; code < EVENT_COUNT; code++) {
        struct text t = text_on(line, sizeof line);
        struct event e = event_make(5000, (enum event_code)code, "bottom", 1.0f, 1);
        event_sentence(&config, &e, &t);
        TEST_ASSERT_FALSE_MESSAGE(t.cut, line);
        TEST_ASSERT_NULL_MESSAGE(strstr(line, "%s"), line);
        TEST_ASSERT_NULL_MESSAGE(strstr(line, "  "), line);
        TEST_ASSERT_NULL_MESSAGE(strchr(line, '|'), line);
        TEST_ASSERT_NOT_EQUAL_MESSAGE(' ', line[t.n - 1], line);
        TEST_ASSERT_GREATER_THAN_MESSAGE(15, t.n, line);
    }
}

static void people_read_sentences_and_scripts_codes(void)
{
    running();
    ask_ok("mode bottom auto");
    type("mode human\r");
    board_forget();
    type("sp bottom 112.5\r");
    samples(1);
    TEST_ASSERT_TRUE_MESSAGE(said("! 6.000 info bottom AUTO\r\n"), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said("! 6.000 info bottom setpoint 112.5 degC\r\n"), board.said);
    board_forget();
    type("events\r");
    TEST_ASSERT_TRUE_MESSAGE(said("  6.000 info bottom setpoint 112.5 degC\r\n"), board.said);
    type("mode machine\n");
    ask_ok("events");
    TEST_ASSERT_TRUE_MESSAGE(said("  6.000 info SETPOINT bottom 112.5 new setpoint\n"), board.said);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(setpoints_modes_and_outputs_are_short_and_have_their_units);
    RUN_TEST(the_start_keeps_its_code);
    RUN_TEST(values_have_four_digits_and_counts_all);
    RUN_TEST(the_value_stands_behind_the_words_that_say_what_it_is);
    RUN_TEST(a_value_has_the_unit_of_what_the_event_is_about);
    RUN_TEST(an_alarm_whose_name_is_cut_has_its_unit);
    RUN_TEST(interlocks_name_what_they_watch_where_it_is_sure);
    RUN_TEST(alarms_say_their_code_and_the_fault_in_words);
    RUN_TEST(blocks_are_named_by_number_and_kind);
    RUN_TEST(repeats_are_counted);
    RUN_TEST(zero_is_said_in_words_of_its_own);
    RUN_TEST(actions_say_who_did_it);
    RUN_TEST(every_event_makes_a_sentence);
    RUN_TEST(people_read_sentences_and_scripts_codes);
    return UNITY_END();
}

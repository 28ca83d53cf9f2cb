/* Input that people write for a run: events and scripts. Wrong input is refused with a line that helps. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench/events.h"
#include "bench/script.h"
#include "bench/text.h"
#include "two_by_two.h"
#include "unity.h"

static struct events events;
static struct script script;
static char err[SIM_ERROR_SIZE];

void setUp(void)
{
    events = (struct events){.n = 0};
    script = (struct script){.file = "run.txt"};
    err[0] = '\0';
}

void tearDown(void)
{
    script_free(&script);
}

static bool event(const char *text)
{
    return events_add(&events, &two_by_two, text, err, sizeof(err));
}

static void refused(const char *text, const char *because)
{
    TEST_ASSERT_FALSE_MESSAGE(event(text), text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err, because), err);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err, text), err); /* says where */
    TEST_ASSERT_NULL(strchr(err, '\n'));                  /* one line */
}

static void good_events_are_taken(void)
{
    const char *good[] = {"0:d=5",          "10.5:d=-1e0",   "1e3:u1.hi=50",
                          "1:u1.lo=0",      "5:u2.slew=0.1", "5:u2.stuck=12",
                          "6:u2.free=1",    "7:y1.bias=-3",  "7:y1.noise=0.5",
                          "8:y1.quality=2", "9:y2.lag=12.5", "9:y2.resolution=0",
                          "10:noise=3",     "11:u1.lag=4",   "12:board.power_cut=2"};
    for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++) {
        TEST_ASSERT_TRUE_MESSAGE(event(good[i]), err);
    }
    TEST_ASSERT_TRUE_MESSAGE(events_finish(&events, &two_by_two, err, sizeof(err)), err);
    for (size_t i = 1; i < events.n; i++) {
        TEST_ASSERT_TRUE(events.list[i - 1].time_s <= events.list[i].time_s);
    }
}

static void faults_of_a_board_are_checked(void)
{
    refused("1:board.meteor=1", "a board has no fault");
    refused("1:board.power_cut=0", "board.power_cut must be 0.001 to 3600 s");
    refused("1:board.flip_ram=1.5", "board.flip_ram must be a whole number");
    TEST_ASSERT_FALSE(events_want_board(&events));
    TEST_ASSERT_TRUE(event("1:board.crystal=0"));
    TEST_ASSERT_TRUE(events_want_board(&events));
}

/* A wiring file of these lines, whose names events may have. */
static struct wiring *wire(const char *text)
{
    char path[] = "/tmp/scenario_input_XXXXXX";
    int file = mkstemp(path);
    TEST_ASSERT_TRUE(file >= 0);
    TEST_ASSERT_EQUAL_INT((int)strlen(text), (int)write(file, text, strlen(text)));
    (void)close(file);
    struct wiring *w = wiring_read(path, 1, err, sizeof(err));
    (void)remove(path);
    TEST_ASSERT_NOT_NULL_MESSAGE(w, err);
    return w;
}

static const char wired[] = "y1 max31856 spi1 PA4 type=K\n"
                            "y2 ads1115  i2c1 0x48 1 lo=0 hi=100 lo_in=0.4 hi_in=2\n"
                            "u1 ssr      PB0\n"
                            "u2 valve    PB1 PC2 travel=60\n";

static void faults_of_what_is_wired_are_taken(void)
{
    static const char *const good[] = {"1:y1.open=1",    "2:y1.open=0",        "1:y1.missing=1",
                                       "1:y1.cold=60",   "1:y2.frozen=1",      "1:y2.dead=1",
                                       "1:u1.shorted=1", "1:u2.broken=1",      "1:spi1.noise=1e-4",
                                       "1:i2c1.stuck=1", "1:spi1.floats_low=1"};
    struct wiring *w = wire(wired);
    events.wiring = w;
    for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++) {
        TEST_ASSERT_TRUE_MESSAGE(event(good[i]), err);
        TEST_ASSERT_EQUAL_INT_MESSAGE(EVENT_PINS, events.list[i].kind, good[i]);
        const char *name = strchr(good[i], ':') + 1;
        TEST_ASSERT_EQUAL_STRING_LEN(name, events.list[i].pins, strcspn(name, "="));
    }
    wiring_free(w);
}

static void an_option_that_only_the_instrument_has_stays_its_own_with_a_wiring(void)
{
    static const char *const own[] = {"1:y1.bias=3", "1:y2.stuck=4", "1:y1.frozen=1", "1:u1.hi=50"};
    struct wiring *w = wire(wired);
    events.wiring = w;
    for (size_t i = 0; i < sizeof(own) / sizeof(own[0]); i++) {
        TEST_ASSERT_TRUE_MESSAGE(event(own[i]), err);
        TEST_ASSERT_EQUAL_INT_MESSAGE(EVENT_OPTION, events.list[i].kind, own[i]);
    }
    wiring_free(w);
}

static void faults_that_a_line_does_not_have_are_refused_with_those_that_it_has(void)
{
    struct wiring *w = wire(wired);
    events.wiring = w;
    refused("1:y1.opne=1",
            "y1 has no fault \"opne\"; it has missing, dead, wrong, cold, open, short");
    refused("1:y1.opne=1", "; before the pins it has bias, noise");
    refused("1:y1.quality=2", "y1 has no fault \"quality\""); /* the plant link would say it */
    refused("1:u1.readback=1", "u1 has no fault \"readback\"; it has shorted, broken");
    refused("1:u2.shorted=1", "u2 has no fault \"shorted\"; it has broken");
    refused("1:i2c1.floats_low=1", "i2c1 has no fault \"floats_low\"; it has noise, stuck");
    refused("1:y1.open=2", "y1.open must be 0 to 1");
    refused("1:y1.cold=200", "y1.cold must be -64 to 150 degC");
    refused("1:spi1.noise=-1", "spi1.noise must be 0 to 1");
    refused("1:spi2.noise=0", "has \"spi2\"; wired are y1, y2, u1, u2, spi1, i2c1");
    wiring_free(w);
}

static void faults_of_what_is_wired_need_a_wiring(void)
{
    refused("1:y1.open=1", "y1 has no option \"open\"");
    refused("1:spi1.noise=1", "has no \"spi1\"");
}

static void events_of_wrong_form_are_refused(void)
{
    const char *wrong[] = {"", ":", "5", "5:", "5:d", "d=5", ":d=5", "5:=3", "5d=3"};
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        refused(wrong[i], "expected T:NAME=VALUE");
    }
}

/* Types what the message shows into the option it is about. */
static void example_is_taken(const struct plant_class *class)
{
    char example[64];
    struct events none = {.n = 0};
    TEST_ASSERT_FALSE(events_add(&none, class, "rubbish", err, sizeof(err)));
    const char *at = strstr(err, ", as in ");
    TEST_ASSERT_NOT_NULL_MESSAGE(at, err);
    (void)snprintf(example, sizeof(example), "%s", at + 8);
    TEST_ASSERT_TRUE_MESSAGE(events_add(&none, class, example, err, sizeof(err)), err);
}

static void the_example_of_the_form_is_one_the_plant_takes(void)
{
    struct plant_channel controlled[] = {two_by_two.channels[0], two_by_two.channels[0]};
    for (size_t i = 0; i < two_by_two.n_channels; i++) {
        if (two_by_two.channels[i].kind == PLANT_MEASUREMENT) {
            controlled[1] = two_by_two.channels[i];
        }
    }
    struct plant_class without = two_by_two; /* no disturbance */
    without.channels = controlled;
    without.n_channels = 2;
    example_is_taken(&two_by_two);
    example_is_taken(&without);
}

static void events_with_wrong_times_are_refused(void)
{
    const char *wrong[] = {"-1:d=5",  "x:d=5",    "1s:d=5", "nan:d=5",
                           "inf:d=5", "0x10:d=5", " 1:d=5", "1e999:d=5"};
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        refused(wrong[i], "must be a number of seconds");
    }
}

static void events_with_wrong_values_are_refused(void)
{
    const char *wrong[] = {"1:d=", "1:d=x", "1:d=1x", "1:d=nan", "1:d=inf", "1:d=1 ", "1:d=0x1"};
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        refused(wrong[i], "is not a number");
    }
    refused("1:d=10.5", "d must be -10 to 10 degC");
    refused("1:u1.hi=101", "u1.hi must be 0 to 100 %");
    refused("1:u1.slew=-1", "u1.slew must be 0 to");
    refused("1:u1.free=0", "u1.free must be 1 to 1");
    refused("1:y1.noise=-0.1", "y1.noise must be 0 to");
    refused("1:y1.quality=4", "y1.quality must be 0 to 3");
    refused("1:y1.quality=1.5", "must be 0, 1, 2 or 3");
    refused("1:y1.quality=1e300", "y1.quality must be 0 to 3");
    refused("1:noise=-1", "noise must be 0 to");
}

static void events_with_unknown_names_are_told_the_candidates(void)
{
    refused("1:dd=1",
            "disturbances: d (swing, period); with an option behind a dot: y1, y2 (bias, ");
    refused("1:load=1", "has no \"load\"");
    refused("1:zz.hi=1", "has no \"zz\"");
    refused("1:d.hi=1", "the disturbance d has no option \"hi\"; it has swing, period");
    refused("1:y1.hi=1", "y1 has no option \"hi\"; it has bias, noise, resolution, quality, lag");
    refused("1:u1.bias=1", "u1 has no option \"bias\"; it has lag, hi, lo, slew, stuck, free");
    refused("1:u1.=1", "u1 has no option \"\"");
    refused("1:u1=1", "is driven by the controller");
    refused("1:y1=1", "is measured");
}

static void limits_that_cross_are_refused(void)
{
    TEST_ASSERT_TRUE(event("20:u1.hi=30"));
    TEST_ASSERT_TRUE(event("10:u1.lo=40"));
    TEST_ASSERT_FALSE(events_finish(&events, &two_by_two, err, sizeof(err)));
    TEST_ASSERT_EQUAL_STRING(
        "--event: at 20 s u1.lo is 40 and u1.hi is 30; lo must not be above hi", err);
}

static void limits_that_move_together_are_taken_in_either_order(void)
{
    TEST_ASSERT_TRUE(event("10:u1.hi=30"));
    TEST_ASSERT_TRUE(event("20:u1.lo=40"));
    TEST_ASSERT_TRUE(event("20:u1.hi=60"));
    TEST_ASSERT_TRUE_MESSAGE(events_finish(&events, &two_by_two, err, sizeof(err)), err);
}

static void events_act_at_their_time_and_once(void)
{
    static struct instruments in;
    struct plant *plant = two_by_two.create(err, sizeof(err));
    TEST_ASSERT_TRUE(instruments_init(&in, &two_by_two, 1, 0.0, err, sizeof(err)));
    TEST_ASSERT_TRUE(event("20:d=4"));
    TEST_ASSERT_TRUE(event("10:d=3"));
    TEST_ASSERT_TRUE(event("15:u1.hi=50"));
    TEST_ASSERT_TRUE(events_finish(&events, &two_by_two, err, sizeof(err)));
    TEST_ASSERT_TRUE(events_apply(&events, 9.999, plant, &in, err, sizeof(err)));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, two_by_two.value(plant, 2));
    TEST_ASSERT_TRUE(events_apply(&events, 10.0, plant, &in, err, sizeof(err)));
    TEST_ASSERT_EQUAL_DOUBLE(3.0, two_by_two.value(plant, 2));
    TEST_ASSERT_EQUAL_DOUBLE(100.0, in.actuator[0].hi);
    TEST_ASSERT_TRUE(events_apply(&events, 30.0, plant, &in, err, sizeof(err)));
    TEST_ASSERT_EQUAL_DOUBLE(4.0, two_by_two.value(plant, 2));
    TEST_ASSERT_EQUAL_DOUBLE(50.0, in.actuator[0].hi);
    TEST_ASSERT_EQUAL_size_t(3, events.next);
    two_by_two.destroy(plant);
}

static bool line(const char *text)
{
    return script_add(&script, text, 7, err, sizeof(err));
}

static void script_lines_are_read(void)
{
    TEST_ASSERT_TRUE(line("# comment"));
    TEST_ASSERT_TRUE(line("   "));
    TEST_ASSERT_TRUE(line(""));
    TEST_ASSERT_TRUE_MESSAGE(line("0 log on"), err);
    TEST_ASSERT_TRUE_MESSAGE(line("  12.5\t set T1.kp 3.5  \r\n"), err);
    TEST_ASSERT_TRUE_MESSAGE(line("12.5 ?set nonsense 1"), err);
    TEST_ASSERT_TRUE_MESSAGE(line("13 ? status"), err);
    TEST_ASSERT_EQUAL_size_t(4, script.n);
    TEST_ASSERT_EQUAL_STRING("log on", script.list[0].text);
    TEST_ASSERT_EQUAL_STRING("set T1.kp 3.5", script.list[1].text);
    TEST_ASSERT_EQUAL_DOUBLE(12.5, script.list[1].time_s);
    TEST_ASSERT_FALSE(script.list[1].may_fail);
    TEST_ASSERT_TRUE(script.list[2].may_fail);
    TEST_ASSERT_EQUAL_STRING("set nonsense 1", script.list[2].text);
    TEST_ASSERT_EQUAL_STRING("status", script.list[3].text);
    TEST_ASSERT_EQUAL_UINT(7, script.list[0].line);
}

static void wrong_script_lines_are_refused_with_file_and_line(void)
{
    const char *wrong[][2] = {{"log on", "the time \"log\" must be"},
                              {"5", "expected <time in s> <console line>"},
                              {"5   ", "expected <time in s>"},
                              {"-1 x", "must be a number of seconds"},
                              {"nan x", "must be a number of seconds"},
                              {"5 ?", "must have 1 to"},
                              {"5 ~x", "after ~ the words are"},
                              {"5 ~until", "after ~"},
                              {"5 ~until PROPOSAL -3", "after ~"},
                              {"5 ~end now", "after ~"},
                              {"5 a\x01"
                               "b",
                               "byte 2 of the console line"}};
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        TEST_ASSERT_FALSE_MESSAGE(line(wrong[i][0]), wrong[i][0]);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err, wrong[i][1]), err);
        TEST_ASSERT_EQUAL_INT(0, strncmp(err, "run.txt:7: ", 11));
    }
    TEST_ASSERT_TRUE(line("10 x"));
    TEST_ASSERT_FALSE(line("9 y"));
    TEST_ASSERT_EQUAL_STRING("run.txt:7: time 9 s comes after 10 s; lines must be in order", err);
    char long_line[400];
    memset(long_line, 'x', sizeof(long_line));
    memcpy(long_line, "20 ", 3);
    long_line[399] = '\0';
    TEST_ASSERT_FALSE(line(long_line));
    TEST_ASSERT_EQUAL_size_t(1, script.n);
}

static void a_script_that_is_not_there_is_named(void)
{
    TEST_ASSERT_FALSE(script_load(&script, "no/such/file", err, sizeof(err)));
    TEST_ASSERT_EQUAL_STRING("--script no/such/file: No such file or directory", err);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(good_events_are_taken);
    RUN_TEST(faults_of_a_board_are_checked);
    RUN_TEST(faults_of_what_is_wired_are_taken);
    RUN_TEST(an_option_that_only_the_instrument_has_stays_its_own_with_a_wiring);
    RUN_TEST(faults_that_a_line_does_not_have_are_refused_with_those_that_it_has);
    RUN_TEST(faults_of_what_is_wired_need_a_wiring);
    RUN_TEST(events_of_wrong_form_are_refused);
    RUN_TEST(the_example_of_the_form_is_one_the_plant_takes);
    RUN_TEST(events_with_wrong_times_are_refused);
    RUN_TEST(events_with_wrong_values_are_refused);
    RUN_TEST(events_with_unknown_names_are_told_the_candidates);
    RUN_TEST(limits_that_cross_are_refused);
    RUN_TEST(limits_that_move_together_are_taken_in_either_order);
    RUN_TEST(events_act_at_their_time_and_once);
    RUN_TEST(script_lines_are_read);
    RUN_TEST(wrong_script_lines_are_refused_with_file_and_line);
    RUN_TEST(a_script_that_is_not_there_is_named);
    return UNITY_END();
}

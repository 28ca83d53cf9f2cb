/* A board and a plant in the caller's process (tools/libreflux/lab.h): what Python loads. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "lab.h"
#include "unity.h"

static const char *const pilot[] = {"--plant", "pilot", "--tick", "30"};

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_open(4, pilot));
}

void tearDown(void)
{
    reflux_lab_close();
}

static void say(const char *line)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(LAB_DONE, reflux_lab_say(line), line);
}

static const char *text(int32_t which)
{
    size_t length;
    const char *given = reflux_lab_text(which, &length);
    TEST_ASSERT_EQUAL_size_t(strlen(given), length);
    return given;
}

static void time_goes_on_by_a_tick_with_each_sample(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(30.0, reflux_lab_tick_s());
    TEST_ASSERT_EQUAL_DOUBLE(0.0, reflux_lab_time_s());
    TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_step(3));
    TEST_ASSERT_EQUAL_DOUBLE(90.0, reflux_lab_time_s());
    TEST_ASSERT_EQUAL_UINT32(3, reflux_lab_number());
}

static void texts_have_what_came_since_they_were_last_taken(void)
{
    say("log on 1");
    TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_step(1));
    TEST_ASSERT_NOT_NULL(strstr(text(LAB_LOG), "\n0,0,"));
    TEST_ASSERT_NOT_NULL(strstr(text(LAB_TELEMETRY), "\nT,1,0,"));
    const char *console = text(LAB_CONSOLE);
    TEST_ASSERT_NOT_NULL(strstr(console, "\n0.000 > log on 1\n"));
    TEST_ASSERT_NOT_NULL(strstr(console, "\n0.000 < T,1,0,"));
    TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_step(1));
    TEST_ASSERT_EQUAL_STRING_LEN("1,30,", text(LAB_LOG), 5);
    TEST_ASSERT_EQUAL_STRING_LEN("T,1,1,", text(LAB_TELEMETRY), 6);
    TEST_ASSERT_EQUAL_STRING("", text(LAB_LOG));
}

static void a_refusal_of_the_board_has_its_words_and_the_lab_goes_on(void)
{
    TEST_ASSERT_EQUAL_INT(LAB_REFUSED, reflux_lab_say("mode nowhere auto"));
    TEST_ASSERT_EQUAL_STRING_LEN("err UNKNOWN nowhere", reflux_lab_error(), 19);
    say("status");
}

static void a_line_that_is_too_long_is_refused(void)
{
    char line[400];
    (void)memset(line, 'x', sizeof(line));
    line[sizeof(line) - 1] = '\0';
    TEST_ASSERT_EQUAL_INT(LAB_REFUSED, reflux_lab_say(line));
    TEST_ASSERT_NOT_NULL(strstr(reflux_lab_error(), "at most 255 characters"));
    say("status");
}

static void a_channel_has_its_value(void)
{
    TEST_ASSERT_TRUE(isnan(reflux_lab_value("T1")));
    TEST_ASSERT_EQUAL_DOUBLE(4.5, reflux_lab_value("Lr"));
    TEST_ASSERT_EQUAL_DOUBLE(5.0, reflux_lab_value("F"));
    TEST_ASSERT_TRUE(isnan(reflux_lab_value("nowhere")));
    TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_step(1));
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 87.1, reflux_lab_value("T1"));
}

static void channels_are_counted_from_0_to_the_last(void)
{
    const char *unit;
    int32_t kind;
    double lo, hi, nominal;
    int32_t n = 0;
    bool found = false;
    const char *name;
    while ((name = reflux_lab_channel(n, &unit, &kind, &lo, &hi, &nominal)) != NULL) {
        if (strcmp(name, "Lr") == 0) {
            found = true;
            TEST_ASSERT_EQUAL_STRING("l/h", unit);
            TEST_ASSERT_EQUAL_DOUBLE(4.5, nominal);
        }
        n++;
    }
    TEST_ASSERT_TRUE(found);
    TEST_ASSERT_NULL(reflux_lab_channel(-1, &unit, &kind, &lo, &hi, &nominal));
}

static void an_event_meets_the_next_sample(void)
{
    TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_step(2));
    TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_event("0:F=5.5"));
    TEST_ASSERT_EQUAL_DOUBLE(5.0, reflux_lab_value("F"));
    TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_step(1));
    TEST_ASSERT_EQUAL_DOUBLE(5.5, reflux_lab_value("F"));
}

static void a_wrong_event_is_refused_and_changes_nothing(void)
{
    TEST_ASSERT_EQUAL_INT(LAB_REFUSED, reflux_lab_event("0:F=1000"));
    TEST_ASSERT_NOT_NULL(strstr(reflux_lab_error(), "F must be 0 to 10 l/h"));
    TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_event("0:Qrb.hi=0.6"));
    TEST_ASSERT_EQUAL_INT(LAB_REFUSED, reflux_lab_event("0:Qrb.lo=0.7"));
    TEST_ASSERT_NOT_NULL(strstr(reflux_lab_error(), "lo must not be above hi"));
    TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_event("0:Qrb.lo=0.5"));
    TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_step(1));
}

static void more_events_than_there_is_room_for_are_taken_when_later_ones_replace_them(void)
{
    for (int k = 0; k < 3000; k++) {
        char event[40];
        (void)snprintf(event, sizeof(event), "0:F=%d", 4 + k % 2);
        TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_event(event));
        TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_step(k % 100 == 0 ? 1 : 0));
    }
    TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_step(1));
    TEST_ASSERT_EQUAL_DOUBLE(5.0, reflux_lab_value("F"));
}

static void a_board_that_reboots_goes_on(void)
{
    TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_step(2));
    say("reboot");
    TEST_ASSERT_EQUAL_INT(LAB_DONE, reflux_lab_step(2));
    TEST_ASSERT_EQUAL_UINT32(4, reflux_lab_number());
}

static void wrong_options_are_refused_with_what_would_be_right(void)
{
    static const char *const wrong[] = {"--plant", "nowhere"};
    TEST_ASSERT_EQUAL_INT(LAB_REFUSED, reflux_lab_open(4, pilot)); /* one is open */
    reflux_lab_close();
    TEST_ASSERT_EQUAL_INT(LAB_REFUSED, reflux_lab_open(2, wrong));
    TEST_ASSERT_NOT_NULL(strstr(reflux_lab_error(), "nowhere"));
    TEST_ASSERT_EQUAL_INT(LAB_REFUSED, reflux_lab_open(0, NULL));
    TEST_ASSERT_NOT_NULL(strstr(reflux_lab_error(), "--plant"));
}

static void a_closed_lab_does_nothing_and_says_so(void)
{
    reflux_lab_close();
    TEST_ASSERT_EQUAL_INT(LAB_FAILED, reflux_lab_step(1));
    TEST_ASSERT_EQUAL_INT(LAB_FAILED, reflux_lab_say("status"));
    TEST_ASSERT_EQUAL_INT(LAB_FAILED, reflux_lab_event("0:F=5"));
    TEST_ASSERT_NOT_NULL(strstr(reflux_lab_error(), "there is no lab"));
    TEST_ASSERT_EQUAL_STRING("", text(LAB_LOG));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(time_goes_on_by_a_tick_with_each_sample);
    RUN_TEST(texts_have_what_came_since_they_were_last_taken);
    RUN_TEST(a_refusal_of_the_board_has_its_words_and_the_lab_goes_on);
    RUN_TEST(a_line_that_is_too_long_is_refused);
    RUN_TEST(a_channel_has_its_value);
    RUN_TEST(channels_are_counted_from_0_to_the_last);
    RUN_TEST(an_event_meets_the_next_sample);
    RUN_TEST(a_wrong_event_is_refused_and_changes_nothing);
    RUN_TEST(more_events_than_there_is_room_for_are_taken_when_later_ones_replace_them);
    RUN_TEST(a_board_that_reboots_goes_on);
    RUN_TEST(wrong_options_are_refused_with_what_would_be_right);
    RUN_TEST(a_closed_lab_does_nothing_and_says_so);
    return UNITY_END();
}

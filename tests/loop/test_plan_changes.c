/* Effects of new settings, and of channels that come and go with them: asked for at the console, over the link. */
#include "board_bench.h"

enum { T1, T10 };

void setUp(void)
{
    running();
}
void tearDown(void) {}

/* The first line of `status` or `alarm` with this in it. */
static const char *line_with(const char *command, const char *text)
{
    ask_ok(command);
    for (unsigned n = 0; n < n_reply; n++)
        if (strstr(reply[n], text))
            return reply[n];
    TEST_FAIL_MESSAGE(text);
    return "";
}

static void is_valid_at(const char *value)
{
    char text[40];
    snprintf(text, sizeof text, "T10 = %s degC good", value);
    TEST_ASSERT_EQUAL_STRING_LEN(text, line_with("status", "T10 = "), strlen(text));
}

/* An hour in which the plant's T10 is not what the settings ask for. */
static void an_hour_without_T10(void)
{
    ask_ok("set meas2.unit K");
    samples(3600);
    ask_ok("set meas2.unit degC");
}

static void a_filter_begins_anew_when_its_measurement_was_not_bound(void)
{
    ask_ok("set meas2.filter 1000");
    samples(5);
    an_hour_without_T10();
    board.values[T10] = 135;
    samples(1);
    is_valid_at("135");
}

/* Between apply and sample a new channel is not bound yet. In a wrong unit it never will be. */
static void channels_just_configured_wait_for_a_sample(void)
{
    ask_ok("begin");
    ask_ok("set loop2.name -");
    ask_ok("set loop2.pv -");
    ask_ok("set loop2.out -");
    ask_ok("set meas2.name -");
    ask_ok("set mv2.name -");
    ask_ok("apply");
    samples(2);
    ask_ok("begin");
    ask_ok("set meas2.name T10");
    ask_ok("set meas2.unit K");
    ask_ok("set mv2.name heat");
    ask_ok("apply");
    const char *waits = "waits for the plant's next sample";
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(line_with("status", "heat = "), waits), board.said);
    TEST_ASSERT_NOT_NULL(strstr(line_with("status", "T10 = "), "K not announced by the plant"));
    ask_ok("set meas2.unit degC");
    TEST_ASSERT_NOT_NULL(strstr(line_with("status", "T10 = "), waits));
    samples(1);
    TEST_ASSERT_NOT_NULL(strstr(line_with("status", "T10 = "), "degC good"));
    TEST_ASSERT_NULL(strstr(line_with("status", "heat = "), "waits"));
}

static void what_is_wrong_with_a_measurement_that_is_no_longer_bound_is_that(void)
{
    board.quality[T10] = QUALITY_BAD;
    samples(3);
    (void)line_with("alarm", "MEASUREMENT_BAD T10 flagged bad");
    ask_ok("set meas2.unit K");
    samples(3);
    (void)line_with("alarm", "MEASUREMENT_BAD T10 not announced by the plant");
}

static void a_filter_begins_anew_when_its_measurement_was_not_in_the_plan(void)
{
    ask_ok("set meas2.filter 1000");
    ask_ok("begin");
    ask_ok("set loop2.name -");
    ask_ok("set meas2.name -");
    ask_ok("apply");
    samples(3600);
    ask_ok("begin");
    ask_ok("set meas2.name T10");
    ask_ok("apply");
    board.values[T10] = 135;
    samples(1);
    is_valid_at("135");
}

static void what_was_not_looked_at_is_neither_frozen_nor_too_fast(void)
{
    ask_ok("set meas2.frozen 60");
    samples(1);
    an_hour_without_T10();
    samples(1);
    is_valid_at("115");
    ask_ok("set meas2.frozen 0");
    ask_ok("set meas2.rate_limit 0.001");
    samples(1);
    an_hour_without_T10();
    board.values[T10] = 135;
    samples(1);
    is_valid_at("135");
}

static void the_reason_of_the_safe_state_outlives_the_settings_it_was_taken_under(void)
{
    ask_ok("begin");
    ask_ok("set meas2.fallback safe");
    ask_ok("set meas2.hold 0");
    ask_ok("apply");
    samples(1);
    ask_ok("mode top auto");
    samples(1);
    board.quality[T10] = QUALITY_BAD;
    samples(1);
    const char *reason = "SAFE_STATE loops in manual, outputs at safe values because of: T10";
    TEST_ASSERT_EQUAL_STRING(reason, line_with("alarm", "SAFE_STATE"));
    ask_ok("set loop1.gain 2");
    samples(1);
    ask_ok("begin"); /* the plan it was taken under is written over */
    ask_ok("set meas2.name nobody");
    TEST_ASSERT_EQUAL_STRING(reason, line_with("alarm", "SAFE_STATE"));
}

/* Everything is typed between two samples. */
static void a_request_meets_the_plan_it_was_asked_under(void)
{
    ask_ok("out bottom 1");
    samples(1);
    board_forget();
    type("mode bottom auto\nbegin\nset loop2.name other\nset loop2.action direct\napply\n");
    TEST_ASSERT_EQUAL(0, times_said("err "));
    samples(1);
    TEST_ASSERT_TRUE(said(" MODE bottom "));
    TEST_ASSERT_EQUAL(2, times_said(" MODE "));
    TEST_ASSERT_TRUE(strstr(line_with("loop", "other"), "other manual") != NULL);
    board_forget();
    type("begin\nset loop2.name third\napply\nmode third auto\n");
    TEST_ASSERT_EQUAL(0, times_said("err "));
    samples(1);
    TEST_ASSERT_TRUE(strstr(line_with("loop", "third"), "third auto") != NULL);
    TEST_ASSERT_EQUAL(0, times_said("REFUSED"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_filter_begins_anew_when_its_measurement_was_not_bound);
    RUN_TEST(channels_just_configured_wait_for_a_sample);
    RUN_TEST(what_is_wrong_with_a_measurement_that_is_no_longer_bound_is_that);
    RUN_TEST(a_filter_begins_anew_when_its_measurement_was_not_in_the_plan);
    RUN_TEST(what_was_not_looked_at_is_neither_frozen_nor_too_fast);
    RUN_TEST(the_reason_of_the_safe_state_outlives_the_settings_it_was_taken_under);
    RUN_TEST(a_request_meets_the_plan_it_was_asked_under);
    return UNITY_END();
}

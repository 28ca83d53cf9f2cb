/* MVs that follow a measured feed (kinds/ratio/ratio.h). Contract: MV = zero + (output - zero) F/at to 2e-6 of a span in both formats,
 * for outputs of up to a span and ratios of up to 5: a step of Q7.24 is 6e-8, and the ratio and the product are rounded once
 * each. */
#include <math.h>
#include <stdalign.h>
#include <stdio.h>
#include <string.h>

#include "base/channel.h"
#include "kinds/ratio/ratio.h"
#include "unity.h"

#define EXACT 2e-6f

static alignas(8) char state[512];
static struct ratio_settings settings;
static struct block_setup setup;
static struct block_fault fault;
static num_t in[2], out[2], feed[1];
static uint8_t quality[1];
static struct block_io io;

void setUp(void)
{
    settings = (struct ratio_settings){.nominal = 80, .lo = 0.2f, .hi = 5, .hold_s = 60};
    memset(&setup, 0, sizeof setup);
    setup.settings = &settings;
    setup.interval_s = 10;
    setup.members = 2;
    setup.present = 3;
    setup.inputs = 1;
    setup.input[0] =
        (struct block_signal){0, 160, false}; /* half its span is the feed it is made for */
    setup.member[0].out_reach = setup.member[1].out_reach = 2;
    quality[0] = QUALITY_GOOD;
    feed[0] = num_from_float(0.5f);
    io = (struct block_io){.members.acting = 3,
                           .members.in = in,
                           .members.out = out,
                           .inputs.value = feed,
                           .inputs.quality = quality};
}

void tearDown(void) {}

static void begin(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, ratio_kind.check(&setup, &fault));
    TEST_ASSERT_TRUE(ratio_kind.bytes(&setup) <= sizeof state);
    TEST_ASSERT_EQUAL(ERR_OK, ratio_kind.configure(state, &setup, false));
    in[0] = in[1] = num_from_float(0.5f);
    ratio_kind.follow(state, &io);
}

static float stepped(unsigned k, float output)
{
    in[0] = in[1] = num_from_float(output);
    ratio_kind.step(state, &io);
    return num_to_float(out[k]);
}

static float shown(const char *name)
{
    float value = NAN;
    const char *found;
    for (size_t i = 0; (found = ratio_kind.describe(state, i, &value)) != NULL; i++)
        if (strcmp(found, name) == 0)
            return value;
    TEST_FAIL_MESSAGE(name);
    return NAN;
}

static void an_mv_is_the_output_times_the_feed_over_its_nominal_value(void)
{
    begin();
    for (int f = 2; f <= 10; f++) {
        float x = (float)f / 10;
        feed[0] = num_from_float(x);
        TEST_ASSERT_FLOAT_WITHIN(EXACT, 0.6f * x / 0.5f, stepped(0, 0.6f));
        TEST_ASSERT_FLOAT_WITHIN(EXACT, 0.6f * x / 0.5f, num_to_float(out[1]));
        TEST_ASSERT_FLOAT_WITHIN(EXACT, x / 0.5f, shown("ratio"));
    }
}

static void it_counts_from_where_nothing_flows(void)
{
    settings.zero = -0.25f; /* a span from 25 to 125 */
    begin();
    feed[0] = num_from_float(0.75f);
    TEST_ASSERT_FLOAT_WITHIN(EXACT, -0.25f + 0.75f * 1.5f, stepped(0, 0.5f));
}

static void a_feed_whose_span_does_not_begin_at_0_is_taken_as_it_is(void)
{
    setup.input[0] = (struct block_signal){40, 120, false};
    begin();
    feed[0] = num_from_float(0.75f); /* 100 */
    TEST_ASSERT_FLOAT_WITHIN(EXACT, 0.5f * 100 / 80, stepped(0, 0.5f));
}

static void the_ratio_stays_within_its_limits(void)
{
    settings.lo = 0.5f;
    settings.hi = 1.5f;
    begin();
    feed[0] = num_zero();
    TEST_ASSERT_FLOAT_WITHIN(EXACT, 0.3f, stepped(0, 0.6f));
    feed[0] = num_one();
    TEST_ASSERT_FLOAT_WITHIN(EXACT, 0.9f, stepped(0, 0.6f));
}

static void when_it_begins_the_next_step_gives_the_mvs_that_are_there(void)
{
    begin();
    for (int f = 2; f <= 10; f++) {
        feed[0] = num_from_float((float)f / 10);
        in[0] = num_from_float(0.31f);
        in[1] = num_from_float(0.93f);
        ratio_kind.follow(state, &io);
        num_t output[2] = {out[0], out[1]};
        in[0] = output[0];
        in[1] = output[1];
        ratio_kind.step(state, &io);
        TEST_ASSERT_FLOAT_WITHIN(EXACT, 0.31f, num_to_float(out[0]));
        TEST_ASSERT_FLOAT_WITHIN(EXACT, 0.93f, num_to_float(out[1]));
    }
}

static void what_was_limited_comes_back_through_the_ratio_and_nothing_comes_to_nothing(void)
{
    begin();
    feed[0] = num_from_float(0.25f);
    (void)stepped(0, 0.5f);
    in[0] = num_from_float(-0.1f);
    in[1] = num_zero();
    ratio_kind.back_calculate(state, &io);
    TEST_ASSERT_FLOAT_WITHIN(EXACT, -0.2f, num_to_float(out[0]));
    TEST_ASSERT_TRUE(num_eq(num_zero(), out[1]));
}

static void a_member_that_does_not_act_is_not_touched(void)
{
    begin();
    io.members.acting = 2;
    out[0] = num_from_float(0.123f);
    feed[0] = num_one();
    in[0] = in[1] = num_from_float(0.25f);
    ratio_kind.step(state, &io);
    TEST_ASSERT_TRUE(num_eq(num_from_float(0.123f), out[0]));
    TEST_ASSERT_FLOAT_WITHIN(EXACT, 0.5f, num_to_float(out[1]));
    ratio_kind.follow(state, &io);
    ratio_kind.back_calculate(state, &io);
    TEST_ASSERT_TRUE(num_eq(num_from_float(0.123f), out[0]));
}

/* Backward Euler: after n steps 1 - (T/(T + h))^n of the way. */
static void the_feed_goes_through_a_lag_and_begins_at_rest(void)
{
    settings.lag_s = 90;
    begin();
    feed[0] = num_one();
    for (int n = 1; n <= 20; n++)
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.5f * (1 + (1 - powf(0.9f, (float)n))), stepped(0, 0.5f));
    ratio_kind.follow(state, &io); /* nobody went on */
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 2.0f, shown("ratio"));
}

static void a_lag_under_way_goes_on_where_a_member_did(void)
{
    settings.lag_s = 90;
    begin();
    feed[0] = num_one();
    (void)stepped(0, 0.5f);
    io.members.going_on = 1;
    in[0] = in[1] = num_from_float(0.6f);
    ratio_kind.follow(state, &io);
    num_t output = out[0];
    in[0] = in[1] = output;
    ratio_kind.step(state, &io);
    TEST_ASSERT_FLOAT_WITHIN(EXACT, 0.6f, num_to_float(out[0]));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1 + (1 - 0.81f), shown("ratio"));
}

static void without_a_feed_the_last_ratio_is_kept_for_a_while_and_then_it_gives_up(void)
{
    begin();
    feed[0] = num_one();
    (void)stepped(0, 0.25f);
    quality[0] = QUALITY_BAD;
    feed[0] = num_zero();
    for (int n = 0; n < 6; n++) { /* 60 s */
        TEST_ASSERT_FLOAT_WITHIN(EXACT, 0.5f, stepped(0, 0.25f));
        TEST_ASSERT_NULL(io.requests.gives_up);
    }
    (void)stepped(0, 0.25f);
    TEST_ASSERT_EQUAL_STRING("no_feed", io.requests.gives_up);
}

static void a_feed_that_comes_back_in_time_counts_anew(void)
{
    begin();
    for (int n = 0; n < 30; n++) {
        quality[0] = n % 5 == 0 ? QUALITY_UNCERTAIN : QUALITY_BAD;
        (void)stepped(0, 0.25f);
        TEST_ASSERT_NULL(io.requests.gives_up);
    }
}

static void without_a_feed_from_the_beginning_it_gives_up_at_once(void)
{
    quality[0] = QUALITY_MISSING;
    begin();
    (void)stepped(0, 0.25f);
    TEST_ASSERT_EQUAL_STRING("no_feed", io.requests.gives_up);
}

static void other_settings_are_taken_while_it_runs(void)
{
    begin();
    feed[0] = num_one();
    (void)stepped(0, 0.25f);
    settings.nominal = 160;
    TEST_ASSERT_EQUAL(ERR_OK, ratio_kind.configure(state, &setup, true));
    TEST_ASSERT_FLOAT_WITHIN(EXACT, 0.25f, stepped(0, 0.25f));
}

static void refused(const char *field, const char *words)
{
    TEST_ASSERT_NOT_EQUAL_MESSAGE(ERR_OK, ratio_kind.check(&setup, &fault), words);
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(fault.wanted, words), fault.wanted);
    setUp();
}

static void what_cannot_be_right_is_refused_in_words(void)
{
    settings.nominal = 0;
    refused("at", "above 0");
    settings.nominal = 1; /* of a span of 160 */
    refused("at", "hundredth");
    setup.inputs = 0;
    refused("inputs", "the feed");
    setup.inputs = 2;
    refused("inputs", "nothing else");
    setup.members = 0;
    refused("loops", "one or two");
    settings.lo = 0.05f;
    setup.member[1].out_reach = 20;
    refused("lo", "too small");
    TEST_ASSERT_EQUAL(ERR_OK, ratio_kind.check(&setup, &fault));
}

/* What check() lets through stays within the format: MVs of up to out_reach at the least and at the largest ratio. */
static void at_the_ends_of_every_range_it_stays_a_number(void)
{
    const float lo[] = {0.05f, 0.2f, 1}, zero[] = {-2, 0, 1}, at[] = {1.5f, 80, 1e6f};
    unsigned ran = 0;
    for (unsigned k = 0; k < 27; k++) {
        setUp();
        settings.lo = lo[k % 3];
        settings.hi = 20;
        settings.zero = zero[k / 3 % 3];
        settings.nominal = at[k / 9];
        if (ratio_kind.check(&setup, &fault) != ERR_OK)
            continue;
        ran++;
        begin();
        for (unsigned f = 0; f <= 4; f++) {
            feed[0] = num_from_float((float)f / 4);
            in[0] = num_from_float(2);
            in[1] = num_from_float(-2);
            ratio_kind.follow(state, &io);
            in[0] = out[0];
            in[1] = out[1];
            ratio_kind.step(state, &io);
            TEST_ASSERT_FLOAT_WITHIN(2e-5f, 2, num_to_float(out[0]));
            TEST_ASSERT_FLOAT_WITHIN(2e-5f, -2, num_to_float(out[1]));
        }
    }
    TEST_ASSERT_TRUE(ran >= 20);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_mv_is_the_output_times_the_feed_over_its_nominal_value);
    RUN_TEST(it_counts_from_where_nothing_flows);
    RUN_TEST(a_feed_whose_span_does_not_begin_at_0_is_taken_as_it_is);
    RUN_TEST(the_ratio_stays_within_its_limits);
    RUN_TEST(when_it_begins_the_next_step_gives_the_mvs_that_are_there);
    RUN_TEST(what_was_limited_comes_back_through_the_ratio_and_nothing_comes_to_nothing);
    RUN_TEST(a_member_that_does_not_act_is_not_touched);
    RUN_TEST(the_feed_goes_through_a_lag_and_begins_at_rest);
    RUN_TEST(a_lag_under_way_goes_on_where_a_member_did);
    RUN_TEST(without_a_feed_the_last_ratio_is_kept_for_a_while_and_then_it_gives_up);
    RUN_TEST(a_feed_that_comes_back_in_time_counts_anew);
    RUN_TEST(without_a_feed_from_the_beginning_it_gives_up_at_once);
    RUN_TEST(other_settings_are_taken_while_it_runs);
    RUN_TEST(what_cannot_be_right_is_refused_in_words);
    RUN_TEST(at_the_ends_of_every_range_it_stays_a_number);
    return UNITY_END();
}

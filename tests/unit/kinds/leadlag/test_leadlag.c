/* Feedforward from several disturbances to several MVs (kinds/leadlag/leadlag.h). Contract: each term is an element ffN of the same numbers, to the
 * bit; against the backward-difference form in double (digest of Siddha 2.10: u = (lag u' + K (lead + h) d - K lead d')/(lag + h)) within 2e-5 of
 * span over 400 steps of noise, in both number formats. */
#include <math.h>
#include <stdalign.h>
#include <string.h>

#include "base/channel.h"
#include "block/feedforward.h"
#include "formats.h"
#include "kinds/leadlag/leadlag.h"
#include "unity.h"

static const struct block_kind *const kind = &leadlag_kind;
static alignas(8) char state[8192];
static struct leadlag_settings settings;
static struct block_setup setup;
static struct block_fault fault;
static num_t input[LEADLAG_INPUTS], out[LEADLAG_MVS];
static uint8_t quality[LEADLAG_INPUTS];
static float event_value[BLOCK_EVENTS_MAX];
static struct block_io io;
static unsigned long long seed;

static double drawn(void)
{
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return (double)(long long)(seed >> 11) / 4503599627370496.0 - 1.0;
}

static void term(unsigned k, unsigned from, unsigned to, float gain, float lead, float lag,
                 float dead)
{
    settings.from[k] = (uint16_t)from;
    settings.to[k] = (uint16_t)to;
    settings.gain[k] = gain;
    settings.lead_s[k] = lead;
    settings.lag_s[k] = lag;
    settings.dead_s[k] = dead;
    settings.reference[k] = 50;
}

void setUp(void)
{
    memset(&settings, 0, sizeof settings);
    memset(&setup, 0, sizeof setup);
    for (unsigned p = 0; p < LEADLAG_MVS; p++) {
        settings.lo[p] = -1;
        settings.hi[p] = 1;
    }
    settings.kick = 100;
    setup.settings = &settings;
    setup.interval_s = 10;
    setup.inputs = 2;
    setup.points = 2;
    for (unsigned k = 0; k < LEADLAG_INPUTS; k++) {
        setup.input[k] = (struct block_signal){0, 100, false};
        input[k] = N(0.5);
        quality[k] = QUALITY_GOOD;
    }
    io = (struct block_io){.members.in = input,
                           .inputs.value = input,
                           .inputs.quality = quality,
                           .members.out = out,
                           .points.value = out,
                           .requests.event_value = event_value};
    seed = 1903;
}

void tearDown(void) {}

static void configure(bool retune)
{
    enum err err = kind->check(&setup, &fault);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, err, fault.wanted);
    TEST_ASSERT_TRUE(kind->bytes(&setup) <= sizeof state);
    TEST_ASSERT_EQUAL(ERR_OK, kind->configure(state, &setup, retune));
}

static void begin(void)
{
    configure(false);
    kind->follow(state, &io);
}

static void step(void)
{
    io.requests.raised = 0;
    io.requests.gives_up = NULL;
    kind->step(state, &io);
}

/* ---- what it computes ---- */

static void a_term_is_an_element_of_the_same_numbers_to_the_bit(void)
{
    static num_t ring[64];
    struct feedforward element;
    const struct feedforward_settings same = {.gain = -1.3f,
                                              .lead_s = 60,
                                              .lag_s = 25,
                                              .dead_time_s = 37,
                                              .reference = 0.5f,
                                              .out_lo = -1,
                                              .out_hi = 1};
    term(0, 1, 1, -1.3f, 60, 25, 37);
    begin();
    TEST_ASSERT_EQUAL(ERR_OK, feedforward_init(&element, &same, 10, ring, sizeof ring));
    feedforward_reset(&element, input[0]);
    step();
    (void)feedforward_step(&element, input[0]);
    for (unsigned k = 0; k < 200; k++) {
        input[0] = N(0.5 + 0.1 * drawn());
        step();
        num_t wanted = feedforward_step(&element, input[0]);
        TEST_ASSERT_EQUAL_MEMORY(&wanted, &out[0], sizeof wanted);
    }
}

static void noise_within_the_dead_band_moves_nothing(void)
{
    term(0, 1, 1, -1, 60, 0, 0);
    settings.dead_band[0] = 2; /* a fiftieth of the span */
    begin();
    step();
    for (unsigned k = 0; k < 200; k++) {
        input[0] = N(0.5 + 0.0199 * drawn());
        step();
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0, D(out[0]));
    }
}

static void beyond_the_dead_band_the_term_follows_at_its_distance(void)
{
    static const double d[][2] = {{0.6, 0.58},  {0.57, 0.58}, {0.56, 0.58},
                                  {0.55, 0.57}, {0.3, 0.32},  {0.33, 0.32}};
    term(0, 1, 1, 1, 0, 0, 0);
    settings.dead_band[0] = 2;
    begin();
    step();
    for (unsigned k = 0; k < sizeof d / sizeof d[0]; k++) {
        input[0] = N(d[k][0]);
        step();
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, d[k][1] - 0.5, D(out[0]));
    }
}

static void each_term_of_an_input_has_its_own_dead_band(void)
{
    term(0, 1, 1, 1, 0, 0, 0);
    term(1, 1, 2, 1, 0, 0, 0);
    settings.dead_band[1] = 5;
    begin();
    step();
    input[0] = N(0.6);
    step();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, D(out[0]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.05, D(out[1]));
    settings.dead_band[1] = 1; /* another one counts from the next step on */
    configure(true);
    step();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.09, D(out[1]));
}

static void a_dead_band_beyond_the_span_is_refused(void)
{
    term(0, 1, 1, 1, 0, 0, 0);
    settings.dead_band[0] = 101;
    TEST_ASSERT_NOT_EQUAL(ERR_OK, kind->check(&setup, &fault));
    TEST_ASSERT_EQUAL_STRING("dead_band", fault.field);
}

static void terms_add_up_at_their_mvs_as_in_double(void)
{
    static const struct {
        unsigned from, to;
        double gain, lead, lag;
    } terms[] = {
        {1, 1, 0.8, 40, 90}, {2, 1, -0.5, 0, 30}, {2, 2, 1.1, 120, 50}, {1, 2, -0.3, 70, 70}};
    double u[4] = {0}, before[2] = {0, 0};
    for (unsigned k = 0; k < 4; k++)
        term(k, terms[k].from, terms[k].to, (float)terms[k].gain, (float)terms[k].lead,
             (float)terms[k].lag, 0);
    begin();
    step();
    for (unsigned n = 0; n < 400; n++) {
        double d[2], sum[2] = {0, 0};
        for (unsigned k = 0; k < 2; k++) {
            input[k] = N(0.5 + 0.1 * drawn());
            d[k] = D(input[k]) - 0.5;
        }
        step();
        for (unsigned k = 0; k < 4; k++) {
            double now = d[terms[k].from - 1], last = before[terms[k].from - 1];
            u[k] = (terms[k].lag * u[k] + terms[k].gain * (terms[k].lead + 10) * now -
                    terms[k].gain * terms[k].lead * last) /
                   (terms[k].lag + 10);
            sum[terms[k].to - 1] += u[k];
        }
        TEST_ASSERT_DOUBLE_WITHIN(2e-5, sum[0], D(out[0]));
        TEST_ASSERT_DOUBLE_WITHIN(2e-5, sum[1], D(out[1]));
        memcpy(before, d, sizeof before);
    }
}

static void a_dead_time_is_exact(void)
{
    term(0, 1, 1, 1, 0, 0, 70);
    begin();
    for (unsigned k = 0; k < 20; k++) {
        if (k == 5)
            input[0] = N(0.6);
        step();
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, k < 12 ? 0 : 0.1, D(out[0]));
    }
}

static void what_stays_is_washed_out(void)
{
    term(0, 1, 1, 1, 0, 0, 0);
    settings.washout_s = 100;
    begin();
    step();
    input[0] = N(0.6);
    step();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.1 * 100 / 110, D(out[0]));
    for (unsigned k = 0; k < 100; k++)
        step();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, D(out[0]));
}

/* ---- limits ---- */

static void the_sum_stays_within_its_limits_and_tells(void)
{
    term(0, 1, 1, 1, 0, 0, 0);
    term(1, 2, 1, 1, 0, 0, 0);
    settings.hi[0] = 0.1f;
    begin();
    step();
    TEST_ASSERT_EQUAL(0, io.requests.raised);
    input[0] = input[1] = N(0.58);
    step();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, D(out[0]));
    TEST_ASSERT_EQUAL(2, io.requests.raised);
    TEST_ASSERT_EQUAL_FLOAT(1, event_value[1]);
    input[0] = N(0.5);
    step();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.08, D(out[0]));
}

static void it_moves_no_faster_than_its_rate(void)
{
    term(0, 1, 2, 1, 0, 0, 0);
    settings.rate[1] = 0.002f;
    begin();
    step();
    input[0] = N(0.6);
    for (unsigned k = 1; k <= 8; k++) {
        step();
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, fmin(0.02 * k, 0.1), D(out[1]));
    }
}

static void a_term_that_is_switched_off_adds_nothing_at_once_whatever_the_rate(void)
{
    term(2, 1, 2, 1, 0, 0, 0); /* number 3 is the first, number 6 the second */
    term(5, 2, 2, 0.5f, 0, 0, 0);
    input[0] = N(0.6);
    input[1] = N(0.7);
    begin();
    step();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.2, D(out[1]));
    settings.rate[1] = 0.002f;
    configure(true);
    io.requests.silenced = 1u << 2;
    step();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, D(out[1]));
    io.requests.silenced |= 1u << 5;
    step();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, D(out[1]));
    io.requests.silenced = 0;
    step();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.2, D(out[1]));
}

static void a_lead_beyond_the_kick_is_refused(void)
{
    settings.kick = 4;
    term(0, 1, 1, 1, 100, 14, 0);
    TEST_ASSERT_EQUAL(ERR_RANGE, kind->check(&setup, &fault));
    TEST_ASSERT_EQUAL_STRING("lead", fault.field);
    term(0, 1, 1, 1, 100, 16, 0);
    TEST_ASSERT_EQUAL(ERR_OK, kind->check(&setup, &fault));
}

/* ---- beginnings ---- */

static void it_begins_at_rest_at_its_inputs(void)
{
    term(0, 1, 1, 2, 300, 20, 50);
    input[0] = N(0.7);
    begin();
    for (unsigned k = 0; k < 10; k++) {
        step();
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, D(out[0]));
    }
}

static void another_gain_keeps_what_is_under_way(void)
{
    term(0, 1, 1, 1, 0, 200, 30);
    begin();
    step();
    input[0] = N(0.6);
    for (unsigned k = 0; k < 10; k++)
        step();
    double before = D(out[0]);
    TEST_ASSERT_TRUE(before > 0.01 && before < 0.06);
    settings.gain[0] = 2;
    configure(true);
    step();
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 2 * before, D(out[0])); /* and goes on towards 0.2 */
    settings.dead_s[0] = 35; /* as many samples, another line: it begins at rest */
    configure(true);
    step();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.2, D(out[0]));
}

static void another_gain_of_a_term_with_a_lead_does_not_kick(void)
{
    term(0, 1, 1, 1, 200, 20, 0);
    input[0] = N(0.7);
    begin();
    step();
    settings.gain[0] = 1.5f;
    configure(true);
    for (unsigned k = 0; k < 5; k++) {
        step();
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.3, D(out[0]));
    }
}

static void a_term_from_another_input_looks_at_that(void)
{
    term(0, 1, 1, 1, 0, 20, 0);
    input[1] = N(0.8);
    begin();
    step();
    settings.from[0] = 2;
    configure(true);
    step();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.3, D(out[0]));
}

static void another_reference_counts(void)
{
    term(0, 1, 1, 1, 0, 20, 0);
    begin();
    step();
    settings.reference[0] = 40;
    configure(true);
    step();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.1, D(out[0]));
}

static void with_a_washout_it_begins_at_nothing(void)
{
    term(0, 1, 1, 1, 0, 20, 0);
    settings.washout_s = 600;
    input[0] = N(0.8);
    begin();
    for (unsigned k = 0; k < 5; k++) {
        step();
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, D(out[0]));
    }
}

static void it_may_be_moved_to_another_place(void)
{
    static alignas(8) char elsewhere[sizeof state];
    term(0, 1, 1, 1, 0, 20, 55);
    begin();
    double wanted[30];
    for (unsigned pass = 0; pass < 2; pass++) {
        begin();
        input[0] = N(0.5);
        step();
        input[0] = N(0.6);
        char *at = state;
        for (unsigned k = 0; k < 30; k++) {
            if (pass && k == 4) {
                memcpy(elsewhere, state, sizeof state);
                memset(state, 0x55, sizeof state);
                at = elsewhere;
            }
            io.requests.gives_up = NULL;
            kind->step(at, &io);
            if (pass)
                TEST_ASSERT_TRUE(D(out[0]) >= wanted[k] && D(out[0]) <= wanted[k]);
            wanted[k] = D(out[0]);
        }
    }
}

/* ---- inputs that are lost ---- */

static void a_lost_input_stays_what_it_was_for_a_while(void)
{
    term(0, 1, 1, 1, 0, 0, 0);
    settings.hold_s = 30;
    begin();
    step();
    input[0] = N(0.6);
    step();
    quality[0] = QUALITY_BAD;
    input[0] = N(0.9);
    for (unsigned k = 0; k < 3; k++) {
        step();
        TEST_ASSERT_NULL(io.requests.gives_up);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, D(out[0]));
        TEST_ASSERT_EQUAL(1, io.requests.raised);
        TEST_ASSERT_EQUAL_FLOAT(1, event_value[0]);
    }
    step();
    TEST_ASSERT_EQUAL_STRING("input", io.requests.gives_up);
}

static void an_input_that_comes_back_in_time_counts_again(void)
{
    term(0, 1, 1, 1, 0, 0, 0);
    settings.hold_s = 30;
    begin();
    step();
    for (unsigned k = 0; k < 20; k++) {
        quality[0] = k % 3 == 2 ? QUALITY_GOOD : QUALITY_BAD;
        input[0] = N(0.55);
        step();
        TEST_ASSERT_NULL(io.requests.gives_up);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.05, D(out[0]));
}

static void it_does_not_begin_without_its_inputs(void)
{
    term(0, 1, 1, 1, 0, 0, 0);
    settings.hold_s = 1000;
    quality[0] = QUALITY_BAD;
    begin();
    step();
    TEST_ASSERT_EQUAL_STRING("input", io.requests.gives_up);
}

/* ---- settings ---- */

static void refused(const char *field)
{
    TEST_ASSERT_EQUAL_MESSAGE(ERR_RANGE, kind->check(&setup, &fault), field);
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_TRUE(strlen(fault.wanted) > 10);
    setUp();
    term(0, 1, 1, 1, 0, 0, 0);
    TEST_ASSERT_EQUAL(ERR_OK, kind->check(&setup, &fault));
}

static void settings_that_make_no_sense_are_refused(void)
{
    refused("from"); /* no term */
    settings.from[0] = 3;
    refused("from");
    settings.to[0] = 3;
    refused("to");
    settings.to[0] = 0;
    refused("to");
    settings.reference[0] = 400;
    refused("reference");
    settings.reference[0] = NAN;
    refused("reference");
    settings.dead_s[0] = 2e6f;
    refused("dead");
    settings.hi[1] = -0.1f;
    refused("hi");
    settings.lo[0] = 0.1f;
    refused("hi");
    setup.inputs = 0;
    refused("inputs");
    setup.points = 0;
    refused("points");
}

static void values_are_shown(void)
{
    float value;
    term(0, 1, 1, 1, 0, 0, 0);
    begin();
    input[0] = N(0.5);
    step();
    input[0] = N(0.7);
    step();
    TEST_ASSERT_EQUAL_STRING("added_1", kind->describe(state, 0, &value));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.2f, value);
    TEST_ASSERT_EQUAL_STRING("added_2", kind->describe(state, 1, &value));
    TEST_ASSERT_EQUAL_STRING("term_1", kind->describe(state, 2, &value));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.2f, value);
    TEST_ASSERT_NULL(kind->describe(state, 3, &value));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_term_is_an_element_of_the_same_numbers_to_the_bit);
    RUN_TEST(noise_within_the_dead_band_moves_nothing);
    RUN_TEST(beyond_the_dead_band_the_term_follows_at_its_distance);
    RUN_TEST(each_term_of_an_input_has_its_own_dead_band);
    RUN_TEST(a_dead_band_beyond_the_span_is_refused);
    RUN_TEST(terms_add_up_at_their_mvs_as_in_double);
    RUN_TEST(a_dead_time_is_exact);
    RUN_TEST(what_stays_is_washed_out);
    RUN_TEST(the_sum_stays_within_its_limits_and_tells);
    RUN_TEST(it_moves_no_faster_than_its_rate);
    RUN_TEST(a_term_that_is_switched_off_adds_nothing_at_once_whatever_the_rate);
    RUN_TEST(a_lead_beyond_the_kick_is_refused);
    RUN_TEST(it_begins_at_rest_at_its_inputs);
    RUN_TEST(another_gain_keeps_what_is_under_way);
    RUN_TEST(another_gain_of_a_term_with_a_lead_does_not_kick);
    RUN_TEST(a_term_from_another_input_looks_at_that);
    RUN_TEST(another_reference_counts);
    RUN_TEST(with_a_washout_it_begins_at_nothing);
    RUN_TEST(it_may_be_moved_to_another_place);
    RUN_TEST(a_lost_input_stays_what_it_was_for_a_while);
    RUN_TEST(an_input_that_comes_back_in_time_counts_again);
    RUN_TEST(it_does_not_begin_without_its_inputs);
    RUN_TEST(settings_that_make_no_sense_are_refused);
    RUN_TEST(values_are_shown);
    return UNITY_END();
}

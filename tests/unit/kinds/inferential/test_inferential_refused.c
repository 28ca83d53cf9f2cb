/* Kind `inferential`: what it is configured with. Every parameter and inner value of docs/methods/inferential.md, what settings come to, and
 * what is refused, in words. */
#include "inferential_bench.h"

static struct infer_bench b;

void setUp(void)
{
    bench_plain(&b, LAW_CLF, FORM_EULER, 30);
}
void tearDown(void) {}

static void refused(unsigned member, const char *field, const char *words)
{
    struct block_fault fault;
    TEST_ASSERT_NOT_EQUAL_MESSAGE(ERR_OK, bench_check(&b, &fault), field);
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_EQUAL_MESSAGE(member, fault.member, field);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(fault.wanted, words), fault.wanted);
}

static void accepted(void)
{
    struct block_fault fault;
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, bench_check(&b, &fault), fault.wanted);
}

static double come_to(const char *name)
{
    bench_configure(&b, false);
    return bench_value(&b, name);
}

/* ---- the page's tables ---- */

static void the_parameters_are_those_of_the_page(void)
{
    static const struct {
        const char *name;
        unsigned rows, cols;
        float lo, hi, initial;
        const char *words;
    } page[] = {
        {"law", 2, 1, 0, 0, 1, "hold|conventional|cascade|clf"},
        {"form", 1, 1, 0, 0, 0, "euler|joint"},
        {"second", 2, 1, 0, 2, 0, NULL},
        {"a", 2, 2, -1e6f, 1e6f, 0, NULL},
        {"moves", 2, 1, 0, 0, 0, "none|reflux|heat"},
        {"gradient", 2, 2, -1000, 1000, 0, NULL},
        {"holdup", 2, 2, 0, 1e6f, 0, NULL},
        {"lv", 2, 2, 0.01f, 100, 1, NULL},
        {"flow", 2, 1, 0, 1e6f, 0, NULL},
        {"scaling", 1, 1, 0, 0, 0, "consistent|printed"},
        {"parts", 1, 1, 2, 10, 2, NULL},
        {"stage", 2, 2, 0, 200, 0, NULL},
        {"w", 2, 1, 0, 1e5f, 0, NULL},
        {"kc_w", 1, 1, 0.1f, 10, 2, NULL},
        {"kc2_kc", 1, 1, 0.1f, 10, 2, NULL},
        {"ko_kc", 1, 1, 0.1f, 100, 10, NULL},
        {"wh", 2, 1, 0, 1e6f, 0, NULL},
        {"kc", 2, 1, 0, 1e5f, 0, NULL},
        {"kc2", 2, 1, 0, 1e5f, 0, NULL},
        {"ko", 2, 1, 0, 1e5f, 0, NULL},
    };
    TEST_ASSERT_EQUAL(sizeof page / sizeof page[0], inferential_kind.parameters);
    for (unsigned i = 0; i < inferential_kind.parameters; i++) {
        const struct block_parameter *p = &inferential_kind.parameter[i];
        TEST_ASSERT_EQUAL_STRING(page[i].name, p->name);
        TEST_ASSERT_EQUAL_MESSAGE(i + 1, p->id,
                                  p->name); /* stored configurations know it by that */
        TEST_ASSERT_EQUAL_MESSAGE(page[i].rows, p->rows, p->name);
        TEST_ASSERT_EQUAL_MESSAGE(page[i].cols, p->cols, p->name);
        TEST_ASSERT_EQUAL_FLOAT(page[i].initial, p->initial);
        if (page[i].words) {
            TEST_ASSERT_EQUAL_STRING(page[i].words, p->unit);
            continue;
        }
        TEST_ASSERT_EQUAL_FLOAT(page[i].lo, p->lo);
        TEST_ASSERT_EQUAL_FLOAT(page[i].hi, p->hi);
    }
}

static void it_serves_two_loops_with_a_secondary_each(void)
{
    TEST_ASSERT_EQUAL(2, inferential_kind.members_most);
    TEST_ASSERT_EQUAL(4, inferential_kind.inputs_most);
    TEST_ASSERT_EQUAL(STAGE_CONTROL, inferential_kind.stage);
    TEST_ASSERT_EQUAL(BAD_INPUT_IS_TOLD, inferential_kind.bad_input);
    TEST_ASSERT_EQUAL(sizeof(struct inferential_settings), inferential_kind.settings_bytes);
    TEST_ASSERT_EQUAL(0, inferential_kind.bytes(&b.setup) % 8);
    TEST_ASSERT_GREATER_THAN(
        0, inferential_kind.history(&b.setup)); /* by it an MV is known from another */
}

static void the_inner_values_are_those_of_the_page(void)
{
    static const char *const names[] = {"law", "y1", "y2", "b1",  "b2", "prim", "sec", "sat",
                                        "a1",  "a2", "kc", "kc2", "ko", "freq", "damp"};
    bench_wire(&b, 2, 2, 30);
    bench_plain_loop(&b, 0, LAW_CLF, 1, 2);
    bench_plain_loop(&b, 1, LAW_CLF, 1, 2);
    bench_begin(&b);
    enum { N = sizeof names / sizeof names[0] };
    for (unsigned k = 0; k < 2; k++)
        for (unsigned i = 0; i < N; i++)
            TEST_ASSERT_FALSE(isnan(bench_loop_value(&b, names[i], k)));
    float value;
    TEST_ASSERT_NOT_NULL(inferential_kind.describe(b.state, 2 * N - 1, &value));
    TEST_ASSERT_NULL(inferential_kind.describe(b.state, 2 * N, &value));
}

/* ---- what settings come to ---- */

static void no_gains(void)
{
    b.settings.kc[0] = b.settings.kc2[0] = b.settings.ko[0] = 0;
}

static void from_one_number_come_all_gains(void)
{
    no_gains();
    b.settings.w[0] = 1.5f;
    TEST_ASSERT_EQUAL_FLOAT(3, come_to("kc_1"));
    TEST_ASSERT_EQUAL_FLOAT(6, come_to("kc2_1"));
    TEST_ASSERT_EQUAL_FLOAT(30, come_to("ko_1"));
    b.settings.kc_w = 1;
    b.settings.kc2_kc = 1.5f;
    b.settings.ko_kc = 5;
    TEST_ASSERT_EQUAL_FLOAT(1.5f, come_to("kc_1"));
    TEST_ASSERT_EQUAL_FLOAT(2.25f, come_to("kc2_1"));
    TEST_ASSERT_EQUAL_FLOAT(7.5f, come_to("ko_1"));
}

static void the_rules_observer_stays_a_third_of_the_holdups(void)
{
    no_gains();
    b.settings.w[0] = 1;
    b.settings.wh[0] = 45;
    TEST_ASSERT_EQUAL_FLOAT(15, come_to("ko_1"));
    b.settings.wh[0] = 0; /* 100 w */
    b.settings.ko_kc = 50;
    TEST_ASSERT_EQUAL_FLOAT(100.0f / 3, come_to("ko_1"));
}

static void given_gains_go_before_the_rule(void)
{
    b.settings.w[0] = 1;
    b.settings.kc[0] = 0.5f;
    b.settings.kc2[0] = 7;
    b.settings.ko[0] = 11;
    TEST_ASSERT_EQUAL_FLOAT(0.5f, come_to("kc_1"));
    TEST_ASSERT_EQUAL_FLOAT(7, come_to("kc2_1"));
    TEST_ASSERT_EQUAL_FLOAT(11, come_to("ko_1"));
    b.settings.kc2[0] = b.settings.ko[0] = 0;
    TEST_ASSERT_EQUAL_FLOAT(1, come_to("kc2_1"));
    TEST_ASSERT_EQUAL_FLOAT(5, come_to("ko_1"));
}

static void slopes_from_gradient(enum inferential_moves moves)
{
    struct inferential_settings *c = &b.settings;
    c->a[0][0] = c->a[0][1] = 0;
    c->moves[0] = (uint8_t)moves;
    c->gradient[0][0] = -3;
    c->gradient[0][1] = -2;
    c->holdup[0][0] = 2;
    c->holdup[0][1] = 2.5f;
    c->lv[0][0] = 0.75f;
    c->lv[0][1] = 1.5f;
    c->flow[0] = 0.5f;
    c->parts = 6;
}

/* Page, "Slope". */
static void slopes_come_from_the_gradient(void)
{
    slopes_from_gradient(MOVES_REFLUX);
    TEST_ASSERT_EQUAL_FLOAT(-0.75f, come_to("a1_1"));
    TEST_ASSERT_EQUAL_FLOAT(-0.4f, come_to("a2_1"));
    slopes_from_gradient(MOVES_HEAT);
    TEST_ASSERT_EQUAL_FLOAT(0.5625f, come_to("a1_1"));
    TEST_ASSERT_EQUAL_FLOAT(0.6f, come_to("a2_1"));
    b.settings.scaling = SCALING_PRINTED;
    TEST_ASSERT_EQUAL_FLOAT(6 * 0.5625f, come_to("a1_1"));
    TEST_ASSERT_EQUAL_FLOAT(6 * 0.6f, come_to("a2_1"));
}

static void a_given_slope_goes_before_the_gradient(void)
{
    slopes_from_gradient(MOVES_REFLUX);
    b.settings.a[0][1] = -1.5f;
    b.settings.scaling = SCALING_PRINTED;
    TEST_ASSERT_EQUAL_FLOAT(-4.5f, come_to("a1_1"));
    TEST_ASSERT_EQUAL_FLOAT(-1.5f, come_to("a2_1"));
}

/* ---- refused ---- */

static void euler_is_refused_where_its_steps_are_too_long_and_the_joint_form_named(void)
{
    b.settings.wh[0] = 1e4f;
    b.settings.kc[0] = 20;
    b.settings.ko[0] = 101; /* 30 s of 121 1/h: 1.008 */
    refused(0, "kc", "joint");
    b.settings.ko[0] = 99;
    accepted();
    b.settings.kc2[0] = 22;
    refused(0, "kc2", "joint");
    b.settings.law[0] = LAW_CONVENTIONAL; /* has no kc2 */
    accepted();
    b.settings.law[0] = LAW_CLF;
    b.settings.form = FORM_JOINT;
    accepted();
    b.setup.interval_s = 1800;
    accepted();
}

/* 30 s of 2 + 4 (1 + r^2) 1/h. */
static void clf_is_refused_in_euler_steps_where_the_secondary_answers_too_little(void)
{
    b.settings.a[0][1] = 0.188f; /* 0.993 */
    accepted();
    b.settings.a[0][1] = 0.187f; /* 1.003 */
    refused(0, "kc2", "joint");
    b.settings.law[0] = LAW_CASCADE;
    accepted();
    b.settings.law[0] = LAW_CLF;
    b.settings.form = FORM_JOINT;
    accepted();
}

static void a_given_observer_above_a_third_of_the_holdups_is_refused(void)
{
    b.settings.wh[0] = 45;
    b.settings.ko[0] = 15.1f;
    refused(0, "ko", "third");
    b.settings.ko[0] = 15;
    accepted();
    b.settings.wh[0] = 0;
    b.settings.w[0] = 0.25f;
    b.settings.ko[0] = 8.4f;
    refused(0, "ko", "third");
}

static void neither_w_nor_gains_are_refused(void)
{
    no_gains();
    refused(0, "w", "above 0");
    b.settings.law[0] = LAW_HOLD;
    accepted();
}

static void two_temperatures_need_a_secondary(void)
{
    for (unsigned law = LAW_CASCADE; law <= LAW_CLF; law++) {
        bench_plain(&b, (enum inferential_law)law, FORM_EULER, 30);
        bench_wire(&b, 1, 0, 30);
        bench_plain_loop(&b, 0, (enum inferential_law)law, 1, 2);
        refused(0, "inputs", "secondary");
    }
    setUp();
    b.settings.second[0] = 2;
    refused(0, "inputs", "secondary");
    b.settings.second[0] = 1;
    accepted();
}

static void the_mvs_have_to_stand_last(void)
{
    b.setup.inputs = 0;
    refused(0, "inputs", "MV");
    setUp();
    b.setup.input[1].is_mv = false;
    refused(0, "inputs", "MV");
    setUp();
    b.setup.input[0].is_mv = true;
    refused(0, "inputs", "temperature");
    setUp();
    b.setup.member[0].drives_mv = false; /* it drives a loop: its PV then */
    refused(0, "inputs", "PV");
    b.setup.input[1].is_mv = false;
    accepted();
}

static void more_temperatures_than_two_are_refused(void)
{
    bench_wire(&b, 1, 3, 30);
    b.setup.input[1].is_mv = b.setup.input[2].is_mv = false;
    bench_plain_loop(&b, 0, LAW_CLF, 1, 2);
    refused(0, "inputs", "two");
    setUp();
    b.setup.members = 0;
    refused(0, "loops", "one or two");
}

static void slopes_a_thousand_times_apart_are_refused(void)
{
    b.settings.a[0][1] = 999;
    accepted();
    b.settings.a[0][1] = 1001;
    refused(0, "a", "1000");
    b.settings.a[0][0] = 1000;
    b.settings.a[0][1] = 1001;
    accepted();
    b.settings.a[0][1] = 0.99f;
    refused(0, "a", "1000");
    setUp();
    b.settings.a[0][1] = -2;
    refused(0, "a", "same sign");
}

static void the_same_stage_twice_is_refused(void)
{
    b.settings.stage[0][0] = b.settings.stage[0][1] = 33;
    refused(0, "stage", "different");
    b.settings.stage[0][1] = 34;
    accepted();
    bench_wire(&b, 2, 2, 30);
    bench_plain_loop(&b, 0, LAW_CLF, 1, 2);
    bench_plain_loop(&b, 1, LAW_CLF, -1, -2);
    b.settings.stage[1][0] = 5;
    b.settings.stage[1][1] = 5;
    refused(1, "stage", "different");
    b.settings.stage[1][1] = 7;
    accepted();
    b.settings.stage[1][0] = 33;
    refused(1, "stage", "own");
}

static void a_slope_against_its_gradient_is_refused_as_positive_feedback(void)
{
    for (unsigned i = 0; i < 2; i++)
        for (unsigned moves = MOVES_REFLUX; moves <= MOVES_HEAT; moves++) {
            setUp();
            double right = moves == MOVES_HEAT ? 1 : -1;
            b.settings.moves[0] = (uint8_t)moves;
            b.settings.gradient[0][i] = -2;
            b.settings.a[0][0] = (float)right;
            b.settings.a[0][1] = (float)right;
            accepted();
            b.settings.a[0][0] = (float)-right;
            b.settings.a[0][1] = (float)-right;
            refused(0, "a", "positive feedback");
            b.settings.moves[0] = MOVES_NONE;
            accepted();
        }
}

static void a_slope_is_needed_of_every_temperature_that_is_used(void)
{
    b.settings.a[0][1] = 0;
    refused(0, "a", "slope");
    b.settings.law[0] = LAW_CONVENTIONAL;
    accepted();
    b.settings.a[0][0] = 0;
    refused(0, "a", "slope");
    for (unsigned lacks = 0; lacks < 4; lacks++) {
        setUp();
        slopes_from_gradient(MOVES_HEAT);
        accepted();
        if (lacks == 0)
            b.settings.moves[0] = MOVES_NONE;
        else if (lacks == 1)
            b.settings.gradient[0][0] = 0;
        else if (lacks == 2)
            b.settings.holdup[0][1] = 0;
        else
            b.settings.flow[0] = 0;
        refused(0, "a", "slope");
    }
}

/* Every float parameter, the gains from the rule and the slopes from gradients: refused, or capped as a number (ko_kc by wh), or as
 * if not given (a gain that is not above 0). */
static void numbers_that_are_none_never_become_gains_or_slopes(void)
{
    static const float none[] = {NAN, INFINITY, -INFINITY};
    static const char *const inner[] = {"a1_1", "a2_1",   "kc_1",  "kc2_1",
                                        "ko_1", "freq_1", "damp_1"};
    for (unsigned i = 0; i < inferential_kind.parameters * 6; i++) {
        const struct block_parameter *p = &inferential_kind.parameter[i / 6];
        if (p->type != BLOCK_FLOAT)
            continue;
        setUp();
        slopes_from_gradient(MOVES_HEAT);
        no_gains();
        b.settings.w[0] = 1;
        b.settings.form = (uint8_t)(i / 3 % 2);
        memcpy((char *)&b.settings + p->offset, &none[i % 3], sizeof(float));
        struct block_fault fault;
        if (bench_check(&b, &fault)) {
            TEST_ASSERT_GREATER_THAN_MESSAGE(0, strlen(fault.wanted), p->name);
            continue;
        }
        bench_begin(&b);
        bench_step(&b);
        TEST_ASSERT_TRUE_MESSAGE(isfinite((double)num_to_float(b.out[0])), p->name);
        for (unsigned n = 0; n < sizeof inner / sizeof inner[0]; n++)
            TEST_ASSERT_TRUE_MESSAGE(isfinite(bench_value(&b, inner[n])), p->name);
    }
}

static void slopes_and_frequencies_that_are_none_are_refused(void)
{
    b.settings.a[0][1] = NAN;
    refused(0, "a", "");
    b.settings.a[0][1] = INFINITY;
    refused(0, "a", "");
    setUp();
    no_gains();
    b.settings.w[0] = NAN;
    refused(0, "w", "above 0");
}

static void gains_that_no_format_could_follow_are_refused(void)
{
    b.settings.form = FORM_JOINT;
    b.settings.wh[0] = 1e6f;
    b.settings.a[0][0] = 1e-3f; /* 22 over it: more than 1000 spans per span */
    b.settings.law[0] = LAW_CONVENTIONAL;
    b.settings.ko[0] = 1000;
    refused(0, "a", "fit");
    b.settings.a[0][0] = 1e6f;
    accepted();
}

/* Spans of T2 that make one of its factors large, and what they are with others. */
static void spans_that_do_not_fit_the_secondary_are_refused(void)
{
    static const float too_wide = 4 * 300,
                       wide = 4 * 240; /* Kc2/a2 times its span over the MV's 4 */
    b.settings.form = FORM_JOINT;
    b.setup.interval_s = 1;
    b.settings.a[0][0] = b.settings.a[0][1] = 1;
    b.settings.ko[0] = 2;
    b.settings.law[0] = LAW_CASCADE;
    b.setup.input[0].hi = b.setup.input[0].lo + too_wide;
    refused(0, "kc2", "1000");
    b.setup.input[0].hi = b.setup.input[0].lo + wide;
    accepted();
    b.settings.kc2[0] = 1;
    b.settings.ko[0] = 4.2f; /* the observer's share */
    refused(0, "kc2", "1000");
    b.settings.ko[0] = 4.1f;
    accepted();
    /* a2 Ts in spans, the other way round */
    b.setup.interval_s = 3600;
    b.setup.input[0].hi = b.setup.input[0].lo + 0.0039f;
    refused(0, "kc2", "1000");
    b.setup.input[0].hi = b.setup.input[0].lo + 0.0041f;
    accepted();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_parameters_are_those_of_the_page);
    RUN_TEST(it_serves_two_loops_with_a_secondary_each);
    RUN_TEST(the_inner_values_are_those_of_the_page);
    RUN_TEST(from_one_number_come_all_gains);
    RUN_TEST(the_rules_observer_stays_a_third_of_the_holdups);
    RUN_TEST(given_gains_go_before_the_rule);
    RUN_TEST(slopes_come_from_the_gradient);
    RUN_TEST(a_given_slope_goes_before_the_gradient);
    RUN_TEST(euler_is_refused_where_its_steps_are_too_long_and_the_joint_form_named);
    RUN_TEST(clf_is_refused_in_euler_steps_where_the_secondary_answers_too_little);
    RUN_TEST(a_given_observer_above_a_third_of_the_holdups_is_refused);
    RUN_TEST(neither_w_nor_gains_are_refused);
    RUN_TEST(two_temperatures_need_a_secondary);
    RUN_TEST(the_mvs_have_to_stand_last);
    RUN_TEST(more_temperatures_than_two_are_refused);
    RUN_TEST(slopes_a_thousand_times_apart_are_refused);
    RUN_TEST(the_same_stage_twice_is_refused);
    RUN_TEST(a_slope_against_its_gradient_is_refused_as_positive_feedback);
    RUN_TEST(a_slope_is_needed_of_every_temperature_that_is_used);
    RUN_TEST(numbers_that_are_none_never_become_gains_or_slopes);
    RUN_TEST(slopes_and_frequencies_that_are_none_are_refused);
    RUN_TEST(gains_that_no_format_could_follow_are_refused);
    RUN_TEST(spans_that_do_not_fit_the_secondary_are_refused);
    return UNITY_END();
}

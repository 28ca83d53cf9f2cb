/* Kind `inferential` as the tick uses it: bumpless starts, other settings while it runs, a secondary that is bad, manual. Bounds of a
 * bump: one step of num_t; two of a float next to 1 (2^-23). */
#include "inferential_bench.h"
#include "random_source.h"

#include "base/channel.h"

#define BUMP 0x1p-23

static struct infer_bench b, twin;

void setUp(void) {}
void tearDown(void) {}

static const enum inferential_law laws[] = {LAW_CONVENTIONAL, LAW_CASCADE, LAW_CLF};

static double out_of(const struct infer_bench *bench, unsigned k)
{
    return (double)num_to_float(bench->out[k]);
}

static void copy(struct infer_bench *to, const struct infer_bench *from)
{
    *to = *from;
    unsigned members = from->setup.members, seconds = from->seconds;
    struct block_setup setup = from->setup;
    struct block_io io = from->io;
    bench_wire(to, members, seconds, setup.interval_s);
    memcpy(to->ring, from->ring, sizeof to->ring);
    to->setup = setup;
    to->setup.settings = &to->settings;
    to->io.members.acting = io.members.acting;
}

/* With wires for two temperatures, whatever the law. */
static void begin(struct infer_bench *bench, enum inferential_law law, enum inferential_form form)
{
    bench_plain(bench, LAW_CLF, form, 30);
    bench->settings.law[0] = (uint8_t)law;
    bench_begin(bench);
}

/* Somewhere on its way: loads that do not fit each other, setpoint moved. */
static void run_a_while(struct infer_bench *bench)
{
    bench->plant[0].load[0] += 0.7;
    bench->plant[0].load[1] += 0.9;
    bench->plant[0].setpoint += 0.125;
    bench_cycles(bench, 20);
}

static void expect_same(const struct infer_bench *x, const struct infer_bench *y)
{
    TEST_ASSERT_DOUBLE_WITHIN(BUMP, out_of(x, 0), out_of(y, 0));
}

static bool raises(const struct infer_bench *bench, const char *code)
{
    for (unsigned i = 0; i < inferential_kind.events; i++)
        if (strcmp(inferential_kind.event[i].code, code) == 0)
            return bench->io.requests.raised & (1u << i);
    TEST_FAIL_MESSAGE(code);
    return false;
}

/* ---- bumpless ---- */

static double random_of(struct random_source *r, double lo, double hi)
{
    return lo + (hi - lo) * random_below(r, 1u << 20) / 1048575.0;
}

static void the_first_step_gives_the_output_that_it_followed(void)
{
    struct random_source r = {20101123};
    printf("seed %llu\n", (unsigned long long)r.state);
    for (unsigned n = 0; n < 600; n++) {
        bench_plain(&b, LAW_CLF, n % 2 ? FORM_JOINT : FORM_EULER, 30);
        b.settings.law[0] = (uint8_t)(n % 4);
        b.settings.kc[0] = (float)random_of(&r, 0.1, 10);
        b.settings.kc2[0] = (float)random_of(&r, 0.1, 20);
        b.settings.ko[0] = (float)random_of(&r, 1, 60);
        bench_configure(&b, false);
        for (unsigned i = 0; i <= n % 3; i++) {
            b.plant[0].t[0] = random_of(&r, -4, 4);
            b.plant[0].t[1] = random_of(&r, -4, 4);
            b.plant[0].setpoint = random_of(&r, -4, 4);
            b.plant[0].u = random_of(&r, 0, 4);
            bench_follow(&b);
        }
        num_t followed = b.out[0];
        b.io.members.acting = 1;
        b.out[0] = num_zero();
        bench_step(&b);
        TEST_ASSERT_DOUBLE_WITHIN(BUMP, (double)num_to_float(followed), out_of(&b, 0));
    }
}

static void new_gains_slopes_and_form_wait_for_the_step_after_and_then_it_goes_on(void)
{
    for (unsigned i = 0; i < 3; i++)
        for (unsigned what = 0; what < 4; what++) {
            begin(&b, laws[i], FORM_EULER);
            run_a_while(&b);
            copy(&twin, &b);
            struct inferential_settings *c = &b.settings;
            if (what == 0)
                c->kc[0] = 5;
            else if (what == 1)
                c->kc2[0] = 1, c->ko[0] = 30;
            else if (what == 2)
                c->a[0][0] = 1.4f, c->a[0][1] = 1.5f;
            else
                c->form = FORM_JOINT;
            bench_configure(&b, true);
            bench_step(&b);
            bench_step(&twin);
            expect_same(&b, &twin);
            bench_cycles(&b, 1200);
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, b.plant[0].setpoint, b.plant[0].t[0]);
        }
}

static void another_law_gives_what_the_one_before_would_have_given_and_then_goes_on(void)
{
    for (unsigned from = LAW_HOLD; from <= LAW_CLF; from++)
        for (unsigned to = LAW_HOLD; to <= LAW_CLF; to++)
            for (unsigned form = FORM_EULER; form <= FORM_JOINT; form++) {
                begin(&b, (enum inferential_law)from, (enum inferential_form)form);
                run_a_while(&b);
                copy(&twin, &b);
                b.settings.law[0] = (uint8_t)to;
                bench_configure(&b, true);
                bench_step(&b);
                bench_step(&twin);
                expect_same(&b, &twin);
                TEST_ASSERT_EQUAL(to, bench_value(&b, "law_1"));
                TEST_ASSERT_EQUAL_HEX16(0, b.io.requests.raised);
                bench_apply(&b);
                bench_go_on(&b);
                bench_cycles(&b, 1200);
                if (to != LAW_HOLD)
                    TEST_ASSERT_DOUBLE_WITHIN(1e-5, b.plant[0].setpoint, b.plant[0].t[0]);
            }
}

/* Of the law: with the setpoint weight Kc/(Kc + Ko) it is Kc that a step of the setpoint meets. */
static void a_step_of_the_setpoint_moves_the_output_by_kc_alone(void)
{
    begin(&b, LAW_CONVENTIONAL, FORM_EULER);
    bench_cycles(&b, 5);
    bench_step(&b);
    double before = out_of(&b, 0);
    bench_apply(&b);
    b.plant[0].setpoint = 0.25;
    bench_step(&b);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, before + 2 * 0.25 / 4, out_of(&b, 0));
}

/* ---- the secondary ---- */

static void without_its_secondary_it_goes_on_as_conventional_without_a_bump_and_back(void)
{
    for (unsigned i = 1; i < 3; i++) {
        begin(&b, laws[i], FORM_EULER);
        run_a_while(&b);
        b.quality[0] = QUALITY_BAD;
        bench_step(&b);
        TEST_ASSERT_EQUAL(LAW_CONVENTIONAL, bench_value(&b, "law_1"));
        bench_apply(&b);
        bench_go_on(&b);
        for (unsigned n = 2; n < 600; n++) { /* the tenth step in a row tells */
            bench_step(&b);
            TEST_ASSERT_EQUAL(n >= 10, raises(&b, "no_2nd"));
            if (n >= 10)
                TEST_ASSERT_EQUAL_FLOAT(1, b.event_value[0]);
            bench_apply(&b);
            bench_go_on(&b);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, b.plant[0].setpoint, b.plant[0].t[0]);

        b.plant[0].load[0] -= 0.3;
        bench_cycles(&b, 10);
        copy(&twin, &b);
        b.quality[0] = QUALITY_GOOD;
        bench_step(&b);
        bench_step(&twin);
        expect_same(&b, &twin);
        TEST_ASSERT_EQUAL_HEX16(0, b.io.requests.raised);
        TEST_ASSERT_EQUAL(laws[i], bench_value(&b, "law_1"));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, bench_value(&b, "y2_1"));
        bench_apply(&b);
        bench_go_on(&b);
        bench_cycles(&b, 1200);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, b.plant[0].setpoint, b.plant[0].t[0]);
    }
}

/* The reading stands still when it turns bad: then the output is what the pair would have given to the bit. */
static void the_step_in_which_the_secondary_turns_bad_is_the_one_with_its_last_reading(void)
{
    for (unsigned i = 1; i < 3; i++)
        for (unsigned form = FORM_EULER; form <= FORM_JOINT; form++) {
            begin(&b, laws[i], (enum inferential_form)form);
            run_a_while(&b);
            bench_step(&b);
            bench_apply(&b);
            copy(&twin, &b);
            bench_go_on(&b);
            double second = twin.plant[0].t[1];
            bench_go_on(&twin);
            twin.plant[0].t[1] = second;
            b.plant[0].t[1] = 3.75;
            b.quality[0] = QUALITY_MISSING;
            bench_step(&b);
            bench_step(&twin);
            expect_same(&b, &twin);
        }
}

static void what_a_bad_secondary_reads_makes_no_difference(void)
{
    begin(&b, LAW_CLF, FORM_JOINT);
    run_a_while(&b);
    b.quality[0] = QUALITY_BAD;
    copy(&twin, &b);
    twin.quality[0] = QUALITY_BAD;
    for (unsigned n = 0; n < 50; n++) {
        b.plant[0].t[1] = n % 2 ? -400 : 400;
        bench_cycle(&b);
        bench_cycle(&twin);
        TEST_ASSERT_TRUE(num_eq(b.out[0], twin.out[0]));
    }
}

static void a_start_without_the_secondary_is_a_start_as_conventional(void)
{
    bench_plain(&b, LAW_CASCADE, FORM_EULER, 30);
    bench_configure(&b, false);
    b.quality[0] = QUALITY_BAD;
    b.plant[0].t[0] = 0.5;
    bench_follow(&b);
    b.io.members.acting = 1;
    bench_step(&b);
    TEST_ASSERT_DOUBLE_WITHIN(BUMP, 0.5, out_of(&b, 0));
    TEST_ASSERT_EQUAL(LAW_CONVENTIONAL, bench_value(&b, "law_1"));
    bench_apply(&b);
    bench_go_on(&b);
    bench_cycles(&b, 10);
    TEST_ASSERT_TRUE(raises(&b, "no_2nd"));
    b.quality[0] = QUALITY_GOOD;
    bench_cycles(&b, 1200);
    TEST_ASSERT_EQUAL(LAW_CASCADE, bench_value(&b, "law_1"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, b.plant[0].t[0]);
}

static void a_secondary_that_is_held_or_doubtful_does_not_count(void)
{
    begin(&b, LAW_CLF, FORM_EULER);
    bench_cycles(&b, 10);
    b.quality[0] = QUALITY_UNCERTAIN;
    bench_cycle(&b);
    TEST_ASSERT_EQUAL(LAW_CONVENTIONAL, bench_value(&b, "law_1"));
}

static void a_reading_that_is_missing_now_and_then_is_not_told(void)
{
    begin(&b, LAW_CLF, FORM_EULER);
    for (unsigned n = 0; n < 100; n++) {
        b.quality[0] = n % 10 == 9 ? QUALITY_GOOD : QUALITY_MISSING;
        bench_cycle(&b);
        TEST_ASSERT_FALSE(raises(&b, "no_2nd"));
    }
}

static void twenty_equal_readings_in_a_row_are_one_thermometer(void)
{
    for (unsigned i = 1; i < 3; i++) {
        begin(&b, laws[i], FORM_EULER);
        b.plant[0].a[1] = b.plant[0].a[0];
        b.plant[0].load[1] = b.plant[0].load[0];
        bench_cycles(&b, 30);
        b.plant[0].load[0] = b.plant[0].load[1] += 0.5;
        double apart = b.plant[0].t[1] - b.plant[0].t[0];
        b.plant[0].t[1] = b.plant[0].t[0];
        for (unsigned n = 1; n < 20; n++) {
            bench_cycle(&b);
            TEST_ASSERT_FALSE(raises(&b, "same"));
        }
        copy(&twin, &b);
        bench_step(&b);
        bench_step(&twin);
        TEST_ASSERT_TRUE(raises(&b, "same"));
        TEST_ASSERT_FALSE(raises(&b, "no_2nd"));
        TEST_ASSERT_EQUAL(LAW_CONVENTIONAL, bench_value(&b, "law_1"));
        bench_apply(&b);
        bench_go_on(&b);
        b.plant[0].t[1] += apart;
        bench_step(&b);
        TEST_ASSERT_FALSE(raises(&b, "same"));
        TEST_ASSERT_EQUAL(laws[i], bench_value(&b, "law_1"));
    }
}

static void nineteen_equal_readings_are_not(void)
{
    begin(&b, LAW_CLF, FORM_EULER);
    for (unsigned n = 0; n < 200; n++) {
        b.plant[0].t[1] = n % 20 ? b.plant[0].t[0] : 1;
        bench_cycle(&b);
        TEST_ASSERT_EQUAL_HEX16(0, b.io.requests.raised);
    }
}

/* ---- hold, two loops, manual ---- */

static void hold_keeps_what_it_was_handed_also_past_a_limit(void)
{
    begin(&b, LAW_HOLD, FORM_EULER);
    run_a_while(&b);
    TEST_ASSERT_DOUBLE_WITHIN(BUMP, 0.5, out_of(&b, 0));
    b.plant[0].hi = 1; /* a quarter of the span */
    bench_cycles(&b, 2);
    b.plant[0].hi = 4;
    bench_cycles(&b, 5);
    TEST_ASSERT_DOUBLE_WITHIN(BUMP, 0.5, out_of(&b, 0));
}

static void two_loops(enum inferential_form form)
{
    memset(&b, 0, sizeof b);
    bench_defaults(&b.settings);
    bench_wire(&b, 2, 2, 30);
    b.settings.form = (uint8_t)form;
    bench_plain_loop(&b, 0, LAW_CASCADE, 1, 2);
    bench_plain_loop(&b, 1, LAW_CLF, -1.5, -0.75);
    b.settings.kc[1] = 3;
    b.settings.ko[1] = 15;
    bench_begin(&b);
}

static void shake(struct infer_bench *bench, unsigned k, unsigned loop, unsigned n)
{
    bench->plant[k].setpoint = n / 40 % 2 ? 0.25 : -0.125;
    bench->plant[k].hi = n % 100 < 50 ? 4 : 2.25;
    bench->plant[k].load[0] =
        -bench->plant[k].a[0] * 2 + (loop ? -0.3 : 0.4) * (double)(n / 25 % 3);
}

static void two_loops_at_once_are_two_blocks_of_one_loop(void)
{
    for (unsigned form = FORM_EULER; form <= FORM_JOINT; form++) {
        static struct infer_bench one[2];
        two_loops((enum inferential_form)form);
        for (unsigned k = 0; k < 2; k++) {
            struct infer_bench *x = &one[k];
            bench_plain(x, k ? LAW_CLF : LAW_CASCADE, (enum inferential_form)form, 30);
            bench_plain_loop(x, 0, k ? LAW_CLF : LAW_CASCADE, k ? -1.5 : 1, k ? -0.75 : 2);
            if (k) {
                x->settings.kc[0] = 3;
                x->settings.ko[0] = 15;
            }
            bench_begin(x);
        }
        for (unsigned n = 0; n < 400; n++) {
            for (unsigned k = 0; k < 2; k++) {
                shake(&b, k, k, n);
                shake(&one[k], 0, k, n);
                bench_cycle(&one[k]);
            }
            bench_cycle(&b);
            for (unsigned k = 0; k < 2; k++)
                TEST_ASSERT_TRUE(num_eq(b.out[k], one[k].out[0]));
        }
    }
}

static void a_loop_in_manual_follows_while_the_other_acts(void)
{
    two_loops(FORM_EULER);
    for (unsigned n = 0; n < 50; n++) {
        shake(&b, 0, 0, n);
        shake(&b, 1, 1, n);
        bench_cycle(&b);
    }
    b.io.members.acting = 1;
    for (unsigned n = 0; n < 100; n++) {
        shake(&b, 0, 0, n);
        bench_measure(&b);
        b.out[1] = num_from_float(0.4f + 0.001f * (float)n);
        num_t manual = b.out[1];
        inferential_kind.step(b.state, &b.io);
        TEST_ASSERT_TRUE(num_eq(manual, b.out[1]));
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, b.plant[1].t[0] - b.plant[1].setpoint,
                                  bench_value(&b, "y1_2"));
        bench_apply(&b);
        bench_go_on(&b);
    }
    double manual = b.plant[1].u / 4;
    /* As the tick does it: whoever begins follows first, and the other goes on. */
    copy(&twin, &b);
    bench_measure(&b);
    b.io.members.acting = 3;
    b.out[1] = b.input[3];
    inferential_kind.follow(b.state, &b.io);
    bench_step(&b);
    bench_step(&twin);
    TEST_ASSERT_DOUBLE_WITHIN(BUMP, manual, out_of(&b, 1));
    TEST_ASSERT_TRUE(num_eq(twin.out[0], b.out[0]));
}

static void a_bad_secondary_of_one_loop_is_told_with_its_number_and_leaves_the_other_alone(void)
{
    two_loops(FORM_EULER);
    bench_cycles(&b, 10);
    b.quality[1] = QUALITY_BAD;
    bench_cycles(&b, 9);
    bench_step(&b);
    TEST_ASSERT_TRUE(raises(&b, "no_2nd"));
    TEST_ASSERT_EQUAL_FLOAT(2, b.event_value[0]);
    TEST_ASSERT_EQUAL(LAW_CASCADE, bench_value(&b, "law_1"));
    TEST_ASSERT_EQUAL(LAW_CONVENTIONAL, bench_value(&b, "law_2"));
}

/* ---- wrong MV, inner values ---- */

static void it_gives_up_where_the_mv_among_its_inputs_is_not_the_loops(void)
{
    two_loops(FORM_EULER);
    bench_cycles(&b, 3);
    TEST_ASSERT_NULL(b.io.requests.gives_up);
    const struct applied_history *own = b.input_applied[2];
    b.input_applied[2] = b.input_applied[3];
    b.input_applied[3] = own;
    bench_step(&b);
    TEST_ASSERT_EQUAL_STRING("not_the_MV", b.io.requests.gives_up);
    b.input_applied[3] = b.input_applied[2];
    b.input_applied[2] = own;
    bench_step(&b);
    TEST_ASSERT_NULL(b.io.requests.gives_up);
}

static void a_cut_is_told_with_its_side(void)
{
    begin(&b, LAW_CASCADE, FORM_EULER);
    b.plant[0].lo = 1.5;
    b.plant[0].hi = 2.5;
    bench_cycle(&b);
    TEST_ASSERT_EQUAL(0, bench_value(&b, "sat_1"));
    b.plant[0].setpoint = 2;
    bench_cycle(&b);
    TEST_ASSERT_EQUAL(1, bench_value(&b, "sat_1"));
    b.plant[0].setpoint = -2;
    bench_cycle(&b);
    TEST_ASSERT_EQUAL(-1, bench_value(&b, "sat_1"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, out_of(&b, 0), 1.5 / 4);
    bench_follow(&b);
    TEST_ASSERT_EQUAL(0, bench_value(&b, "sat_1"));
}

static void both_actions_add_up_to_the_output(void)
{
    begin(&b, LAW_CLF, FORM_JOINT);
    run_a_while(&b);
    bench_step(&b);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, out_of(&b, 0),
                              bench_value(&b, "prim_1") + bench_value(&b, "sec_1"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, b.plant[0].t[0] - b.plant[0].setpoint, bench_value(&b, "y1_1"));
}

/* Page, "With loads that stand still"; damping of the published table with p = Kc2/Kc, q = a2/a1. */
static void frequency_and_damping_are_those_of_the_law_in_force(void)
{
    static const struct {
        enum inferential_law law;
        float a2, kc2, frequency, damping;
    } t[] = {
        {LAW_CONVENTIONAL, 2, 4, 6.324555f, 1.739253f},
        {LAW_CASCADE, 2, 4, 2.828427f, 1.0607f},
        {LAW_CASCADE, 2, 0.5f, 1, 1.25f},
        {LAW_CLF, 1, 4, 2.828427f, 1.7678f},
        {LAW_CLF, 2, 4, 2.828427f, 1.2374f},
        {LAW_CLF, 0.5f, 8, 4, 5.25f},
    };
    for (unsigned i = 0; i < sizeof t / sizeof t[0]; i++) {
        bench_plain(&b, LAW_CLF, FORM_EULER, 30);
        b.settings.law[0] = (uint8_t)t[i].law;
        b.settings.a[0][1] = t[i].a2;
        b.settings.kc2[0] = t[i].kc2;
        bench_begin(&b);
        bench_step(&b);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, t[i].frequency, bench_value(&b, "freq_1"));
        TEST_ASSERT_DOUBLE_WITHIN(6e-5, t[i].damping, bench_value(&b, "damp_1"));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_first_step_gives_the_output_that_it_followed);
    RUN_TEST(new_gains_slopes_and_form_wait_for_the_step_after_and_then_it_goes_on);
    RUN_TEST(another_law_gives_what_the_one_before_would_have_given_and_then_goes_on);
    RUN_TEST(a_step_of_the_setpoint_moves_the_output_by_kc_alone);
    RUN_TEST(without_its_secondary_it_goes_on_as_conventional_without_a_bump_and_back);
    RUN_TEST(the_step_in_which_the_secondary_turns_bad_is_the_one_with_its_last_reading);
    RUN_TEST(what_a_bad_secondary_reads_makes_no_difference);
    RUN_TEST(a_start_without_the_secondary_is_a_start_as_conventional);
    RUN_TEST(a_secondary_that_is_held_or_doubtful_does_not_count);
    RUN_TEST(a_reading_that_is_missing_now_and_then_is_not_told);
    RUN_TEST(twenty_equal_readings_in_a_row_are_one_thermometer);
    RUN_TEST(nineteen_equal_readings_are_not);
    RUN_TEST(hold_keeps_what_it_was_handed_also_past_a_limit);
    RUN_TEST(two_loops_at_once_are_two_blocks_of_one_loop);
    RUN_TEST(a_loop_in_manual_follows_while_the_other_acts);
    RUN_TEST(a_bad_secondary_of_one_loop_is_told_with_its_number_and_leaves_the_other_alone);
    RUN_TEST(it_gives_up_where_the_mv_among_its_inputs_is_not_the_loops);
    RUN_TEST(a_cut_is_told_with_its_side);
    RUN_TEST(both_actions_add_up_to_the_output);
    RUN_TEST(frequency_and_damping_are_those_of_the_law_in_force);
    return UNITY_END();
}

/* Kind `inferential`: other settings while it runs or waits, another secondary, and a loop that drives another whose output is at its
 * limit. Bounds of a bump: two steps of a float next to 1 (2^-23). */
#include "inferential_bench.h"

#define BUMP 0x1p-23

static struct infer_bench b;

void setUp(void) {}
void tearDown(void) {}

static double out(void)
{
    return (double)num_to_float(b.out[0]);
}

static void begin_with(unsigned seconds, enum inferential_law law, enum inferential_form form)
{
    memset(&b, 0, sizeof b);
    bench_defaults(&b.settings);
    bench_wire(&b, 1, seconds, 30);
    bench_plain_loop(&b, 0, law, 1, 2);
    b.settings.form = (uint8_t)form;
    for (unsigned j = 1; j < seconds; j++)
        b.setup.input[j] = (struct block_signal){.lo = -4, .hi = 4};
    bench_begin(&b);
    b.plant[0].load[0] += 0.7;
    b.plant[0].load[1] += 0.9;
    bench_cycles(&b, 20);
}

static void the_load_of_the_secondary_is_kept_through_other_gains_and_forms(void)
{
    for (unsigned form = FORM_EULER; form <= FORM_JOINT; form++)
        for (unsigned what = 0; what < 3; what++) {
            begin_with(1, LAW_CASCADE, (enum inferential_form)form);
            bench_cycle(&b);
            static struct infer_bench kept;
            memcpy(kept.state, b.state, sizeof b.state);
            bench_step(&b);
            double load = bench_value(&b, "b2_1");
            memcpy(b.state, kept.state, sizeof b.state);
            if (what == 0)
                b.settings.ko[0] = 40;
            else if (what == 1)
                b.settings.form = (uint8_t)!form;
            else
                b.settings.law[0] = LAW_CLF;
            bench_configure(&b, true);
            bench_step(&b);
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, load, bench_value(&b, "b2_1"));
            TEST_ASSERT_TRUE(fabs(load) > 2.9);
        }
}

/* With another slope the same movement of T2 has another load: b2 = dT2/dt - a2 u, u from the lower end. */
static void another_slope_of_the_secondary_changes_its_load_by_what_u_makes_of_it(void)
{
    begin_with(1, LAW_CASCADE, FORM_EULER);
    b.plant[0].load[0] = -b.plant[0].a[0] * 2.5;
    b.plant[0].load[1] = -b.plant[0].a[1] * 2.5;
    bench_cycles(&b, 2000); /* all stands still, at u = 2.5 */
    bench_step(&b);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, -5, bench_value(&b, "b2_1"));
    bench_apply(&b);
    b.settings.a[0][1] = 3;
    bench_configure(&b, true);
    bench_step(&b);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, -7.5, bench_value(&b, "b2_1"));
}

/* Another thermometer: T2* begins anew where that one is. */
static void another_secondary_takes_over_without_a_bump(void)
{
    for (unsigned form = FORM_EULER; form <= FORM_JOINT; form++) {
        static struct infer_bench twin;
        begin_with(2, LAW_CLF, (enum inferential_form)form);
        bench_step(&b);
        bench_apply(&b);
        twin = b;
        bench_measure(&b);
        b.input[1] = num_from_float(0.875f);
        b.settings.second[0] = 2;
        bench_configure(&b, true);
        inferential_kind.step(b.state, &b.io);
        num_t before = b.out[0];
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, bench_value(&b, "y2_1"));
        TEST_ASSERT_EQUAL(LAW_CLF, bench_value(&b, "law_1"));
        b.input[1] = num_from_float(0.75f); /* its reading counts, the other's does not */
        b.input[0] = num_from_float(0.25f);
        inferential_kind.step(b.state, &b.io);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, -1, bench_value(&b, "y2_1"));
        b.input[1] = num_from_float(0.875f);
        bench_measure(&b);
        /* The same without the change. */
        memcpy(b.state, twin.state, sizeof b.state);
        inferential_kind.step(b.state, &b.io);
        TEST_ASSERT_DOUBLE_WITHIN(BUMP, (double)num_to_float(before), out());
    }
}

static void settings_given_twice_before_a_step_are_the_last_ones(void)
{
    begin_with(2, LAW_CASCADE, FORM_EULER);
    b.settings.second[0] = 2;
    bench_configure(&b, true);
    b.settings.kc[0] = 3;
    bench_configure(&b, true);
    bench_measure(&b);
    b.input[1] = num_from_float(0.875f);
    inferential_kind.step(b.state, &b.io);
    TEST_ASSERT_EQUAL_FLOAT(3, bench_value(&b, "kc_1"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, bench_value(&b, "y2_1"));
}

static void settings_given_in_manual_hold_from_the_start(void)
{
    begin_with(1, LAW_CONVENTIONAL, FORM_EULER);
    b.settings.law[0] = LAW_CLF;
    b.settings.kc[0] = 3;
    bench_configure(&b, true);
    bench_follow(&b);
    num_t followed = b.out[0];
    TEST_ASSERT_EQUAL_FLOAT(3, bench_value(&b, "kc_1"));
    b.io.members.acting = 1;
    bench_step(&b);
    TEST_ASSERT_EQUAL(LAW_CLF, bench_value(&b, "law_1"));
    TEST_ASSERT_DOUBLE_WITHIN(BUMP, (double)num_to_float(followed), out());
}

/* Whatever stood in its memory before. */
static void a_block_that_begins_anew_remembers_nothing(void)
{
    double course[50];
    for (unsigned i = 0; i < 2; i++) {
        begin_with(1, LAW_CLF, FORM_JOINT);
        struct bench_plant before = b.plant[0];
        memset(b.state, i ? 0xFF : 0, sizeof b.state);
        bench_configure(&b, false);
        bench_follow(&b);
        b.io.members.acting = 1;
        bench_step(&b);
        TEST_ASSERT_EQUAL_HEX16(0, b.io.requests.raised);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, bench_value(&b, "y2_1"));
        TEST_ASSERT_EQUAL(0, bench_value(&b, "sat_1"));
        bench_apply(&b);
        b.plant[0] = before;
        for (unsigned n = 0; n < 50; n++) {
            bench_cycle(&b);
            TEST_ASSERT_EQUAL_HEX16(0, b.io.requests.raised);
            if (i == 0)
                course[n] = out();
            TEST_ASSERT_TRUE(course[n] == out());
        }
    }
}

/* The tick tells in the first follow already which loops act. */
static void a_first_start_at_an_output_of_nothing_follows_as_well(void)
{
    bench_plain(&b, LAW_CLF, FORM_EULER, 30);
    memset(b.state, 0xFF, sizeof b.state);
    b.plant[0].t[0] = 1;
    b.plant[0].u = 0;
    bench_configure(&b, false);
    bench_measure(&b);
    b.io.members.acting = 1;
    b.out[0] = num_zero();
    inferential_kind.follow(b.state, &b.io);
    bench_step(&b);
    TEST_ASSERT_DOUBLE_WITHIN(BUMP, 0, out());
}

/* Equal are temperatures, not fractions of span. */
static void one_thermometer_is_known_by_its_temperature_whatever_the_spans(void)
{
    for (unsigned equal = 0; equal < 2; equal++) {
        begin_with(1, LAW_CASCADE, FORM_EULER);
        b.setup.input[0] = (struct block_signal){.lo = 0, .hi = 8};
        bench_begin(&b);
        for (unsigned n = 0; n < 25; n++) {
            b.plant[0].t[0] = 1;
            b.plant[0].t[1] = equal ? 1 : 5; /* 5 of 0..8 is where 1 of -4..4 is */
            bench_step(&b);
            bench_apply(&b);
        }
        TEST_ASSERT_EQUAL(equal ? LAW_CONVENTIONAL : LAW_CASCADE, bench_value(&b, "law_1"));
    }
}

/* T stands still so far below its setpoint, and the loop that is driven cannot go further up, or down. */
static double moved_in_an_hour(double below, uint8_t clamp)
{
    begin_with(1, LAW_CONVENTIONAL, FORM_EULER);
    bench_follow(&b);
    b.io.members.acting = 1;
    b.plant[0].setpoint = b.plant[0].t[0] + below;
    bench_step(&b);
    double first = out();
    for (unsigned n = 0; n < 120; n++) {
        b.clamp[0] = clamp;
        bench_apply(&b);
        bench_step(&b);
    }
    return out() - first;
}

static void where_what_it_drives_is_at_its_limit_the_observer_does_not_go_on_there(void)
{
    const uint8_t both = INTEGRAL_CLAMP_UP | INTEGRAL_CLAMP_DOWN;
    double up = moved_in_an_hour(0.01, INTEGRAL_FREE),
           down = moved_in_an_hour(-0.01, INTEGRAL_FREE);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.01 * 2 * 20 / 4, up); /* Kc Ko/a for an hour */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, moved_in_an_hour(0.01, INTEGRAL_CLAMP_UP));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, up, moved_in_an_hour(0.01, INTEGRAL_CLAMP_DOWN));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, moved_in_an_hour(0.01, both));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, -0.01 * 2 * 20 / 4, down);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, moved_in_an_hour(-0.01, INTEGRAL_CLAMP_DOWN));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, down, moved_in_an_hour(-0.01, INTEGRAL_CLAMP_UP));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, moved_in_an_hour(-0.01, both));
}

/* Half an action away: cut from 0.6 to 0.5 it is cut; the primary part that stays below 0.5 is not (page, "u* as far as the MV
 * goes"): T2* then goes on with all of it, which shows in e2. Beside the same sums in double. */
static void the_primary_action_goes_as_far_as_the_mv(void)
{
    static const struct {
        double setpoint, e2, lo, hi;
    } t[] = {
        /* cut from above by what the primary wants, by what the secondary wants, from below, and not at all */
        {0.5, 0, 1.5, 2.25},
        {0, -0.5, 1.5, 2.25},
        {-0.5, 0, 1.75, 2.5},
        {0, 0.5, 1.75, 2.5},
        {0.25, 0, 0, 4},
        /* the primary alone leaves the span, the output does not */
        {1.5, 1.0, 0, 4},
        {-1.5, -1.0, 0, 4},
    };
    const double h = 30.0 / 3600;
    for (unsigned i = 0; i < sizeof t / sizeof t[0]; i++) {
        bench_plain(&b, LAW_CASCADE, FORM_EULER, 30);
        bench_begin(&b);
        bench_cycle(&b);
        b.plant[0].lo = t[i].lo;
        b.plant[0].hi = t[i].hi;
        b.plant[0].setpoint = t[i].setpoint;
        b.plant[0].t[1] += t[i].e2;
        bench_step(&b);
        double up = 2 + 2 * t[i].setpoint, b2 = -4 + 20 * t[i].e2, u = up - 4 * t[i].e2 / 2,
               us = fmin(fmax(u, t[i].lo), t[i].hi);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, u / 4, out());
        bench_apply(&b);
        double ups = us < u ? fmin(up, us) : us > u ? fmax(up, us) : up;
        ups = fmin(fmax(ups, 0), 4);
        bench_step(&b); /* T2 has not moved */
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, t[i].e2 - h * (2 * ups + b2), bench_value(&b, "y2_1"));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_load_of_the_secondary_is_kept_through_other_gains_and_forms);
    RUN_TEST(another_slope_of_the_secondary_changes_its_load_by_what_u_makes_of_it);
    RUN_TEST(another_secondary_takes_over_without_a_bump);
    RUN_TEST(settings_given_twice_before_a_step_are_the_last_ones);
    RUN_TEST(settings_given_in_manual_hold_from_the_start);
    RUN_TEST(a_block_that_begins_anew_remembers_nothing);
    RUN_TEST(a_first_start_at_an_output_of_nothing_follows_as_well);
    RUN_TEST(one_thermometer_is_known_by_its_temperature_whatever_the_spans);
    RUN_TEST(where_what_it_drives_is_at_its_limit_the_observer_does_not_go_on_there);
    RUN_TEST(the_primary_action_goes_as_far_as_the_mv);
    return UNITY_END();
}

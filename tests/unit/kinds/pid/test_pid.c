/* kinds/pid/pid.[ch]: one controller, open loop.
 *
 * Contract                                              float32       Q7.24
 *   a single step against the equations in double       2e-7          2e-7
 *   integral of 1e-4 of span over 6 h of 0.05 s ticks,
 *     Ti = 1 h, K = 0.5, against exact: relative        3e-4          3e-4     (one step of the output)
 *   the same of 1e-2 of span with Ti = 10 h             2e-5          2e-5
 *   velocity against positional, unsaturated            2e-7          2e-7
 *   tracking when applied equals computed               exactly 0     exactly 0
 */
#include <math.h>
#include <string.h>

#include "pid_bench.h"

void setUp(void) {}
void tearDown(void) {}

static struct pid_config pi_config(float gain, float ti_s)
{
    struct pid_config c = pid_default_config();
    c.gain = gain;
    c.ti_s = ti_s;
    return c;
}

/* Fault of others: PV - SP where the textbook says SP - PV. */
static void a_measurement_below_the_setpoint_raises_a_reverse_acting_output(void)
{
    struct pid pid = make_pid(pi_config(2.0f, 10.0f), 1.0f);
    pid_follow(&pid, N(0.5), N(0.5), N(0.4));
    double up = tick(&pid, 0.5, 0.45);
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.4 + 2.0 * 0.05, up);
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.05, D(pid.error));
    TEST_ASSERT_TRUE(tick(&pid, 0.5, 0.45) > up); /* and goes on integrating upwards */
}

static void a_direct_acting_controller_moves_the_other_way(void)
{
    struct pid_config c = pi_config(2.0f, 10.0f);
    c.action = PID_DIRECT;
    struct pid pid = make_pid(c, 1.0f);
    pid_follow(&pid, N(0.5), N(0.5), N(0.4));
    double down = tick(&pid, 0.5, 0.45);
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.4 - 2.0 * 0.05, down);
    TEST_ASSERT_TRUE(tick(&pid, 0.5, 0.45) < down);
}

/* Fault of others: integral time 0 divides by zero. */
static void an_integral_time_of_zero_means_no_integral_action(void)
{
    for (int form = 0; form < 2; form++) {
        struct pid_config c = pi_config(2.0f, 0.0f);
        c.form = (enum pid_form)form;
        struct pid pid = make_pid(c, 1.0f);
        pid_follow(&pid, N(0.5), N(0.5), N(0.4));
        double first = tick(&pid, 0.5, 0.45);
        TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.5, first);
        for (int k = 0; k < 1000; k++)
            TEST_ASSERT_TRUE(tick(&pid, 0.5, 0.45) == first);
    }
}

static void without_integral_action_saturation_does_not_move_the_bias(void)
{
    struct pid pid = make_pid(pi_config(2.0f, 0.0f), 1.0f);
    pid_follow(&pid, N(0.5), N(0.5), N(0.4));
    for (int k = 0; k < 1000; k++)
        TEST_ASSERT_TRUE(tick(&pid, 0.5, 0.0) == 1.0);
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.4, tick(&pid, 0.5, 0.5));
}

static void the_first_step_after_init_has_no_kick_and_starts_from_the_lowest_output(void)
{
    struct pid_config c = pi_config(5.0f, 10.0f);
    c.td_s = 20.0f;
    c.out_lo = 0.1f;
    struct pid pid = make_pid(c, 1.0f);
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, (double)0.1f, tick(&pid, 0.9, 0.2));
}

static void the_setpoint_weight_scales_the_proportional_kick_only(void)
{
    struct pid_config c = pi_config(2.0f, 0.0f);
    c.b = 0.25f;
    struct pid pid = make_pid(c, 1.0f);
    pid_follow(&pid, N(0.5), N(0.5), N(0.4));
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.4 + 2.0 * 0.25 * 0.1, tick(&pid, 0.6, 0.5));
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.4 + 2.0 * 0.25 * 0.1 - 2.0 * 0.05, tick(&pid, 0.6, 0.55));
}

static void a_setpoint_step_gives_no_derivative_kick_when_c_is_zero(void)
{
    struct pid_config c = pi_config(2.0f, 0.0f);
    c.b = 0.0f;
    c.td_s = 30.0f;
    struct pid pid = make_pid(c, 1.0f);
    pid_follow(&pid, N(0.2), N(0.5), N(0.4));
    for (int k = 0; k < 10; k++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, D(N(0.4)), tick(&pid, 0.9, 0.5));
}

static void the_derivative_acts_against_a_rising_measurement_and_dies_away(void)
{
    struct pid_config c = pi_config(1.0f, 0.0f);
    c.td_s = 16.0f;
    c.out_lo = -1.0f;
    struct pid pid = make_pid(c, 1.0f); /* filter 2 s */
    pid_follow(&pid, N(0.5), N(0.5), N(0.5));
    double d = 0.0;
    d = 2.0 / 3.0 * d - 16.0 / 3.0 * 0.02;
    TEST_ASSERT_DOUBLE_WITHIN(3e-7, 0.5 - 0.02 + d, tick(&pid, 0.5, 0.52));
    for (int k = 0; k < 5; k++) {
        d *= 2.0 / 3.0;
        TEST_ASSERT_DOUBLE_WITHIN(3e-7, 0.48 + d, tick(&pid, 0.5, 0.52));
    }
    for (int k = 0; k < 100; k++)
        tick(&pid, 0.5, 0.52);
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.48, tick(&pid, 0.5, 0.52));
}

static double integrate_for_hours(enum pid_form form, double error, double hours, double ti_s)
{
    struct pid_config c = pi_config(0.5f, (float)ti_s);
    c.form = form;
    struct pid pid = make_pid(c, 0.05f);
    double y = 0.5 - error;
    pid_follow(&pid, N(0.5), N(y), N(0.25));
    int ticks = (int)lround(hours * 72000.0);
    double u = 0.0;
    for (int k = 0; k <= ticks; k++)
        u = tick(&pid, 0.5, y);
    double want = 0.5 * (D(N(0.5)) - D(N(y))) * hours * 3600.0 / ti_s;
    double relative = (u - 0.25) / want - 1.0;
    printf("integral of %g over %g h, Ti %g s, %s form: %.2g relative\n", error, hours, ti_s,
           form == PID_VELOCITY ? "velocity" : "positional", relative);
    return relative;
}

static void the_integral_does_not_stall_at_50_ms_ticks_with_an_hour_of_integral_time(void)
{
    for (int form = 0; form < 2; form++) {
        TEST_ASSERT_TRUE(fabs(integrate_for_hours((enum pid_form)form, 1e-4, 6.0, 3600.0)) < 3e-4);
        TEST_ASSERT_TRUE(fabs(integrate_for_hours((enum pid_form)form, -1e-4, 6.0, 3600.0)) < 3e-4);
        TEST_ASSERT_TRUE(fabs(integrate_for_hours((enum pid_form)form, 1e-2, 6.0, 36000.0)) < 2e-5);
    }
}

static void the_integral_acts_at_a_fraction_of_a_second_of_integral_time(void)
{
    for (int form = 0; form < 2; form++)
        TEST_ASSERT_TRUE(fabs(integrate_for_hours((enum pid_form)form, 1e-2, 0.002, 0.5)) < 3e-4);
}

static void velocity_and_positional_algorithms_agree_while_nothing_is_limited(void)
{
    struct pid_config c = pi_config(1.5f, 40.0f);
    c.td_s = 6.0f;
    c.b = 0.6f;
    c.c = 0.2f;
    struct pid positional = make_pid(c, 0.5f);
    c.form = PID_VELOCITY;
    struct pid velocity = make_pid(c, 0.5f);
    pid_follow(&positional, N(0.5), N(0.5), N(0.5));
    pid_follow(&velocity, N(0.5), N(0.5), N(0.5));
    double worst = 0.0;
    for (int k = 0; k < 20000; k++) {
        double r = k % 1000 < 500 ? 0.5 : 0.52, y = 0.51 + 0.02 * sin(0.037 * k);
        worst = fmax(worst, fabs(tick(&positional, r, y) - tick(&velocity, r, y)));
    }
    printf("velocity against positional: %.2g\n", worst);
    TEST_ASSERT_TRUE(worst < 2e-7);
}

/* Fault of others: integral wound up while saturated. */
static void the_integral_does_not_wind_up_while_the_output_is_saturated(void)
{
    for (int form = 0; form < 2; form++) {
        struct pid_config c = pi_config(2.0f, 20.0f);
        c.form = (enum pid_form)form;
        struct pid pid = make_pid(c, 1.0f);
        pid_follow(&pid, N(0.5), N(0.5), N(0.5));
        for (int k = 0; k < 10000; k++) /* nearly three hours of a demand that cannot be met */
            TEST_ASSERT_TRUE(tick(&pid, 0.9, 0.3) <= 1.0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, tick(&pid, 0.9, 0.3));
        int until_off_the_limit = 0;
        while (tick(&pid, 0.9, 0.95) >= 1.0 && until_off_the_limit < 1000)
            until_off_the_limit++;
        TEST_ASSERT_LESS_OR_EQUAL_INT(1, until_off_the_limit);
    }
}

static void the_integral_does_not_wind_up_when_something_downstream_limits(void)
{
    for (int form = 0; form < 2; form++) {
        struct pid_config c = pi_config(2.0f, 20.0f);
        c.form = (enum pid_form)form;
        struct pid pid = make_pid(c, 1.0f);
        pid_follow(&pid, N(0.5), N(0.5), N(0.5));
        for (int k = 0; k < 2000; k++) {
            num_t u = pid_step(&pid, N(0.6), N(0.5));
            pid_back_calculate(&pid, num_min(u, N(0.55)), INTEGRAL_FREE);
        }
        /* positional: at rest the raw output stands K h/Ti e Tt/h = K e above the applied one */
        TEST_ASSERT_TRUE(D(pid.raw) < 0.55 + 2.0 * 0.1 + 1e-5);
        TEST_ASSERT_TRUE(tick(&pid, 0.6, 0.7) < 0.55);
    }
}

static void tracking_drives_the_integral_with_its_own_time_constant(void)
{
    struct pid_config c = pi_config(1.0f, 100.0f);
    c.tt_s = 10.0f;
    struct pid pid = make_pid(c, 1.0f);
    pid_follow(&pid, N(0.5), N(0.5), N(0.8));
    double gap = 0.3;
    for (int k = 0; k < 30; k++) {
        num_t u = pid_step(&pid, N(0.5), N(0.5));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5 + gap, D(u));
        pid_back_calculate(&pid, N(0.5), INTEGRAL_FREE);
        gap *= 0.9;
    }
}

static void tracking_adds_exactly_nothing_when_the_output_took_effect_as_computed(void)
{
    struct pid_config c = pi_config(3.0f, 50.0f);
    c.td_s = 5.0f;
    for (int form = 0; form < 2; form++) {
        c.form = (enum pid_form)form;
        struct pid pid = make_pid(c, 0.05f);
        pid_follow(&pid, N(0.5), N(0.47), N(0.3));
        for (int k = 0; k < 100; k++)
            tick(&pid, 0.5, 0.47);
        num_t u = pid_step(&pid, N(0.47), N(0.47)); /* error 0: no integration either */
        TEST_ASSERT_TRUE(num_eq(u, pid.raw));
        struct accumulator before = pid.sum;
        pid_back_calculate(&pid, u, INTEGRAL_FREE);
        TEST_ASSERT_EQUAL_MEMORY(&before, &pid.sum, sizeof before);
    }
}

static void hold_stops_integration_in_the_forbidden_direction_only(void)
{
    const struct {
        uint8_t hold;
        double error;
        enum pid_action action;
        bool moves;
    } cases[] = {
        {INTEGRAL_CLAMP_UP, 0.1, PID_REVERSE, false},
        {INTEGRAL_CLAMP_UP, -0.1, PID_REVERSE, true},
        {INTEGRAL_CLAMP_DOWN, 0.1, PID_REVERSE, true},
        {INTEGRAL_CLAMP_DOWN, -0.1, PID_REVERSE, false},
        {INTEGRAL_CLAMP_UP, 0.1, PID_DIRECT, true},
        {INTEGRAL_CLAMP_UP, -0.1, PID_DIRECT, false},
        {INTEGRAL_CLAMP_DOWN, 0.1, PID_DIRECT, false},
        {INTEGRAL_CLAMP_DOWN, -0.1, PID_DIRECT, true},
        {INTEGRAL_CLAMP_UP | INTEGRAL_CLAMP_DOWN, 0.1, PID_REVERSE, false},
        {INTEGRAL_FREE, 0.1, PID_REVERSE, true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int form = 0; form < 2; form++) {
            struct pid_config c = pi_config(1.0f, 10.0f);
            c.action = cases[i].action;
            c.form = (enum pid_form)form;
            struct pid pid = make_pid(c, 1.0f);
            pid_follow(&pid, N(0.5), N(0.5 - cases[i].error), N(0.5));
            for (int k = 0; k < 2; k++) {
                num_t u = pid_step(&pid, N(0.5), N(0.5 - cases[i].error));
                pid_back_calculate(&pid, u, cases[i].hold);
            }
            double moved = D(pid_step(&pid, N(0.5), N(0.5 - cases[i].error))) - 0.5;
            double want = cases[i].error * (cases[i].action == PID_DIRECT ? -0.2 : 0.2);
            TEST_ASSERT_DOUBLE_WITHIN(3e-7, cases[i].moves ? want : 0.0, moved);
        }
    }
}

static void the_output_stays_within_its_limits(void)
{
    struct pid_config c = pi_config(50.0f, 5.0f);
    c.td_s = 10.0f;
    c.out_lo = 0.12f;
    c.out_hi = 0.6f;
    for (int form = 0; form < 2; form++) {
        c.form = (enum pid_form)form;
        struct pid pid = make_pid(c, 1.0f);
        pid_follow(&pid, N(0.5), N(0.5), N(0.3));
        for (int k = 0; k < 2000; k++) {
            double u = tick(&pid, 0.5 + 0.5 * sin(0.1 * k), 0.5 + 0.6 * sin(0.37 * k));
            TEST_ASSERT_TRUE(u >= D(N(0.12)) && u <= D(N(0.6)));
        }
    }
}

static void the_output_changes_no_faster_than_its_rate_limit(void)
{
    struct pid_config c = pi_config(10.0f, 5.0f);
    c.rate_per_s = 0.02f;
    struct pid pid = make_pid(c, 0.5f);
    pid_follow(&pid, N(0.5), N(0.5), N(0.3));
    double last = 0.3;
    for (int k = 0; k < 1000; k++) {
        double u = tick(&pid, k % 300 < 150 ? 0.8 : 0.2, 0.5);
        TEST_ASSERT_TRUE(fabs(u - last) <= 0.01 + 2 * NUM_STEP);
        last = u;
    }
}

static void a_rate_limit_finer_than_one_step_of_the_number_format_still_moves(void)
{
    struct pid_config c = pi_config(10.0f, 5.0f);
    c.rate_per_s = 1e-6f;
    struct pid pid = make_pid(c, 0.01f);
    pid_follow(&pid, N(0.5), N(0.5), N(0.3));
    double u = 0.0;
    for (int k = 0; k < 1000000; k++)
        u = tick(&pid, 0.9, 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(2 * NUM_STEP, 0.31, u);
}

static void the_rate_limit_starts_from_what_was_really_applied(void)
{
    struct pid_config c = pi_config(10.0f, 5.0f);
    c.rate_per_s = 0.02f;
    struct pid pid = make_pid(c, 1.0f);
    pid_follow(&pid, N(0.5), N(0.5), N(0.3));
    pid_step(&pid, N(0.9), N(0.5));
    pid_back_calculate(&pid, N(0.1), INTEGRAL_FREE); /* an interlock forced it */
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.12, tick(&pid, 0.9, 0.5));
}

static void the_largest_settings_give_finite_limited_outputs(void)
{
    struct pid_config c = pi_config(100.0f, 0.01f);
    c.td_s = 1e5f;
    c.n = 100.0f;
    c.c = 1.0f;
    c.out_lo = -1.0f;
    c.out_hi = 2.0f;
    for (int form = 0; form < 2; form++) {
        c.form = (enum pid_form)form;
        struct pid pid = make_pid(c, 1e5f);
        pid_follow(&pid, N(0.5), N(0.5), N(0.3));
        for (int k = 0; k < 200; k++) {
            double u = tick(&pid, k % 2 ? 2.0 : -1.0, k % 3 ? 2.0 : -1.0);
            TEST_ASSERT_TRUE(u >= -1.0 && u <= 2.0);
        }
    }
}

static void a_velocity_output_driven_beyond_the_number_range_comes_back_at_once(void)
{
    struct pid_config c = pi_config(100.0f, 0.0f);
    c.form = PID_VELOCITY;
    struct pid pid = make_pid(c, 1.0f);
    pid_follow(&pid, N(0.5), N(0.5), N(0.5));
    TEST_ASSERT_TRUE(tick(&pid, 0.5, -1.5) == 1.0); /* computed: 200.5, more than Q7.24 holds */
    TEST_ASSERT_TRUE(tick(&pid, 0.5, -1.0) == 0.0); /* 50 back from the limit, not from 200.5 */
}

/* K 100 on an error of a whole span, tracking ten times as slow as the integral: the output before limits rests a thousand
 * spans above the applied one. What Q7.24 cannot show it must still take back. */
static void an_output_far_beyond_the_range_of_the_number_is_taken_back(void)
{
    for (int form = 0; form < 2; form++) {
        struct pid_config c = pi_config(100.0f, 10.0f);
        c.tt_s = 100.0f;
        c.form = (enum pid_form)form;
        struct pid pid = make_pid(c, 1.0f);
        pid_follow(&pid, N(0), N(0), N(0.5));
        double sum = 0.5, last_e = 0.0, worst = 0.0;
        unsigned inside = 0;
        for (int k = 0; k < 4000; k++) {
            double e = k < 1500 ? 1.0 : k < 2500 ? -0.25 : 0.001 * sin(0.1 * k);
            num_t u = pid_step(&pid, N(e), N(0));
            double raw = form ? sum + 100.0 * (e - last_e) : sum + 100.0 * e;
            double applied = fmin(1.0, fmax(0.0, raw));
            inside += raw > 0.01 && raw < 0.99;
            worst = fmax(worst, fabs(applied - D(u)));
            pid_back_calculate(&pid, u, INTEGRAL_FREE);
            sum = form ? applied + 10.0 * e : sum + 10.0 * e + (applied - raw) / 100.0;
            last_e = e;
        }
        printf("form %d: worst %.2g, inside %u\n", form, worst, inside);
        TEST_ASSERT_TRUE(inside > 300);
        TEST_ASSERT_TRUE(worst < 2e-3); /* 2e-6 of what was taken back */
    }
}

/* Likewise of the derivative, at the largest gain and ratio: ten thousand spans for a step of one. */
static void a_derivative_beyond_the_range_of_the_number_dies_away_in_its_time(void)
{
    struct pid_config c = pi_config(100.0f, 0.0f);
    c.td_s = 200.0f;
    c.n = 100.0f;
    for (int form = 0; form < 2; form++) {
        c.form = (enum pid_form)form;
        struct pid pid = make_pid(c, 1.0f);
        pid_follow(&pid, N(0), N(0), N(0.5));
        pid_step(&pid, N(0), N(-1));
        for (int k = 0; k < 40; k++)
            pid_step(&pid, N(0), N(0));
        /* a step up and one down: 100 * 200/3 (2/3 - 1) (2/3)^39, dying away with 2/3 a step */
        double left = -100.0 * 200.0 / 3.0 / 3.0 * pow(2.0 / 3.0, 39);
        TEST_ASSERT_DOUBLE_WITHIN(fabs(left) * 1e-3, left, D(washout_value(&pid.derivative)));
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.5 + left, D(pid.raw));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_measurement_below_the_setpoint_raises_a_reverse_acting_output);
    RUN_TEST(a_direct_acting_controller_moves_the_other_way);
    RUN_TEST(an_integral_time_of_zero_means_no_integral_action);
    RUN_TEST(without_integral_action_saturation_does_not_move_the_bias);
    RUN_TEST(the_first_step_after_init_has_no_kick_and_starts_from_the_lowest_output);
    RUN_TEST(the_setpoint_weight_scales_the_proportional_kick_only);
    RUN_TEST(a_setpoint_step_gives_no_derivative_kick_when_c_is_zero);
    RUN_TEST(the_derivative_acts_against_a_rising_measurement_and_dies_away);
    RUN_TEST(the_integral_does_not_stall_at_50_ms_ticks_with_an_hour_of_integral_time);
    RUN_TEST(the_integral_acts_at_a_fraction_of_a_second_of_integral_time);
    RUN_TEST(velocity_and_positional_algorithms_agree_while_nothing_is_limited);
    RUN_TEST(the_integral_does_not_wind_up_while_the_output_is_saturated);
    RUN_TEST(the_integral_does_not_wind_up_when_something_downstream_limits);
    RUN_TEST(tracking_drives_the_integral_with_its_own_time_constant);
    RUN_TEST(tracking_adds_exactly_nothing_when_the_output_took_effect_as_computed);
    RUN_TEST(hold_stops_integration_in_the_forbidden_direction_only);
    RUN_TEST(the_output_stays_within_its_limits);
    RUN_TEST(the_output_changes_no_faster_than_its_rate_limit);
    RUN_TEST(a_rate_limit_finer_than_one_step_of_the_number_format_still_moves);
    RUN_TEST(the_rate_limit_starts_from_what_was_really_applied);
    RUN_TEST(a_velocity_output_driven_beyond_the_number_range_comes_back_at_once);
    RUN_TEST(the_largest_settings_give_finite_limited_outputs);
    RUN_TEST(an_output_far_beyond_the_range_of_the_number_is_taken_back);
    RUN_TEST(a_derivative_beyond_the_range_of_the_number_dies_away_in_its_time);
    return UNITY_END();
}

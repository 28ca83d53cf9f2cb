/* The controller `rst` (kinds/rst/rst.h). Contract, with a plant of two poles and signals within a span: in 300 closed steps measurements
 * are those of K P u = R w - Q y in double to 2e-5 of a span in both formats, outputs to 20 times that. A step rounds y, and so
 * differences that meet coefficients of up to 28, to 2^-24 of a span, 3e-6 in u, of which the loop remembers 15 steps. */
#include <math.h>
#include <stdalign.h>
#include <string.h>

#include "formats.h"
#include "kinds/rst/rst.h"
#include "unity.h"

#define EXACT 2e-5
#define STEPS 300

static alignas(8) char state[1024];
static struct rst_settings settings;
static struct block_setup setup;
static struct block_fault fault;
static num_t in[1], out[1], setpoint[1];
static uint8_t clamp[1], limited[1];
static struct block_io io;

/* A plant of two poles, 0.9 and 0.6, and a controller whose loop has its poles at 0.8 exp(+-0.3i) and 0: found by hand from
 * A K P + B Q = M with B = 0.05 z^-1 and so P = 1. */
static const double den[3] = {1, -1.5, 0.54}, num = 0.05;
static double q[3], r0;

static void take_controller(void)
{
    double m1 = -2 * 0.8 * cos(0.3), m2 = 0.64;
    /* A K = 1 - 2.5 z^-1 + 2.04 z^-2 - 0.54 z^-3 */
    q[0] = (m1 + 2.5) / num;
    q[1] = (m2 - 2.04) / num;
    q[2] = 0.54 / num;
    r0 = (1 + m1 + m2) / num;
    settings = (struct rst_settings){.period_s = 120};
    for (unsigned k = 0; k < 3; k++)
        settings.q[k] = (float)q[k];
    settings.r[0] = (float)r0;
}

void setUp(void)
{
    take_controller();
    memset(&setup, 0, sizeof setup);
    setup.settings = &settings;
    setup.interval_s = 120;
    setup.members = 1;
    setup.present = 1;
    clamp[0] = INTEGRAL_FREE;
    io = (struct block_io){.members.acting = 1,
                           .members.setpoint = setpoint,
                           .members.in = in,
                           .members.out = out,
                           .members.clamp = clamp,
                           .members.limited = limited};
}
void tearDown(void) {}

static void configure(bool retune)
{
    TEST_ASSERT_EQUAL(ERR_OK, rst_kind.check(&setup, &fault));
    TEST_ASSERT_TRUE(rst_kind.bytes(&setup) <= sizeof state);
    TEST_ASSERT_EQUAL(ERR_OK, rst_kind.configure(state, &setup, retune));
}

static void follow(double w, double y, double u)
{
    setpoint[0] = N(w);
    in[0] = N(y);
    out[0] = N(u);
    rst_kind.follow(state, &io);
}

static double stepped(double w, double y)
{
    setpoint[0] = N(w);
    in[0] = N(y);
    rst_kind.step(state, &io);
    return D(out[0]);
}

static void told(double u)
{
    out[0] = N(u);
    rst_kind.back_calculate(state, &io);
}

static void as_given(void)
{
    rst_kind.back_calculate(state, &io);
}

/* The plant, its input and output deviations from 0.4 and 0.3. */
struct plant {
    double y[2], u;
};

static double plant_step(struct plant *p, double u)
{
    double y = num * (u - 0.4) - den[1] * p->y[0] - den[2] * p->y[1];
    p->y[1] = p->y[0];
    p->y[0] = y;
    return y + 0.3;
}

/* ---- the law ---- */

static void closed_it_is_the_law_in_double(void)
{
    double y_ref[STEPS + 3], u_ref[STEPS + 3], w_ref[STEPS + 3];
    struct plant p = {{0, 0}, 0}, p_ref = {{0, 0}, 0};
    double y = 0.3;
    configure(false);
    follow(0.3, 0.3, 0.4);
    for (unsigned t = 0; t < 3; t++) {
        y_ref[t] = w_ref[t] = 0.3;
        u_ref[t] = 0.4;
    }
    for (unsigned t = 3; t < STEPS + 3; t++) {
        w_ref[t] = t < 150 ? 0.4 : 0.25;
        u_ref[t] = u_ref[t - 1] + r0 * w_ref[t] - q[0] * y_ref[t - 1] - q[1] * y_ref[t - 2] -
                   q[2] * y_ref[t - 3];
        double u = stepped(w_ref[t], y);
        as_given();
        TEST_ASSERT_DOUBLE_WITHIN(20 * EXACT, u_ref[t], u);
        y_ref[t] = plant_step(&p_ref, u_ref[t]);
        y = plant_step(&p, u);
        TEST_ASSERT_DOUBLE_WITHIN(EXACT, y_ref[t], y);
    }
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 0.25, y);
}

static void coefficients_of_p_take_what_took_effect_before(void)
{
    settings.p[0] = 0.5f;
    settings.p[2] = -0.25f;
    configure(false);
    follow(0.5, 0.5, 0.5);
    double u[8] = {0.5, 0.5, 0.5, 0.5};
    for (unsigned t = 4; t < 8; t++) {
        double w = 0.5 + (t == 4 ? 0.01 : 0);
        double y = 0.5;
        /* P in K P u; R of one coefficient acts on w itself, so the error acts in each step. */
        u[t] = u[t - 1] - 0.5 * (u[t - 1] - u[t - 2]) + 0.25 * (u[t - 3] - u[t - 4]) + r0 * (w - y);
        TEST_ASSERT_DOUBLE_WITHIN(EXACT, u[t], stepped(w, y));
        u[t] -= 0.003; /* a valve that stays behind */
        told(u[t]);
    }
}

static void each_coefficient_meets_setpoints_and_measurements_of_its_own_age(void)
{
    static const double q_of[3] = {2, -1.2, 0.3}, r_of[3] = {3, -2.5, 0.6};
    static const double w[8] = {0.5, 0.5, 0.5, 0.52, 0.51, 0.53, 0.5, 0.49};
    static const double y[8] = {0.5, 0.5, 0.5, 0.5, 0.53, 0.52, 0.49, 0.51};
    for (unsigned k = 0; k < 3; k++) {
        settings.q[k] = (float)q_of[k];
        settings.r[k] = (float)r_of[k];
    }
    configure(false);
    follow(0.5, 0.5, 0.5);
    double u = 0.5;
    for (unsigned t = 3; t < 8; t++) {
        for (unsigned k = 0; k < 3; k++)
            u += r_of[k] * w[t - k] - q_of[k] * y[t - k];
        TEST_ASSERT_DOUBLE_WITHIN(EXACT, u, stepped(w[t], y[t]));
        as_given();
    }
}

static void where_setpoint_and_measurement_agree_nothing_moves(void)
{
    settings.q[0] = 900;
    settings.q[1] = -899.9f;
    settings.q[2] = 0;
    settings.r[0] = 800;
    settings.r[3] = -799.9f;
    configure(false);
    follow(0.37, 0.37, 0.61);
    for (unsigned t = 0; t < 1000; t++) {
        TEST_ASSERT_DOUBLE_WITHIN(6e-8, 0.61, stepped(0.37, 0.37));
        as_given();
    }
}

static void a_small_error_is_integrated_also_below_a_step_of_the_format(void)
{
    memset(settings.q, 0, sizeof settings.q);
    settings.q[0] = settings.r[0] = 1e-4f;
    configure(false);
    follow(0.5, 0.5, 0.5);
    for (unsigned t = 0; t < 10000; t++) {
        (void)stepped(0.5 + 1e-5, 0.5);
        as_given();
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5 + 10000 * 1e-9, stepped(0.5 + 1e-5, 0.5));
}

static void it_moves_against_a_measurement_below_its_setpoint_for_either_sign(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        take_controller();
        for (unsigned k = 0; k < 3; k++)
            settings.q[k] *= (float)sign;
        settings.r[0] *= (float)sign;
        configure(false);
        follow(0.5, 0.5, 0.5);
        double u = stepped(0.5, 0.48);
        TEST_ASSERT_TRUE(sign * (u - 0.5) > 0.1);
    }
}

/* ---- from and to manual ---- */

static void it_begins_where_the_output_is_whatever_the_error(void)
{
    configure(false);
    for (unsigned k = 0; k < 5; k++) {
        double w = 0.1 * k, y = 0.9 - 0.15 * k, u = 0.2 * k;
        follow(w, y, u);
        TEST_ASSERT_DOUBLE_WITHIN(EXACT, u, stepped(w, y));
        as_given();
        TEST_ASSERT_DOUBLE_WITHIN(EXACT, u + r0 * (w - y), stepped(w, y));
    }
}

static void other_settings_bump_nothing(void)
{
    configure(false);
    follow(0.5, 0.5, 0.5);
    (void)stepped(0.52, 0.5);
    as_given();
    double u = stepped(0.52, 0.505);
    as_given();
    /* What it would give next if nothing moved. */
    double next = u + r0 * 0.52 - (q[0] * 0.505 + q[1] * 0.505 + q[2] * 0.5);
    for (unsigned k = 0; k < 3; k++)
        settings.q[k] *= 0.4f;
    settings.r[0] *= 0.4f;
    settings.p[0] = 0.3f;
    configure(true);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, next, stepped(0.52, 0.505));
}

/* ---- at a limit ---- */

static void hours_at_a_limit_cost_nothing(void)
{
    struct plant p = {{0, 0}, 0};
    double y = 0.3;
    configure(false);
    follow(0.3, 0.3, 0.4);
    for (unsigned t = 0; t < 400; t++) { /* gain 1.25: not to be reached with an output of 1 */
        double u = fmin(1, fmax(0, stepped(1.2, y)));
        told(u);
        y = plant_step(&p, u);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.3 + 0.6 * 1.25, y);
    /* Off it in the first step with an error of the other sign. */
    double u = stepped(0.6, y);
    TEST_ASSERT_TRUE(u < 1);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT * 20, 1 + r0 * (0.6 - y), u);
}

static void what_it_drives_at_its_limit_stops_its_integral_in_that_direction_alone(void)
{
    configure(false);
    follow(0.5, 0.5, 0.5);
    (void)stepped(0.52, 0.5);
    clamp[0] = INTEGRAL_CLAMP_UP;
    as_given();
    /* Without its integral it is where it began. */
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 0.5 + r0 * 0.01, stepped(0.51, 0.5));
    clamp[0] = INTEGRAL_CLAMP_DOWN;
    as_given();
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 0.5 + r0 * 0.02, stepped(0.51, 0.5));
}

/* ---- refusals ---- */

static void assert_refused(const char *field)
{
    TEST_ASSERT_EQUAL(ERR_RANGE, rst_kind.check(&setup, &fault));
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_TRUE(strlen(fault.wanted) > 0);
}

static void what_cannot_be_right_is_refused(void)
{
    setup.members = 2;
    assert_refused("loops");
    setup.members = 1;
    setup.interval_s = 60;
    assert_refused("period");
    setup.interval_s = 120.2f;
    assert_refused("period");
    setup.interval_s = 120;
    settings.r[0] *= 1.01f;
    assert_refused("r");
    take_controller();
    memset(settings.q, 0, sizeof settings.q);
    assert_refused("q");
    settings.q[0] = 1000;
    settings.q[1] = -1000;
    assert_refused("q");
    settings.q[0] = NAN;
    assert_refused("q");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(closed_it_is_the_law_in_double);
    RUN_TEST(coefficients_of_p_take_what_took_effect_before);
    RUN_TEST(each_coefficient_meets_setpoints_and_measurements_of_its_own_age);
    RUN_TEST(where_setpoint_and_measurement_agree_nothing_moves);
    RUN_TEST(a_small_error_is_integrated_also_below_a_step_of_the_format);
    RUN_TEST(it_moves_against_a_measurement_below_its_setpoint_for_either_sign);
    RUN_TEST(it_begins_where_the_output_is_whatever_the_error);
    RUN_TEST(other_settings_bump_nothing);
    RUN_TEST(hours_at_a_limit_cost_nothing);
    RUN_TEST(what_it_drives_at_its_limit_stops_its_integral_in_that_direction_alone);
    RUN_TEST(what_cannot_be_right_is_refused);
    return UNITY_END();
}

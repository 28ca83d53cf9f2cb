/* The controller `state` (kinds/state/state_feedback.h). Contract, with a plant of three states, weights to 10 and signals within half a span: in 200
 * closed steps measurements are those of the law in double to 2e-5 of a span in both formats, outputs to 10 times that, which is what the largest weight
 * makes of a measurement's own rounding. */
#include <math.h>
#include <stdalign.h>
#include <string.h>

#include "formats.h"
#include "kinds/state/state_feedback.h"
#include "unity.h"

#define EXACT 2e-5
#define STEPS 200
#define POLE  0.7

static alignas(8) char state[4096];
static struct state_feedback_settings settings;
static struct block_setup setup;
static struct block_fault fault;
static num_t in[2], out[2], setpoint[2], input[4];
static uint8_t quality[4], clamp[2], limited[2];
static struct block_io io;

/* x' = A x + B u + E d, y the first two states. All three and d are inputs of the block. */
static const double a[3][3] = {{0.9, 0.05, 0.1}, {0.02, 0.85, -0.05}, {0.1, -0.1, 0.6}};
static const double b[3][2] = {{0.08, 0.03}, {0.02, 0.06}, {0.05, 0}};
static const double e[3] = {0.02, -0.01, 0.03};
static double f[2][3], g[2][2], tf[2];
static double x[3], d, w[2], sum[2];

/* B* = first rows of B: F = B*^-1 (0.7 C - C A), G = B*^-1 0.3, Tf = -B*^-1 C E. */
static void design(void)
{
    double det = b[0][0] * b[1][1] - b[0][1] * b[1][0];
    double inverse[2][2] = {{b[1][1] / det, -b[0][1] / det}, {-b[1][0] / det, b[0][0] / det}};
    for (int i = 0; i < 2; i++) {
        tf[i] = 0;
        for (int j = 0; j < 2; j++) {
            g[i][j] = inverse[i][j] * (1 - POLE);
            tf[i] -= inverse[i][j] * e[j];
        }
        for (int k = 0; k < 3; k++) {
            f[i][k] = 0;
            for (int j = 0; j < 2; j++)
                f[i][k] += inverse[i][j] * ((j == k ? POLE : 0) - a[j][k]);
        }
    }
}

void setUp(void)
{
    design();
    memset(&settings, 0, sizeof settings);
    for (unsigned i = 0; i < 2; i++) {
        for (unsigned k = 0; k < 3; k++)
            settings.f[i][k] = (float)f[i][k];
        settings.f[i][3] = (float)tf[i];
        for (unsigned j = 0; j < 2; j++)
            settings.g[i][j] = (float)g[i][j];
    }
    memset(&setup, 0, sizeof setup);
    setup.settings = &settings;
    setup.interval_s = 60;
    setup.members = 2;
    setup.present = 3;
    setup.inputs = 4;
    memset(clamp, INTEGRAL_FREE, sizeof clamp);
    memset(x, 0, sizeof x);
    memset(w, 0, sizeof w);
    memset(sum, 0, sizeof sum);
    d = 0;
    io = (struct block_io){.members.acting = 3,
                           .members.setpoint = setpoint,
                           .members.in = in,
                           .members.out = out,
                           .members.clamp = clamp,
                           .members.limited = limited,
                           .inputs.value = input,
                           .inputs.quality = quality,
                           .members.divisor = 1};
}
void tearDown(void) {}

static void see(void)
{
    for (unsigned k = 0; k < 3; k++)
        input[k] = N(x[k]);
    input[3] = N(d);
    for (unsigned i = 0; i < 2; i++) {
        in[i] = N(x[i]);
        setpoint[i] = N(w[i]);
    }
}

static void configure(bool retune)
{
    TEST_ASSERT_EQUAL(ERR_OK, state_feedback_kind.check(&setup, &fault));
    TEST_ASSERT_TRUE(state_feedback_kind.bytes(&setup) <= sizeof state);
    TEST_ASSERT_EQUAL(ERR_OK, state_feedback_kind.configure(state, &setup, retune));
}

static void begin_at(double first, double second)
{
    configure(false);
    see();
    out[0] = N(first);
    out[1] = N(second);
    state_feedback_kind.follow(state, &io);
}

static void move_plant(double first, double second)
{
    double next[3], u[2] = {first, second};
    for (int i = 0; i < 3; i++) {
        next[i] = e[i] * d;
        for (int k = 0; k < 3; k++)
            next[i] += a[i][k] * x[k];
        for (int j = 0; j < 2; j++)
            next[i] += b[i][j] * u[j];
    }
    memcpy(x, next, sizeof x);
}

/* A step whose outputs are limited to +-most. */
static void closed_step(double most)
{
    double u[2];
    see();
    state_feedback_kind.step(state, &io);
    for (unsigned i = 0; i < 2; i++) {
        u[i] = fmax(-most, fmin(most, D(out[i])));
        if (u[i] < D(out[i]) || u[i] > D(out[i]))
            out[i] = N(u[i]);
    }
    state_feedback_kind.back_calculate(state, &io);
    move_plant(u[0], u[1]);
}

/* ---- the law ---- */

static void each_output_follows_its_own_setpoint_with_its_pole_and_the_other_rests(void)
{
    double y = 0;
    begin_at(0, 0);
    w[0] = 0.2;
    for (unsigned t = 0; t < STEPS; t++) {
        closed_step(100);
        y = POLE * y + (1 - POLE) * w[0];
        TEST_ASSERT_DOUBLE_WITHIN(EXACT, y, x[0]);
        TEST_ASSERT_DOUBLE_WITHIN(EXACT, 0, x[1]);
    }
}

static void outputs_are_the_law_in_double(void)
{
    double y[3] = {0, 0, 0};
    begin_at(0, 0);
    for (unsigned t = 0; t < STEPS; t++) {
        w[0] = t < 100 ? 0.2 : -0.1;
        w[1] = t < 50 ? 0 : 0.3;
        double u[2];
        memcpy(y, x, sizeof y);
        for (int i = 0; i < 2; i++) {
            u[i] = tf[i] * d;
            for (int k = 0; k < 3; k++)
                u[i] += f[i][k] * y[k];
            for (int j = 0; j < 2; j++)
                u[i] += g[i][j] * w[j];
        }
        see();
        state_feedback_kind.step(state, &io);
        for (unsigned i = 0; i < 2; i++)
            TEST_ASSERT_DOUBLE_WITHIN(10 * EXACT, u[i], D(out[i]));
        state_feedback_kind.back_calculate(state, &io);
        move_plant(u[0], u[1]);
    }
}

static void a_measured_disturbance_moves_no_output(void)
{
    begin_at(0, 0);
    d = 0.3;
    for (unsigned t = 0; t < STEPS; t++) {
        closed_step(100);
        TEST_ASSERT_DOUBLE_WITHIN(EXACT, 0, x[0]);
        TEST_ASSERT_DOUBLE_WITHIN(EXACT, 0, x[1]);
    }
}

/* One that is not measured: F has no column for it. */
static void leave_out_feedforward(void)
{
    settings.f[0][3] = settings.f[1][3] = 0;
}

static void without_integral_an_unmeasured_disturbance_leaves_an_offset_with_it_none(void)
{
    leave_out_feedforward();
    begin_at(0, 0);
    d = 0.3;
    for (unsigned t = 0; t < STEPS; t++)
        closed_step(100);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, e[0] * d / (1 - POLE), x[0]);
    settings.ti_s[0] = settings.ti_s[1] = 600;
    configure(true);
    for (unsigned t = 0; t < STEPS; t++)
        closed_step(100);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, x[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, x[1]);
}

static void the_derivative_takes_from_a_setpoint_what_the_measurement_moves(void)
{
    settings.td_s[0] = 60; /* a step: D is the difference of two samples */
    begin_at(0, 0);
    w[0] = 0.2;
    closed_step(100);
    double moved = x[0], before = 0;
    see();
    state_feedback_kind.step(state, &io);
    double asked =
        g[0][0] * (w[0] - (moved - before)) + f[0][0] * x[0] + f[0][1] * x[1] + f[0][2] * x[2];
    TEST_ASSERT_DOUBLE_WITHIN(10 * EXACT, asked, D(out[0]));
}

/* ---- beginnings, new settings ---- */

static void whatever_the_error_the_first_output_is_the_one_in_effect(void)
{
    settings.ti_s[0] = settings.ti_s[1] = 600;
    settings.td_s[0] = settings.td_s[1] = 60; /* measurements have moved since the step before */
    x[0] = 0.1;
    x[1] = 0.05;
    x[2] = -0.2;
    d = 0.3;
    w[0] = 0.4;
    begin_at(0.25, -0.125);
    see();
    state_feedback_kind.step(state, &io);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, D(out[0]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.125, D(out[1]));
}

static void new_settings_bump_nothing(void)
{
    settings.ti_s[0] = 600;
    begin_at(0, 0);
    w[0] = 0.2;
    for (unsigned t = 0; t < 20; t++)
        closed_step(100);
    w[0] = x[0]; /* no error, so that the integral adds nothing */
    w[1] = x[1];
    see();
    state_feedback_kind.step(state, &io);
    double before[2] = {D(out[0]), D(out[1])};
    state_feedback_kind.back_calculate(state, &io);
    settings.f[0][0] *= 1.3f;
    settings.g[1][0] *= 0.5f;
    settings.ti_s[1] = 300;
    configure(true);
    state_feedback_kind.step(state, &io);
    TEST_ASSERT_DOUBLE_WITHIN(10 * EXACT, before[0], D(out[0]));
    TEST_ASSERT_DOUBLE_WITHIN(10 * EXACT, before[1], D(out[1]));
}

static void a_loop_by_hand_asks_for_nothing(void)
{
    begin_at(0, 0);
    io.members.acting = 1;
    state_feedback_kind.follow(state, &io);
    w[1] = 0.5;
    out[1] = N(0.125);
    see();
    state_feedback_kind.step(state, &io);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, D(out[0]));
    TEST_ASSERT_DOUBLE_WITHIN(0, 0.125, D(out[1])); /* is not its to give */
}

/* Outputs as given, then integrals. */
static double value_at(unsigned i)
{
    float value = 0;
    TEST_ASSERT_NOT_NULL(state_feedback_kind.describe(state, i, &value));
    return (double)value;
}

static double integral(unsigned k)
{
    return value_at(2 + k);
}

static void a_loop_that_goes_to_manual_forgets_its_integral_and_the_other_does_not(void)
{
    for (unsigned hand = 0; hand < 2; hand++) {
        unsigned other = 1 - hand;
        setUp();
        settings.ti_s[0] = settings.ti_s[1] = 600;
        begin_at(0, 0);
        w[0] = 0.2;
        w[1] = 0.1;
        for (unsigned t = 0; t < 5; t++)
            closed_step(100);
        double before = integral(other);
        TEST_ASSERT_TRUE(before > 0.005 && integral(hand) > 0.005);
        io.members.acting = (uint8_t)(1u << other);
        w[other] = x[other]; /* no error: the integral stands */
        see();
        out[hand] = N(0.125);
        state_feedback_kind.follow(state, &io);
        TEST_ASSERT_DOUBLE_WITHIN(0, 0.125, value_at(hand)); /* as given */
        state_feedback_kind.step(state, &io);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, before, integral(other));
        TEST_ASSERT_DOUBLE_WITHIN(0, 0, integral(hand));
    }
}

/* ---- limits ---- */

static void off_its_limit_an_output_moves_in_the_first_step_of_the_other_sign(void)
{
    settings.ti_s[0] = settings.ti_s[1] = 600;
    begin_at(0, 0);
    w[0] = 0.4;
    for (unsigned t = 0; t < STEPS; t++)
        closed_step(0.3);
    TEST_ASSERT_TRUE(x[0] < 0.39); /* cannot come there */
    w[0] = x[0] - 0.05;
    see();
    state_feedback_kind.step(state, &io);
    TEST_ASSERT_TRUE(D(out[0]) < 0.3);
}

static void while_one_output_is_at_its_limit_the_other_loop_keeps_its_setpoint(void)
{
    settings.ti_s[0] = settings.ti_s[1] = 600;
    begin_at(0, 0);
    w[0] = 0.4;
    w[1] = 0.05;
    for (unsigned t = 0; t < 3 * STEPS; t++) {
        see();
        state_feedback_kind.step(state, &io);
        double u[2] = {fmin(0.2, D(out[0])), D(out[1])};
        if (u[0] < D(out[0]))
            out[0] = N(u[0]);
        state_feedback_kind.back_calculate(state, &io);
        move_plant(u[0], u[1]);
    }
    TEST_ASSERT_TRUE(x[0] < 0.35);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.05, x[1]);
}

static void an_integral_that_may_not_rise_stands(void)
{
    leave_out_feedforward();
    settings.ti_s[0] = 600;
    begin_at(0, 0);
    w[0] = 0.2;
    clamp[0] = INTEGRAL_CLAMP_UP;
    see();
    float value;
    for (unsigned t = 0; t < 20; t++) {
        state_feedback_kind.step(state, &io);
        state_feedback_kind.back_calculate(state, &io);
    }
    (void)state_feedback_kind.describe(state, 2, &value);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, (double)value);
}

static void inner_values_are_what_it_gives_and_then_its_integrals(void)
{
    static const char *const names[] = {"given_1", "given_2", "integral_1", "integral_2"};
    float value;
    begin_at(0.3, -0.2);
    for (size_t i = 0; i < 4; i++)
        TEST_ASSERT_EQUAL_STRING(names[i], state_feedback_kind.describe(state, i, &value));
    TEST_ASSERT_NULL(state_feedback_kind.describe(state, 4, &value));
    (void)state_feedback_kind.describe(state, 1, &value);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, -0.2, (double)value);
}

/* ---- what is refused ---- */

static void refused(const char *field)
{
    TEST_ASSERT_NOT_EQUAL(ERR_OK, state_feedback_kind.check(&setup, &fault));
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
}

static void settings_that_fit_nothing_are_refused_by_their_name(void)
{
    setup.members = 5;
    refused("loops");
    setup.members = 2;
    setup.inputs = 0;
    refused("inputs");
    setup.inputs = 3;
    refused("f"); /* a fourth column */
    setup.inputs = 4;
    settings.g[0][2] = 1;
    refused("g");
    settings.g[0][2] = 0;
    settings.g[1][0] = settings.g[1][1] = 0;
    refused("g");
    settings.g[1][1] = 1;
    settings.f[0][0] = settings.f[0][1] = 9000;
    refused("f");
    settings.f[0][0] = settings.f[0][1] = 0;
    settings.f[3][0] = 1;
    refused("loops");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(each_output_follows_its_own_setpoint_with_its_pole_and_the_other_rests);
    RUN_TEST(outputs_are_the_law_in_double);
    RUN_TEST(a_measured_disturbance_moves_no_output);
    RUN_TEST(without_integral_an_unmeasured_disturbance_leaves_an_offset_with_it_none);
    RUN_TEST(the_derivative_takes_from_a_setpoint_what_the_measurement_moves);
    RUN_TEST(whatever_the_error_the_first_output_is_the_one_in_effect);
    RUN_TEST(new_settings_bump_nothing);
    RUN_TEST(a_loop_by_hand_asks_for_nothing);
    RUN_TEST(a_loop_that_goes_to_manual_forgets_its_integral_and_the_other_does_not);
    RUN_TEST(off_its_limit_an_output_moves_in_the_first_step_of_the_other_sign);
    RUN_TEST(while_one_output_is_at_its_limit_the_other_loop_keeps_its_setpoint);
    RUN_TEST(an_integral_that_may_not_rise_stands);
    RUN_TEST(inner_values_are_what_it_gives_and_then_its_integrals);
    RUN_TEST(settings_that_fit_nothing_are_refused_by_their_name);
    return UNITY_END();
}

/* The kinds `polynomial` and `rst` in the tick: what a controller asks for, limits, who comes and goes. */
#include "kinds/decoupler/decoupler.h"
#include "kinds/feedforward/feedforward.h"
#include "kinds/pid/pid.h"
#include "kinds/polynomial/polynomial.h"
#include "kinds/rst/rst.h"
#include "kinds/two_position/two_position.h"
#include "put_block.h"
#include "supervisor_bench.h"

const struct block_kind *const block_kinds[] = {
    &pid_kind, &polynomial_kind, &rst_kind, &decoupler_kind, &feedforward_kind, &two_position_kind,
};
const uint8_t block_kind_count = sizeof block_kinds / sizeof block_kinds[0];

/* Move of a loop's own output in a tick, by integration. */
#define OWN_MOVE 1.5e-4

static struct polynomial_settings polynomial = {
    .g = {{0.9f, 0.1f}, {0.5f, -0.1f}, {-0.3f, 0.05f}, {1.2f, -0.2f}}};
static struct rst_settings rst = {
    .period_s = 1, .p = {-0.4f}, .q = {-3, 2.95f}, .r = {-1, 0.95f}}; /* top is of direct action */

void setUp(void) {}
void tearDown(void) {}

static void put_record(unsigned n, const void *settings, size_t size)
{
    memcpy(bench.config.pool + bench.config.block[n].offset, settings, size);
}

static void compensated(void)
{
    put_block(0, "polynomial", "top bottom", "", "");
    put_record(0, &polynomial, sizeof polynomial);
}

static void with_rst(void)
{
    put_block(0, "rst", "top", "", "");
    put_record(0, &rst, sizeof rst);
}

static void both_auto(void)
{
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
}

static void a_controller_moves_both_mvs_now_and_a_sample_later(void)
{
    bench_start_with(compensated);
    both_auto();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, 0.5, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, 0.5, sent(HEAT));
    reading(T10, 114); /* a step of 0.015 of bottom's output */
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, 0.5 + 1.2 * 0.015, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, 0.5 + 0.5 * 0.015, sent(REFLUX));
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(2 * OWN_MOVE, 0.5 + 1.0 * 0.015, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(2 * OWN_MOVE, 0.5 + 0.4 * 0.015, sent(REFLUX));
}

static void a_member_that_leaves_and_comes_back_moves_nobodys_output(void)
{
    bench_start_with(compensated);
    both_auto();
    reading(T10, 114.3);
    reading(T1, 85.2);
    ticks(20);
    double heat = sent(HEAT), reflux = sent(REFLUX);
    mode(TOP, LOOP_MANUAL);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(2 * OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, reflux, sent(REFLUX));
    ticks(10);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, reflux, sent(REFLUX));
    heat = sent(HEAT);
    mode(TOP, LOOP_AUTO);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(2 * OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(2 * OWN_MOVE, reflux, sent(REFLUX));
}

/* An hour at a limit: where its measurement comes to its setpoint the MV leaves the limit within seconds. */
static void an_mv_at_its_limit_winds_nothing_up(void)
{
    for (unsigned limits = 0; limits < 2; limits++) {
        polynomial.limits = (uint8_t)limits;
        bench_start_with(compensated);
        both_auto();
        reading(T10, 105);
        ticks(3600);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, sent(HEAT));
        reading(T10, 117);
        ticks(3);
        TEST_ASSERT_TRUE(sent(HEAT) < 0.999);
        ticks(30);
        TEST_ASSERT_TRUE(sent(HEAT) < 0.99);
    }
    polynomial.limits = POLYNOMIAL_RECURSE;
}

static void other_coefficients_move_no_mv(void)
{
    bench_start_with(compensated);
    both_auto();
    reading(T10, 114.3);
    ticks(20);
    double heat = sent(HEAT), reflux = sent(REFLUX);
    struct polynomial_settings other = polynomial;
    other.g[1][0] = -0.2f;
    other.g[3][0] = 1.6f;
    put_record(0, &other, sizeof other);
    apply();
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(2 * OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(2 * OWN_MOVE, reflux, sent(REFLUX));
}

/* ---- rst ---- */

static void rst_begins_without_a_bump_and_moves_against_its_error(void)
{
    bench_start_with(with_rst);
    mode(TOP, LOOP_AUTO);
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, 0.5, sent(REFLUX));
    double t1 = bench.input.measurement[T1].value;
    reading(T1, t1 + 1); /* 0.01 of its span: above its setpoint, more reflux */
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, 0.5 + 3 * 0.01, sent(REFLUX));
    ticks(100);
    TEST_ASSERT_TRUE(sent(REFLUX) > 0.53 + 0.5 * 100 * 0.05 * 0.01);
}

static void rst_leaves_a_limit_at_once_and_hands_over_without_a_bump(void)
{
    bench_start_with(with_rst);
    mode(TOP, LOOP_AUTO);
    ticks(3);
    double t1 = bench.input.measurement[T1].value;
    reading(T1, t1 + 20);
    ticks(3600);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, sent(REFLUX));
    reading(T1, t1 - 1);
    tick();
    TEST_ASSERT_TRUE(sent(REFLUX) < 0.9);
    ticks(5);
    double reflux = sent(REFLUX);
    mode(TOP, LOOP_MANUAL);
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, reflux, sent(REFLUX));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_controller_moves_both_mvs_now_and_a_sample_later);
    RUN_TEST(a_member_that_leaves_and_comes_back_moves_nobodys_output);
    RUN_TEST(an_mv_at_its_limit_winds_nothing_up);
    RUN_TEST(other_coefficients_move_no_mv);
    RUN_TEST(rst_begins_without_a_bump_and_moves_against_its_error);
    RUN_TEST(rst_leaves_a_limit_at_once_and_hands_over_without_a_bump);
    return UNITY_END();
}

/* Loops that act on an estimate: how long they do while it is uncertain, and what the loop below does when it is lost. The estimator is of
 * this test alone: its point is its input, as good as the test says. */
#include "block/block.h"
#include "exchange/block_settings.h"
#include "kinds/pid/pid.h"
#include "settings/block_pool.h"
#include "supervisor_bench.h"

struct echo_settings {
    float number;
    struct block_return back[1];
};

static enum quality says;

static const struct block_parameter echo_parameters[] = {
    {.id = 1, .type = BLOCK_FLOAT, .name = "number", .unit = "-", .help = "none", .hi = 1},
};

static uint32_t echo_bytes(const struct block_setup *setup)
{
    (void)setup;
    return 8;
}

static enum err echo_check(const struct block_setup *setup, struct block_fault *fault)
{
    (void)setup;
    (void)fault;
    return ERR_OK;
}

static enum err echo_configure(void *state, const struct block_setup *setup, bool retune)
{
    (void)state;
    (void)setup;
    (void)retune;
    return ERR_OK;
}

static void echo_step(void *state, struct block_io *io)
{
    (void)state;
    io->points.value[0] = io->inputs.value[0];
    io->points.quality[0] = (uint8_t)says;
}

static const struct block_kind echo_kind = {
    .name = "echo",
    .stage = STAGE_ESTIMATE,
    .parameter = echo_parameters,
    .parameters = 1,
    .settings_bytes = sizeof(struct echo_settings),
    .returns = offsetof(struct echo_settings, back),
    .inputs_most = 1,
    .points_most = 1,
    .bytes = echo_bytes,
    .check = echo_check,
    .configure = echo_configure,
    .step = echo_step,
};

const struct block_kind *const block_kinds[] = {&pid_kind, &echo_kind};
const uint8_t block_kind_count = 2;

enum { GUESS = 4 };
#define HOLD_S 20

static void put_return(float setpoint, float within)
{
    struct echo_settings settings = {.back = {{setpoint, within}}};
    memcpy(bench.config.pool + bench.config.block[0].offset, &settings, sizeof settings);
}

/* `outer` acts on guess, an estimate from T5, and drives the setpoint of `bottom`. */
static void observed(void)
{
    uint32_t needed, room;
    bench_cascade();
    put_all((const char *const[]){"meas5.name", "guess", "meas5.unit", "degC", "meas5.lo", "60",
                                  "meas5.hi", "160", "meas5.hold", "20", "loop3.pv", "guess",
                                  "loop4.name", "-", "loop4.pv", "-", "loop4.out", "-", NULL});
    TEST_ASSERT_EQUAL(ERR_OK, record_make(&bench.config, 0, "echo", &needed, &room));
    strcpy(bench.config.block[0].inputs, "T5");
    strcpy(bench.config.block[0].points, "guess");
}

static void begin_cascade(void)
{
    mode(BOTTOM, LOOP_AUTO);
    setpoint(BOTTOM, 112);
    tick();
    mode(BOTTOM, LOOP_CASCADE);
    mode(OUTER, LOOP_AUTO);
    ticks(3);
}

void setUp(void)
{
    says = QUALITY_GOOD;
    bench_start_with(observed);
    begin_cascade();
    bench_forget_events();
}
void tearDown(void) {}

static double bottom_setpoint(void)
{
    return 60 + 100 * setpoint_of(BOTTOM);
}

/* The estimate is wrong and moves the setpoint below; then its block says so. */
static void run_astray(enum quality then)
{
    reading(T5, 80);
    ticks(60);
    TEST_ASSERT_TRUE(bottom_setpoint() > 125);
    says = then;
    reading(T5, 70);
}

static void a_loop_acts_on_an_uncertain_estimate_no_longer_than_its_hold(void)
{
    says = QUALITY_UNCERTAIN;
    ticks(HOLD_S);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[OUTER].mode);
    tick();
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[OUTER].mode);
    TEST_ASSERT_EQUAL(1, happened(EVENT_DOUBTFUL, "guess"));
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, bench.s.measurement[GUESS].quality);
    ticks(5);
    TEST_ASSERT_EQUAL(1, happened(EVENT_DOUBTFUL, "guess"));
}

static void a_good_estimate_in_between_begins_the_hold_anew(void)
{
    for (int k = 0; k < 3; k++) {
        says = QUALITY_UNCERTAIN;
        ticks(HOLD_S);
        says = QUALITY_GOOD;
        tick();
    }
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[OUTER].mode);
}

static void no_loop_begins_on_an_estimate_that_has_long_been_uncertain(void)
{
    mode(OUTER, LOOP_MANUAL);
    says = QUALITY_UNCERTAIN;
    ticks(HOLD_S + 1);
    mode(OUTER, LOOP_AUTO);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[OUTER].mode);
    TEST_ASSERT_EQUAL(1, happened(EVENT_MODE_REFUSED, "outer"));
    says = QUALITY_GOOD;
    tick();
    mode(OUTER, LOOP_AUTO);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[OUTER].mode);
}

static void a_reading_of_the_plant_may_be_uncertain_for_longer(void)
{
    mode(TOP, LOOP_AUTO);
    bad_reading(T1, QUALITY_UNCERTAIN, 85);
    ticks(200);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
}

static void with_a_stand_in_the_loop_goes_on_beyond_the_hold(void)
{
    put_all((const char *const[]){"meas5.infer", "heat", "meas5.infer_offset", "95", NULL});
    apply();
    says = QUALITY_UNCERTAIN;
    ticks(3 * HOLD_S);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[OUTER].mode);
    TEST_ASSERT_TRUE(bench.s.measurement[GUESS].inferred);
    says = QUALITY_GOOD;
    tick();
    TEST_ASSERT_FALSE(bench.s.measurement[GUESS].inferred);
}

static void with_a_substitute_the_loop_goes_on_with_that(void)
{
    put_all((const char *const[]){"meas5.fallback", "substitute", "meas5.substitute", "95", NULL});
    apply();
    says = QUALITY_UNCERTAIN;
    ticks(HOLD_S + 1);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[OUTER].mode);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.35, D(bench.s.measurement[GUESS].value));
}

static void the_setpoint_below_returns_to_the_configured_one(void)
{
    static const enum quality ways[] = {QUALITY_BAD, QUALITY_UNCERTAIN};
    for (unsigned k = 0; k < 2; k++) {
        setUp();
        put_return(110, 0);
        apply();
        run_astray(ways[k]);
        ticks(HOLD_S + 2);
        TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[OUTER].mode);
        TEST_ASSERT_EQUAL(LOOP_CASCADE, bench.s.loop[BOTTOM].mode);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 110, bottom_setpoint());
        ticks(50);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 110, bottom_setpoint());
    }
}

static void without_a_configured_one_it_returns_to_that_of_before_the_cascade(void)
{
    run_astray(QUALITY_BAD);
    ticks(HOLD_S + 2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 112, bottom_setpoint());
}

static void new_settings_do_not_change_where_it_returns_to(void)
{
    reading(T5, 80);
    ticks(60);
    set_and_apply("loop3.gain", "0.7");
    run_astray(QUALITY_BAD);
    ticks(HOLD_S + 2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 112, bottom_setpoint());
}

static void the_setpoint_limits_hold_for_the_return_too(void)
{
    put_return(110, 0);
    put_all((const char *const[]){"loop2.sp_lo", "115", "loop2.sp_hi", "140", NULL});
    apply();
    run_astray(QUALITY_BAD);
    ticks(HOLD_S + 2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 115, bottom_setpoint());
}

static void while_the_estimate_is_not_good_the_setpoint_stays_near_the_last_good_one(void)
{
    put_return(110, 0.5f);
    apply();
    reading(T5, 98);
    ticks(10);
    double good = bottom_setpoint();
    says = QUALITY_UNCERTAIN;
    reading(T5, 70);
    ticks(HOLD_S);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, good + 0.5, bottom_setpoint());
    says = QUALITY_GOOD;
    reading(T5, 120); /* it has not wound up meanwhile */
    ticks(2);
    TEST_ASSERT_TRUE(bottom_setpoint() < good);
}

static void an_outer_loop_that_the_operator_has_in_manual_stays_where_he_has_it(void)
{
    mode(OUTER, LOOP_MANUAL);
    out(OUTER, 120);
    says = QUALITY_BAD;
    ticks(3 * HOLD_S);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 120, bottom_setpoint());
}

static void when_the_estimate_is_back_the_outer_loop_goes_on_without_a_bump(void)
{
    put_return(110, 0);
    apply();
    run_astray(QUALITY_BAD);
    ticks(HOLD_S + 5);
    says = QUALITY_GOOD;
    reading(T5, 97);
    tick();
    mode(OUTER, LOOP_AUTO);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 110, bottom_setpoint());
}

static void out_of_cascade_the_setpoint_stays_where_it_is(void)
{
    run_astray(QUALITY_GOOD);
    double before = bottom_setpoint();
    mode(BOTTOM, LOOP_AUTO);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, before, bottom_setpoint());
    says = QUALITY_BAD;
    ticks(HOLD_S + 5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, before, bottom_setpoint());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_loop_acts_on_an_uncertain_estimate_no_longer_than_its_hold);
    RUN_TEST(a_good_estimate_in_between_begins_the_hold_anew);
    RUN_TEST(no_loop_begins_on_an_estimate_that_has_long_been_uncertain);
    RUN_TEST(a_reading_of_the_plant_may_be_uncertain_for_longer);
    RUN_TEST(with_a_stand_in_the_loop_goes_on_beyond_the_hold);
    RUN_TEST(with_a_substitute_the_loop_goes_on_with_that);
    RUN_TEST(the_setpoint_below_returns_to_the_configured_one);
    RUN_TEST(without_a_configured_one_it_returns_to_that_of_before_the_cascade);
    RUN_TEST(new_settings_do_not_change_where_it_returns_to);
    RUN_TEST(the_setpoint_limits_hold_for_the_return_too);
    RUN_TEST(while_the_estimate_is_not_good_the_setpoint_stays_near_the_last_good_one);
    RUN_TEST(an_outer_loop_that_the_operator_has_in_manual_stays_where_he_has_it);
    RUN_TEST(when_the_estimate_is_back_the_outer_loop_goes_on_without_a_bump);
    RUN_TEST(out_of_cascade_the_setpoint_stays_where_it_is);
    return UNITY_END();
}

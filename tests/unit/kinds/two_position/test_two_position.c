/* kinds/two_position/two_position.[ch], alone and as the law of a loop. */
#include "kinds/two_position/two_position.h"
#include "plan/plan_build.h"
#include "supervisor_bench.h"

static struct two_position block;

static const struct two_position_config plain = {
    .band = 0.05f, .out_lo = 0.1f, .out_hi = 0.6f, .direct = true};

void setUp(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, two_position_init(&block, &plain));
}
void tearDown(void) {}

#define ASSERT_OUT(x, measurement)                                                                 \
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, x, D(two_position_step(&block, N(0.5), N(measurement))))

static void it_switches_outside_the_band_and_keeps_inside(void)
{
    ASSERT_OUT(0.1, 0.54);
    ASSERT_OUT(0.6, 0.56);
    ASSERT_OUT(0.6, 0.51);
    ASSERT_OUT(0.6, 0.46);
    ASSERT_OUT(0.1, 0.44);
    ASSERT_OUT(0.1, 0.54);
}

static void reverse_acting_it_is_the_other_way_round(void)
{
    struct two_position_config c = plain;
    c.direct = false;
    TEST_ASSERT_EQUAL(ERR_OK, two_position_init(&block, &c));
    ASSERT_OUT(0.6, 0.44);
    ASSERT_OUT(0.6, 0.54);
    ASSERT_OUT(0.1, 0.56);
}

static void an_output_it_finds_stays_until_the_band_is_left(void)
{
    two_position_follow(&block, N(0.37));
    ASSERT_OUT(0.37, 0.52);
    ASSERT_OUT(0.37, 0.47);
    ASSERT_OUT(0.1, 0.42);
}

static void new_positions_take_along_an_output_that_was_at_one(void)
{
    struct two_position_config c = plain;
    c.out_hi = 0.8f;
    ASSERT_OUT(0.6, 0.7);
    TEST_ASSERT_EQUAL(ERR_OK, two_position_retune(&block, &c));
    ASSERT_OUT(0.8, 0.5);
    two_position_follow(&block, N(0.37));
    TEST_ASSERT_EQUAL(ERR_OK, two_position_retune(&block, &plain));
    ASSERT_OUT(0.37, 0.5);
}

static void every_field_is_taken_at_its_ends(void)
{
    static const float ends[][3] = {
        {1e-6f, -100.0f, 100.0f}, {10.0f, 99.0f, 100.0f}, {0.1f, -100.0f, -99.0f}};
    for (unsigned i = 0; i < sizeof ends / sizeof ends[0]; i++) {
        struct two_position_config c = {ends[i][0], ends[i][1], ends[i][2], true};
        TEST_ASSERT_EQUAL(ERR_OK, two_position_validate(&c, NULL, NULL));
    }
}

static void at_the_very_edge_of_its_band_it_stays(void)
{
    const struct two_position_config c = {
        .band = 0.125f, .out_lo = 0.25f, .out_hi = 0.75f, .direct = true};
    TEST_ASSERT_EQUAL(ERR_OK, two_position_init(&block, &c));
    ASSERT_OUT(0.25, 0.625);
    ASSERT_OUT(0.75, 0.6251);
    ASSERT_OUT(0.75, 0.375);
    ASSERT_OUT(0.25, 0.3749);
}

static void every_field_is_refused_beyond_its_ends_by_name(void)
{
    static const struct {
        const char *field;
        float band, lo, hi;
        enum err err;
    } wrong[] = {
        {"band", 0.0f, 0.1f, 0.6f, ERR_RANGE},       {"band", -0.1f, 0.1f, 0.6f, ERR_RANGE},
        {"band", 11.0f, 0.1f, 0.6f, ERR_RANGE},      {"band", NAN, 0.1f, 0.6f, ERR_NOT_FINITE},
        {"out_lo", 0.1f, 0.6f, 0.6f, ERR_RANGE},     {"out_lo", 0.1f, -101.0f, 0.6f, ERR_RANGE},
        {"out_lo", 0.1f, NAN, 0.6f, ERR_NOT_FINITE}, {"out_hi", 0.1f, 0.1f, 101.0f, ERR_RANGE},
        {"out_hi", 0.1f, 0.1f, NAN, ERR_NOT_FINITE},
    };
    struct two_position before = block;
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        struct two_position_config c = {wrong[i].band, wrong[i].lo, wrong[i].hi, true};
        const char *field, *wanted;
        TEST_ASSERT_EQUAL(wrong[i].err, two_position_validate(&c, &field, &wanted));
        TEST_ASSERT_EQUAL_STRING(wrong[i].field, field);
        TEST_ASSERT_EQUAL(wrong[i].err, two_position_init(&block, &c));
        TEST_ASSERT_EQUAL(wrong[i].err, two_position_retune(&block, &c));
    }
    TEST_ASSERT_EQUAL_MEMORY(&before, &block, sizeof block);
}

static void it_says_what_it_holds(void)
{
    static const char *const names[] = {"output", "low", "high", "band"};
    static const double values[] = {0.1, 0.1, 0.6, 0.05};
    float value;
    for (unsigned i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL_STRING(names[i], two_position_kind.describe(&block, i, &value));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, values[i], (double)value);
    }
    TEST_ASSERT_NULL(two_position_kind.describe(&block, 4, &value));
}

static void through_its_table_it_does_the_same(void)
{
    num_t r = N(0.5), y = N(0.7), u = N(0);
    uint8_t clamp = INTEGRAL_FREE, limited = INTEGRAL_FREE;
    struct block_io io = {.members.acting = 1,
                          .members.setpoint = &r,
                          .members.in = &y,
                          .members.out = &u,
                          .members.clamp = &clamp,
                          .members.limited = &limited};
    two_position_kind.step(&block, &io);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, D(u));
    u = N(0.2);
    two_position_kind.back_calculate(&block, &io); /* a slow valve changes nothing in it */
    ASSERT_OUT(0.6, 0.5);
    two_position_kind.follow(&block, &io);
    ASSERT_OUT(0.2, 0.5);
}

/* ---- as a loop ---- */

static void two_positions(void)
{
    put_all((const char *const[]){"loop2.algorithm", "two_position", "loop2.band", "3",
                                  "loop2.out_lo", "0.2", "loop2.out_hi", "0.9", NULL});
}

static void a_loop_switches_by_its_band_in_engineering_units(void)
{
    bench_start_with(two_positions);
    mode(BOTTOM, LOOP_AUTO);
    setpoint(BOTTOM, 110);
    reading(T10, 112.5);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(BUMP, 0.5, sent(HEAT)); /* found there: no bump */
    reading(T10, 113.5);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.2, sent(HEAT));
    reading(T10, 107.5);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.2, sent(HEAT));
    reading(T10, 106.5);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.9, sent(HEAT));
}

static void a_rate_limit_on_the_way_does_not_stop_it_half_way(void)
{
    bench_start_with(two_positions);
    set_and_apply("mv2.rate", "0.1");
    mode(BOTTOM, LOOP_AUTO);
    setpoint(BOTTOM, 110);
    reading(T10, 100);
    tick();
    reading(T10, 110);
    ticks(20);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.9, sent(HEAT));
}

static void an_interlock_releases_it_where_it_stands(void)
{
    bench_start_with(two_positions);
    put_all(
        (const char *const[]){"lock1.meas", "T5", "lock1.mv", "heat", "lock1.limit", "140", NULL});
    apply();
    mode(BOTTOM, LOOP_AUTO);
    setpoint(BOTTOM, 110);
    reading(T10, 100);
    tick();
    reading(T5, 150);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
    reading(T10, 110);
    reading(T5, 100);
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
    reading(T10, 106);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.9, sent(HEAT));
}

static void it_drives_an_inner_loop_in_cascade(void)
{
    bench_start_with(bench_cascade);
    put_all((const char *const[]){"loop3.algorithm", "two_position", "loop3.band", "2",
                                  "loop3.out_lo", "0.3", "loop3.out_hi", "0.7", NULL});
    apply();
    mode(BOTTOM, LOOP_AUTO);
    mode(OUTER, LOOP_AUTO);
    tick();
    mode(BOTTOM, LOOP_CASCADE);
    setpoint(OUTER, 100);
    reading(T5, 97);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.7, setpoint_of(BOTTOM));
    reading(T5, 103);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.3, setpoint_of(BOTTOM));
}

static void another_law_is_another_loop_and_starts_in_manual(void)
{
    bench_start();
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
    double before = sent(HEAT);
    two_positions();
    apply();
    tick();
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
    ASSERT_NO_BUMP(before, sent(HEAT));
    bench_config();
    mode(BOTTOM, LOOP_AUTO);
    apply();
    tick();
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
}

static void a_plan_refuses_what_two_positions_cannot_do(void)
{
    static const char *const wrong[][3] = {{"loop2.band", "0", "band"},
                                           {"loop2.out_hi", "0.2", "out_lo"},
                                           {"loop2.decouple", "on", "decouple"}};
    for (unsigned i = 0; i < 3; i++) {
        struct config_fault fault;
        bench_start_with(two_positions);
        put(wrong[i][0], wrong[i][1]);
        TEST_ASSERT_TRUE(plan_build(&bench.plan[1 - bench.current], &bench.config, 1.0f, &fault));
        TEST_ASSERT_EQUAL_STRING("loop", fault.group);
        TEST_ASSERT_EQUAL(2, fault.index);
        TEST_ASSERT_EQUAL_STRING(wrong[i][2], fault.field);
    }
}

static void its_check_names_the_one_member_that_it_has(void)
{
    struct loop_settings settings = {.band = 0, .out_lo = 0.1f, .out_hi = 0.6f};
    struct block_setup setup = {.settings = &settings, .members = 1, .member = {{.pv_span = 100}}};
    struct block_fault fault = {.member = 7};
    TEST_ASSERT_EQUAL(ERR_RANGE, two_position_kind.check(&setup, &fault));
    TEST_ASSERT_EQUAL_STRING("band", fault.field);
    TEST_ASSERT_EQUAL_UINT8(0, fault.member);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_switches_outside_the_band_and_keeps_inside);
    RUN_TEST(reverse_acting_it_is_the_other_way_round);
    RUN_TEST(an_output_it_finds_stays_until_the_band_is_left);
    RUN_TEST(new_positions_take_along_an_output_that_was_at_one);
    RUN_TEST(every_field_is_taken_at_its_ends);
    RUN_TEST(at_the_very_edge_of_its_band_it_stays);
    RUN_TEST(every_field_is_refused_beyond_its_ends_by_name);
    RUN_TEST(it_says_what_it_holds);
    RUN_TEST(through_its_table_it_does_the_same);
    RUN_TEST(a_loop_switches_by_its_band_in_engineering_units);
    RUN_TEST(a_rate_limit_on_the_way_does_not_stop_it_half_way);
    RUN_TEST(an_interlock_releases_it_where_it_stands);
    RUN_TEST(it_drives_an_inner_loop_in_cascade);
    RUN_TEST(another_law_is_another_loop_and_starts_in_manual);
    RUN_TEST(a_plan_refuses_what_two_positions_cannot_do);
    RUN_TEST(its_check_names_the_one_member_that_it_has);
    return UNITY_END();
}

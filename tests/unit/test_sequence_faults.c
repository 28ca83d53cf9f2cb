/* Sequences when something goes wrong: what holds one, what ends one, and that no step goes on by a reading that is
 * not valid. */
#include "exchange/sequence_rows.h"
#include "random_source.h"
#include "sequence_bench.h"

void setUp(void)
{
    start_bench_with(NULL);
}
void tearDown(void) {}

/* ---- readings ---- */

static void no_step_goes_on_by_a_reading_that_is_not_valid(void)
{
    static const struct {
        enum quality quality;
        double value;
    } bad[] = {
        {QUALITY_BAD, 35},  {QUALITY_MISSING, 35},    {QUALITY_GOOD, NAN},
        {QUALITY_GOOD, 99}, {QUALITY_GOOD, INFINITY},
    };
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        start_bench_with(NULL);
        started_at(ROW_FILL);
        tank.level_mine = true;
        for (unsigned n = 0; n < 9; n++) { /* held at what it was meanwhile */
            bad_reading(LEVEL, bad[i].quality, bad[i].value);
            tank_tick();
        }
        TEST_ASSERT_EQUAL(ROW_FILL, seq_state()->step);
        TEST_ASSERT_EQUAL(SEQUENCE_RUNNING, seq_state()->state);
        tank_ticks(5); /* lost: longer than its hold */
        TEST_ASSERT_EQUAL(SEQUENCE_HELD, seq_state()->state);
        TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_HELD, SEQUENCE_NO_READING));
        TEST_ASSERT_EQUAL_STRING("level", seq_state()->about);
    }
}

static void nor_by_a_value_that_stands_in_for_it(void)
{
    static const char *const ways[][2] = {{"substitute", "35"}, {"hold", "0"}};
    for (unsigned i = 0; i < 2; i++) {
        start_bench_with(NULL);
        put("meas5.fallback", ways[i][0]);
        put("meas5.substitute", ways[i][1]);
        put("meas5.hold", "2");
        put("meas5.infer", i ? "inlet" : "-"); /* 50: above the limit */
        apply();
        started_at(ROW_FILL);
        tank.level_mine = true;
        bad_reading(LEVEL, QUALITY_MISSING, 0);
        tank_ticks(100);
        TEST_ASSERT_EQUAL(ROW_FILL, seq_state()->step);
        TEST_ASSERT_EQUAL(SEQUENCE_HELD, seq_state()->state);
    }
}

static void time_without_a_valid_reading_does_not_count(void)
{
    tank.flow_mine = true;
    reading(FLOW, 40);
    seq(SEQUENCE_DO_START);
    tank_ticks(4); /* 3 s */
    bad_reading(FLOW, QUALITY_BAD, 40);
    tank_ticks(6);
    TEST_ASSERT_EQUAL(3000, seq_state()->met_ms);
    reading(FLOW, 40);
    tank_tick();
    TEST_ASSERT_EQUAL(ROW_COOL, seq_state()->step);
    tank_tick();
    TEST_ASSERT_EQUAL(ROW_FILL, seq_state()->step);
}

static void a_long_gap_between_samples_counts_as_one_tick(void)
{
    tank.flow_mine = true;
    reading(FLOW, 40);
    seq(SEQUENCE_DO_START);
    tank_ticks(2);
    bench.input.time_ms += 4000; /* four samples missing */
    tank_tick();
    TEST_ASSERT_EQUAL(ROW_COOL, seq_state()->step);
    TEST_ASSERT_EQUAL(2000, seq_state()->met_ms);
}

static void the_time_out_runs_on_while_a_fault_holds_it(void)
{
    started_at(ROW_FILL);
    tank.level_mine = true;
    bad_reading(LEVEL, QUALITY_BAD, 0);
    tank_ticks(290);
    TEST_ASSERT_EQUAL(SEQUENCE_HELD, seq_state()->state);
    tank_ticks(15);
    TEST_ASSERT_EQUAL(SEQUENCE_ABORTED, seq_state()->state);
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_ABORTED, SEQUENCE_TIMEOUT));
}

static void it_goes_on_when_the_reading_is_back_and_somebody_says_so(void)
{
    started_at(ROW_FILL);
    tank.level_mine = true;
    bad_reading(LEVEL, QUALITY_BAD, 0);
    tank_ticks(20);
    seq(SEQUENCE_DO_GO); /* too early */
    tank_tick();
    TEST_ASSERT_EQUAL(2, ended(EVENT_SEQUENCE_HELD, SEQUENCE_NO_READING));
    reading(LEVEL, 12);
    tank_ticks(20);
    TEST_ASSERT_EQUAL(SEQUENCE_HELD, seq_state()->state);
    seq(SEQUENCE_DO_GO);
    tank.level_mine = false;
    TEST_ASSERT_TRUE(reaches(ROW_HEAT, 300));
}

/* ---- guards ---- */

static void a_guard_broken_for_its_time_aborts(void)
{
    started_at(ROW_HEAT);
    tank.flow_mine = true;
    reading(FLOW, 10);
    tank_ticks(4);
    TEST_ASSERT_EQUAL(SEQUENCE_RUNNING, seq_state()->state);
    reading(FLOW, 50); /* back in time */
    tank_tick();
    reading(FLOW, 10);
    tank_ticks(4);
    TEST_ASSERT_EQUAL(SEQUENCE_RUNNING, seq_state()->state);
    tank_tick();
    TEST_ASSERT_EQUAL(SEQUENCE_ABORTED, seq_state()->state);
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_ABORTED, SEQUENCE_BY_GUARD));
    TEST_ASSERT_EQUAL_STRING("CW", seq_state()->about);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
}

static void a_guard_is_kept_by_valid_readings_alone(void)
{
    started_at(ROW_HEAT);
    tank.flow_mine = true;
    bad_reading(FLOW, QUALITY_BAD, 50);
    tank_ticks(6);
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_ABORTED, SEQUENCE_BY_GUARD));
}

static void a_guard_acts_while_the_sequence_is_held(void)
{
    started_at(ROW_HEAT);
    seq(SEQUENCE_DO_HOLD);
    tank_ticks(3);
    tank.flow_mine = true;
    reading(FLOW, 0);
    tank_ticks(6);
    TEST_ASSERT_EQUAL(SEQUENCE_ABORTED, seq_state()->state);
}

static void a_guard_without_grace_ends_it_before_the_next_row_moves_anything(void)
{
    put("step2.hold", "0");
    put("step1.limit", "15"); /* proves less than the guard wants */
    apply();
    tank.flow_mine = true;
    reading(FLOW, 18);
    seq(SEQUENCE_DO_START);
    tank_ticks(10);
    TEST_ASSERT_EQUAL(SEQUENCE_ABORTED, seq_state()->state);
    TEST_ASSERT_EQUAL(ROW_GUARD, seq_state()->step);
    TEST_ASSERT_EQUAL(0, happened(EVENT_OUTPUT, "inlet"));
}

static void a_guard_may_hold_instead_once_for_each_go(void)
{
    put("step2.else", "hold");
    apply();
    started_at(ROW_HEAT);
    tank.flow_mine = true;
    reading(FLOW, 0);
    tank_ticks(30);
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_HELD, SEQUENCE_BY_GUARD));
    seq(SEQUENCE_DO_GO);
    tank_ticks(3);
    TEST_ASSERT_EQUAL(SEQUENCE_RUNNING, seq_state()->state);
    tank_ticks(3);
    TEST_ASSERT_EQUAL(2, ended(EVENT_SEQUENCE_HELD, SEQUENCE_BY_GUARD));
}

static void a_guard_that_holds_sets_the_clock_of_what_a_person_held_going(void)
{
    put("step2.else", "hold");
    put("step4.else", "abort");
    apply();
    started_at(ROW_HEAT);
    seq(SEQUENCE_DO_HOLD);
    tank_ticks(700); /* longer than the time-out, which stands */
    TEST_ASSERT_EQUAL(SEQUENCE_HELD, seq_state()->state);
    tank.flow_mine = true;
    reading(FLOW, 0);
    tank_ticks(10);
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_HELD, SEQUENCE_BY_GUARD));
    tank_ticks(600);
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_ABORTED, SEQUENCE_TIMEOUT));
}

static void a_guard_ends_when_it_is_dropped_and_with_the_sequence(void)
{
    put_all((const char *const[]){"step6.do", "drop", "step6.what", "CW", NULL});
    apply();
    started_at(ROW_REFLUX);
    TEST_ASSERT_EQUAL(0, seq_state()->guards);
    tank.flow_mine = true;
    reading(FLOW, 0);
    tank_ticks(30);
    TEST_ASSERT_EQUAL(SEQUENCE_RUNNING, seq_state()->state);

    start_bench_with(NULL);
    started_at(ROW_STEADY);
    tank_ticks(1000);
    TEST_ASSERT_EQUAL(SEQUENCE_DONE, seq_state()->state);
    tank.flow_mine = true;
    reading(FLOW, 0);
    tank_ticks(30);
    TEST_ASSERT_EQUAL(SEQUENCE_DONE, seq_state()->state);
    TEST_ASSERT_EQUAL(SUPERVISOR_RUN, bench.s.state);
}

/* ---- interlocks, outputs, loops ---- */

static void cutting(const char *measurement, const char *side, const char *limit)
{
    put_all((const char *const[]){"lock1.meas", measurement, "lock1.mv", "heat", "lock1.side", side,
                                  "lock1.limit", limit, "lock1.value", "0", NULL});
    apply();
}

static void an_interlock_that_keeps_an_output_from_its_place_holds_it(void)
{
    cutting("T5", "above", "150");
    started_at(ROW_HEAT);
    reading(T5, 155);
    tank_ticks(3);
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_HELD, SEQUENCE_INTERLOCK));
    TEST_ASSERT_EQUAL_STRING("heat", seq_state()->about);
    reading(T5, 100);
    tank_ticks(5);
    TEST_ASSERT_EQUAL(SEQUENCE_HELD, seq_state()->state);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT)); /* nothing comes back by itself */
    seq(SEQUENCE_DO_GO);
    tank_tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.45, sent(HEAT));
}

static void an_interlock_on_an_output_nobody_has_moved_yet_does_not(void)
{
    cutting("level", "below", "18"); /* holds the heater until the tank is filled */
    started_at(ROW_FILL);
    TEST_ASSERT_TRUE(bench.s.mv[HEAT].interlocked);
    TEST_ASSERT_TRUE(reaches(ROW_HEAT, 300));
    tank_tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.45, sent(HEAT));
}

static void nor_one_that_agrees_with_the_sequence(void)
{
    started_at(ROW_STEADY);
    tank_ticks(1000);
    cutting("T5", "above", "150");
    reading(T5, 155);
    tank_ticks(3);
    seq(SEQUENCE_DO_STOP); /* wants the heater off as well */
    tank_ticks(3);
    TEST_ASSERT_EQUAL(SEQUENCE_RUNNING, seq_state()->state);
    TEST_ASSERT_EQUAL(ROW_STOP_WAIT, seq_state()->step);
}

static void an_interlock_on_a_loop_it_has_put_to_work_holds_it(void)
{
    cutting("T5", "above", "150");
    started_at(ROW_STEADY);
    reading(T5, 155);
    tank_ticks(3);
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_HELD, SEQUENCE_INTERLOCK));
}

static void a_loop_that_falls_into_manual_holds_it(void)
{
    started_at(ROW_STEADY);
    mode(LEVEL_LOOP, LOOP_MANUAL);
    tank_tick();
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_HELD, SEQUENCE_LOOP));
    TEST_ASSERT_EQUAL_STRING("sump", seq_state()->about);
    seq(SEQUENCE_DO_GO); /* as it is, then */
    tank_ticks(3);
    TEST_ASSERT_EQUAL(SEQUENCE_RUNNING, seq_state()->state);
}

static void an_output_that_does_not_follow_holds_it(void)
{
    put_all((const char *const[]){"mv2.band", "0.05", "mv2.follow", "10", NULL});
    apply();
    started_at(ROW_HEAT);
    bench.input.readback[HEAT] = (struct reading){0.0f, QUALITY_GOOD};
    tank_ticks(9);
    TEST_ASSERT_EQUAL(SEQUENCE_RUNNING, seq_state()->state);
    tank_ticks(4);
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_HELD, SEQUENCE_NOT_FOLLOWING));
    TEST_ASSERT_EQUAL_STRING("heat", seq_state()->about);
}

static void an_action_that_is_not_possible_holds_it_and_is_tried_again(void)
{
    started_at(ROW_CONFIRM);
    tank.temperature_mine = true;
    bad_reading(T10, QUALITY_BAD, 0);
    tank_ticks(12); /* lost: bottom cannot leave manual */
    seq(SEQUENCE_DO_CONFIRM);
    tank_tick();
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_HELD, SEQUENCE_REFUSED));
    TEST_ASSERT_EQUAL(ROW_AUTO, seq_state()->step);
    TEST_ASSERT_EQUAL_STRING("bottom", seq_state()->about);
    tank.temperature_mine = false;
    tank_tick();
    seq(SEQUENCE_DO_GO);
    tank_tick();
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_EQUAL(ROW_STEADY, seq_state()->step);
}

static void the_time_out_of_an_action_that_never_becomes_possible_runs(void)
{
    put_all((const char *const[]){"step10.until", "above", "step10.meas", "CW", "step10.limit", "1",
                                  "step10.timeout", "100", NULL});
    apply();
    started_at(ROW_CONFIRM);
    tank.temperature_mine = true;
    bad_reading(T10, QUALITY_BAD, 0);
    tank_ticks(12);
    seq(SEQUENCE_DO_CONFIRM);
    tank_ticks(95);
    TEST_ASSERT_EQUAL(SEQUENCE_HELD, seq_state()->state);
    tank_ticks(10);
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_ABORTED, SEQUENCE_TIMEOUT));
}

/* ---- the safe state ---- */

static void a_safe_state_for_any_other_reason_ends_it(void)
{
    started_at(ROW_HEAT);
    supervisor_go_safe(&bench.s, "link");
    TEST_ASSERT_EQUAL(SEQUENCE_ABORTED, seq_state()->state);
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_ABORTED, SEQUENCE_SAFE));
    TEST_ASSERT_EQUAL_STRING("link", seq_state()->about);

    start_bench_with(NULL);
    put_all((const char *const[]){"meas1.fallback", "safe", "meas1.hold", "5", NULL});
    apply();
    started_at(ROW_HEAT);
    bad_reading(T1, QUALITY_BAD, 0);
    tank_ticks(8);
    TEST_ASSERT_EQUAL(1, happened(EVENT_SAFE_STATE, "T1"));
    TEST_ASSERT_EQUAL_STRING("T1", seq_state()->about);
    TEST_ASSERT_EQUAL(SEQUENCE_ABORTED, seq_state()->state);
}

static void a_start_may_begin_in_the_safe_state_and_again_after_an_abort(void)
{
    supervisor_go_safe(&bench.s, "test");
    tank_tick();
    started_at(ROW_HEAT);
    seq(SEQUENCE_DO_ABORT);
    tank_ticks(5);
    started_at(ROW_HEAT);
    TEST_ASSERT_EQUAL(SUPERVISOR_RUN, bench.s.state);
}

static void plant_time_that_goes_back_or_leaps_breaks_nothing(void)
{
    started_at(ROW_HEAT);
    bench.input.time_ms -= 100000;
    tank_ticks(2);
    TEST_ASSERT_EQUAL(SEQUENCE_RUNNING, seq_state()->state);
    bench.input.time_ms += UINT64_C(1) << 40;
    tank_tick();
    TEST_ASSERT_TRUE(ended(EVENT_SEQUENCE_ABORTED, SEQUENCE_TIMEOUT) ||
                     ended(EVENT_SEQUENCE_HELD, SEQUENCE_TIMEOUT));
}

/* ---- anything at all ---- */

static struct random_source chance = {20240611};

static void any_reading(unsigned i, double hi)
{
    static const double odd[] = {NAN, INFINITY, -INFINITY, 1e30, -1e30, 1e-40};
    unsigned what = random_below(&chance, 40);
    if (what < 6)
        reading(i, odd[what]);
    else if (what < 12)
        bad_reading(i, (enum quality)random_below(&chance, 4),
                    random_below(&chance, 1000) * hi / 1000.0);
    else
        reading(i, random_below(&chance, 1000) * hi / 1000.0);
}

/* The row before, where the sequence has gone on in this tick by its condition alone. */
static void check_step(const struct sequence *before, unsigned commands)
{
    const struct sequence *q = seq_state();
    const struct step_config *c = &bench.config.step[before->step];
    bool went_on = before->state == SEQUENCE_RUNNING && before->acted && q->kind == before->kind &&
                   (q->state == SEQUENCE_DONE || q->step != before->step);
    bool looks = c->until == STEP_ABOVE || c->until == STEP_BELOW || c->until == STEP_STEADY;
    bool over = before->elapsed_ms + 1000 >= c->timeout_s * 1000u && c->otherwise == STEP_GO_ON;
    float value;
    TEST_ASSERT_TRUE(q->state <= SEQUENCE_ABORTED && q->step < CONFIG_STEPS);
    if (!went_on || !looks || over || commands || c->action == STEP_GUARD ||
        q->state == SEQUENCE_ABORTED)
        return;
    uint8_t i = bench.plan[bench.current].step[before->step].measurement;
    TEST_ASSERT_TRUE(sequence_reading(&bench.s, i, &value));
    TEST_ASSERT_FALSE(bench.s.measurement[i].alarm);
    if (c->until != STEP_STEADY)
        TEST_ASSERT_TRUE(c->until == STEP_ABOVE ? value > c->limit : value < c->limit);
}

static void whatever_comes_no_step_goes_on_by_what_is_not_valid(void)
{
    unsigned steps = 0;
    printf("sequences at random: seed %u\n", (unsigned)chance.state);
    for (unsigned n = 0; n < 60000; n++) {
        unsigned commands = 0;
        bool busy = sequence_active(seq_state());
        if (random_below(&chance, busy ? 60 : 3) == 0) {
            seq_at((enum sequence_command)random_below(&chance, SEQUENCE_COMMANDS + 1),
                   random_below(&chance, 3) ? seq_state()->step
                                            : (uint8_t)random_below(&chance, CONFIG_STEPS));
            commands++;
        }
        if (random_below(&chance, 50) == 0)
            mode((uint8_t)random_below(&chance, 3),
                 random_below(&chance, 2) ? LOOP_AUTO : LOOP_MANUAL);
        if (random_below(&chance, 3000) == 0)
            supervisor_go_safe(&bench.s, "test");
        if (random_below(&chance, 4) == 0) {
            any_reading(LEVEL, 40);
            any_reading(FLOW, 100);
            any_reading(T10, 160);
            any_reading(T5, 160);
        }
        struct sequence before = *seq_state();
        tick();
        steps += before.step != seq_state()->step;
        check_step(&before, commands);
        if (before.state != SEQUENCE_ABORTED && seq_state()->state == SEQUENCE_ABORTED)
            TEST_ASSERT_EQUAL(SUPERVISOR_SAFE, bench.s.state);
        bench.n_seen = 0;
    }
    TEST_ASSERT_TRUE(steps > 500);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(no_step_goes_on_by_a_reading_that_is_not_valid);
    RUN_TEST(nor_by_a_value_that_stands_in_for_it);
    RUN_TEST(time_without_a_valid_reading_does_not_count);
    RUN_TEST(a_long_gap_between_samples_counts_as_one_tick);
    RUN_TEST(the_time_out_runs_on_while_a_fault_holds_it);
    RUN_TEST(it_goes_on_when_the_reading_is_back_and_somebody_says_so);
    RUN_TEST(a_guard_broken_for_its_time_aborts);
    RUN_TEST(a_guard_is_kept_by_valid_readings_alone);
    RUN_TEST(a_guard_acts_while_the_sequence_is_held);
    RUN_TEST(a_guard_without_grace_ends_it_before_the_next_row_moves_anything);
    RUN_TEST(a_guard_may_hold_instead_once_for_each_go);
    RUN_TEST(a_guard_that_holds_sets_the_clock_of_what_a_person_held_going);
    RUN_TEST(a_guard_ends_when_it_is_dropped_and_with_the_sequence);
    RUN_TEST(an_interlock_that_keeps_an_output_from_its_place_holds_it);
    RUN_TEST(an_interlock_on_an_output_nobody_has_moved_yet_does_not);
    RUN_TEST(nor_one_that_agrees_with_the_sequence);
    RUN_TEST(an_interlock_on_a_loop_it_has_put_to_work_holds_it);
    RUN_TEST(a_loop_that_falls_into_manual_holds_it);
    RUN_TEST(an_output_that_does_not_follow_holds_it);
    RUN_TEST(an_action_that_is_not_possible_holds_it_and_is_tried_again);
    RUN_TEST(the_time_out_of_an_action_that_never_becomes_possible_runs);
    RUN_TEST(a_safe_state_for_any_other_reason_ends_it);
    RUN_TEST(a_start_may_begin_in_the_safe_state_and_again_after_an_abort);
    RUN_TEST(whatever_comes_no_step_goes_on_by_what_is_not_valid);
    RUN_TEST(plant_time_that_goes_back_or_leaps_breaks_nothing);
    return UNITY_END();
}

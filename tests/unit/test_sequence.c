/* Sequences: from row to row, and what a person may ask meanwhile. Faults: test_sequence_faults.c */
#include "exchange/sequence_rows.h"
#include "sequence_bench.h"
#include "supervise/sequence_act.h"

void setUp(void)
{
    start_bench_with(NULL);
}
void tearDown(void) {}

static void a_start_goes_from_cold_to_control_row_by_row(void)
{
    seq(SEQUENCE_DO_START);
    tank_tick();
    TEST_ASSERT_EQUAL(SEQUENCE_RUNNING, seq_state()->state);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, sent(COOL));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, sent(HEAT));
    TEST_ASSERT_TRUE(reaches(ROW_FILL, 100));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, sent(INLET));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, sent(HEAT));
    TEST_ASSERT_TRUE(reaches(ROW_HEAT, 300));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.45, sent(HEAT));
    TEST_ASSERT_TRUE(reaches(ROW_REFLUX, 600));
    TEST_ASSERT_TRUE(bench.s.measurement[LEVEL].offset.on);
    TEST_ASSERT_TRUE(reaches(ROW_CONFIRM, 100));
    TEST_ASSERT_EQUAL(SEQUENCE_CONFIRM, seq_state()->state);
    seq(SEQUENCE_DO_CONFIRM);
    TEST_ASSERT_TRUE(reaches(ROW_STEADY, 3));
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[LEVEL_LOOP].mode);
    tank_ticks(1000);
    TEST_ASSERT_EQUAL(SEQUENCE_DONE, seq_state()->state);
    TEST_ASSERT_DOUBLE_WITHIN(1, 118, tank.temperature);
    TEST_ASSERT_DOUBLE_WITHIN(2.5, 15, tank.level);
    TEST_ASSERT_EQUAL(1, happened(EVENT_SEQUENCE_DONE, "start"));
    TEST_ASSERT_EQUAL(0, happened(EVENT_SEQUENCE_TIMEOUT, NULL));
}

static void a_stop_takes_loops_off_and_ends_when_cold(void)
{
    started_at(ROW_STEADY);
    tank_ticks(1000);
    seq(SEQUENCE_DO_STOP);
    tank_tick();
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, sent(COOL));
    tank_ticks(500);
    TEST_ASSERT_EQUAL(SEQUENCE_DONE, seq_state()->state);
    TEST_ASSERT_TRUE(tank.temperature < 80);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(COOL));
    TEST_ASSERT_EQUAL(1, happened(EVENT_SEQUENCE_DONE, "stop"));
}

static void a_stop_takes_over_from_a_start_anywhere(void)
{
    started_at(ROW_REFLUX);
    seq(SEQUENCE_DO_STOP);
    tank_tick();
    TEST_ASSERT_EQUAL(SEQUENCE_STOP, seq_state()->kind);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
    TEST_ASSERT_EQUAL(0, happened(EVENT_SEQUENCE_ABORTED, NULL));
    seq(SEQUENCE_DO_START); /* not the other way round */
    seq(SEQUENCE_DO_STOP);  /* nor again */
    TEST_ASSERT_EQUAL(2, happened(EVENT_REQUEST_REFUSED, "seq"));
    TEST_ASSERT_EQUAL(SEQUENCE_STOP, seq_state()->kind);
    TEST_ASSERT_EQUAL(ROW_STOP_WAIT, seq_state()->step);
}

static void a_start_is_refused_while_a_loop_acts_or_it_runs(void)
{
    mode(BOTTOM, LOOP_AUTO);
    seq(SEQUENCE_DO_START);
    TEST_ASSERT_EQUAL(SEQUENCE_IDLE, seq_state()->state);
    mode(BOTTOM, LOOP_MANUAL);
    seq(SEQUENCE_DO_START);
    seq(SEQUENCE_DO_START);
    TEST_ASSERT_EQUAL(2, happened(EVENT_REQUEST_REFUSED, "seq"));
    TEST_ASSERT_EQUAL(SEQUENCE_RUNNING, seq_state()->state);
}

static void rows_that_wait_for_nothing_run_in_one_tick(void)
{
    started_at(ROW_CONFIRM);
    seq(SEQUENCE_DO_CONFIRM);
    bench_forget_events();
    tank_tick();
    TEST_ASSERT_EQUAL(ROW_STEADY, seq_state()->step);
    TEST_ASSERT_EQUAL(2, happened(EVENT_MODE, NULL));
    TEST_ASSERT_EQUAL(2, happened(EVENT_SETPOINT, NULL));
    TEST_ASSERT_EQUAL(1, happened(EVENT_SEQUENCE_STEP, NULL)); /* told where it waits */
}

static void a_condition_must_hold_for_its_time_without_a_break(void)
{
    tank.flow_mine = true;
    reading(FLOW, 31);
    seq(SEQUENCE_DO_START);
    tank_ticks(5);
    TEST_ASSERT_EQUAL(ROW_COOL, seq_state()->step);
    reading(FLOW, 29);
    tank_tick();
    reading(FLOW, 31);
    tank_ticks(5);
    TEST_ASSERT_EQUAL(ROW_COOL, seq_state()->step);
    tank_tick();
    TEST_ASSERT_EQUAL(ROW_FILL, seq_state()->step);
}

static void a_limit_is_passed_not_touched(void)
{
    set_and_apply("step1.limit", "25");
    tank.flow_mine = true;
    reading(FLOW, 25);
    seq(SEQUENCE_DO_START);
    tank_ticks(20);
    TEST_ASSERT_EQUAL(ROW_COOL, seq_state()->step);
}

static void steady_is_a_width_kept_for_a_time(void)
{
    started_at(ROW_STEADY);
    tank.temperature_mine = true;
    for (unsigned n = 0; n < 300; n++) { /* moves by 2.4 in every 30 s */
        reading(T10, 100 + 0.08 * n);
        tank_tick();
    }
    TEST_ASSERT_EQUAL(SEQUENCE_RUNNING, seq_state()->state);
    for (unsigned n = 0; n < 30; n++) { /* noise within the width */
        reading(T10, 120 + (n % 2 ? 0.9 : -0.9));
        tank_tick();
    }
    TEST_ASSERT_EQUAL(SEQUENCE_RUNNING, seq_state()->state);
    tank_ticks(2);
    TEST_ASSERT_EQUAL(SEQUENCE_DONE, seq_state()->state);
}

static void a_time_out_does_what_its_row_says(void)
{
    tank.flow_mine = true;
    reading(FLOW, 0);
    seq(SEQUENCE_DO_START);
    tank_ticks(60);
    TEST_ASSERT_EQUAL(SEQUENCE_RUNNING, seq_state()->state);
    tank_ticks(2);
    TEST_ASSERT_EQUAL(SEQUENCE_ABORTED, seq_state()->state);
    TEST_ASSERT_EQUAL(SUPERVISOR_SAFE, bench.s.state);
    TEST_ASSERT_EQUAL(1, happened(EVENT_SEQUENCE_TIMEOUT, "CW"));
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_ABORTED, SEQUENCE_TIMEOUT));
    TEST_ASSERT_EQUAL(1, happened(EVENT_SAFE_STATE, "sequence"));

    start_bench_with(NULL);
    started_at(ROW_HEAT);
    tank.temperature_mine = true;
    reading(T10, 90);
    tank_ticks(605);
    TEST_ASSERT_EQUAL(SEQUENCE_HELD, seq_state()->state);
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_HELD, SEQUENCE_TIMEOUT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.45, sent(HEAT)); /* nothing is moved */
    uint32_t at_ms = seq_state()->elapsed_ms;
    tank_ticks(5);
    TEST_ASSERT_EQUAL(at_ms, seq_state()->elapsed_ms);

    start_bench_with(NULL);
    started_at(ROW_STEADY);
    tank.temperature_mine = true;
    for (unsigned n = 0; n < 905; n++) {
        reading(T10, n % 2 ? 100 : 110);
        tank_tick();
    }
    TEST_ASSERT_EQUAL(SEQUENCE_DONE, seq_state()->state);
    TEST_ASSERT_EQUAL(1, happened(EVENT_SEQUENCE_TIMEOUT, "T10"));
}

static void a_time_counts_from_the_tick_the_step_begins_in(void)
{
    started_at(ROW_REFLUX);
    TEST_ASSERT_EQUAL(0, seq_state()->met_ms);
    TEST_ASSERT_EQUAL(0, seq_state()->elapsed_ms);
    tank_ticks(59);
    TEST_ASSERT_EQUAL(ROW_REFLUX, seq_state()->step);
    tank_tick();
    TEST_ASSERT_EQUAL(ROW_CONFIRM, seq_state()->step);
}

static void held_by_a_person_its_clocks_stand_and_it_goes_on_where_it_was(void)
{
    started_at(ROW_REFLUX);
    tank_ticks(40);
    seq(SEQUENCE_DO_HOLD);
    tank_ticks(500);
    TEST_ASSERT_EQUAL(SEQUENCE_HELD, seq_state()->state);
    out(BOTTOM, 0.7); /* by hand, meanwhile */
    seq(SEQUENCE_DO_GO);
    tank_ticks(15);
    TEST_ASSERT_EQUAL(ROW_REFLUX, seq_state()->step);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.35, sent(HEAT));
    tank_ticks(6);
    TEST_ASSERT_EQUAL(ROW_CONFIRM, seq_state()->step);
    TEST_ASSERT_EQUAL(1, happened(EVENT_SEQUENCE_GOES_ON, "start"));
}

static void held_by_a_time_out_the_step_begins_again(void)
{
    started_at(ROW_HEAT);
    tank.temperature_mine = true;
    reading(T10, 90);
    tank_ticks(605);
    out(BOTTOM, 0);
    tank_tick();
    seq(SEQUENCE_DO_GO);
    tank_tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.45, sent(HEAT)); /* its action is repeated */
    TEST_ASSERT_TRUE(seq_state()->elapsed_ms <= 1000);
    tank_ticks(590);
    TEST_ASSERT_EQUAL(SEQUENCE_RUNNING, seq_state()->state);
}

static void a_confirmation_counts_for_the_step_that_was_shown(void)
{
    started_at(ROW_CONFIRM);
    seq_at(SEQUENCE_DO_CONFIRM, ROW_HEAT);
    tank_tick();
    TEST_ASSERT_EQUAL(SEQUENCE_CONFIRM, seq_state()->state);
    TEST_ASSERT_EQUAL(1, happened(EVENT_REQUEST_REFUSED, "seq"));
    seq(SEQUENCE_DO_CONFIRM);
    tank_tick();
    TEST_ASSERT_TRUE(seq_state()->step > ROW_CONFIRM);
}

static void nobody_confirms_in_advance(void)
{
    started_at(ROW_REFLUX);
    seq_at(SEQUENCE_DO_CONFIRM, ROW_CONFIRM);
    TEST_ASSERT_EQUAL(1, happened(EVENT_REQUEST_REFUSED, "seq"));
    tank_ticks(70);
    TEST_ASSERT_EQUAL(SEQUENCE_CONFIRM, seq_state()->state);
}

static void a_skip_gives_up_the_waiting_of_one_step(void)
{
    started_at(ROW_HEAT);
    seq(SEQUENCE_DO_SKIP);
    tank_tick();
    TEST_ASSERT_EQUAL(ROW_REFLUX, seq_state()->step);
    TEST_ASSERT_EQUAL(1, happened(EVENT_SEQUENCE_SKIPPED, "start"));
    seq_at(SEQUENCE_DO_SKIP, ROW_HEAT); /* an old one */
    tank_tick();
    TEST_ASSERT_EQUAL(ROW_REFLUX, seq_state()->step);
}

static void an_abort_is_the_safe_state_from_every_step(void)
{
    static const uint8_t rows[] = {ROW_COOL,   ROW_FILL,    ROW_HEAT,
                                   ROW_REFLUX, ROW_CONFIRM, ROW_STEADY};
    for (unsigned i = 0; i < sizeof rows; i++) {
        start_bench_with(NULL);
        started_at(rows[i]);
        seq(SEQUENCE_DO_ABORT);
        TEST_ASSERT_EQUAL(SEQUENCE_ABORTED, seq_state()->state);
        TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_ABORTED, SEQUENCE_OPERATOR));
        tank_tick();
        TEST_ASSERT_EQUAL(SUPERVISOR_SAFE, bench.s.state);
        for (unsigned j = 0; j <= INLET; j++)
            TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(j));
        for (unsigned k = 0; k <= LEVEL_LOOP; k++)
            TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[k].mode);
        tank_ticks(100);
        TEST_ASSERT_EQUAL(SEQUENCE_ABORTED, seq_state()->state);
    }
}

static void what_makes_no_sense_now_is_refused(void)
{
    static const enum sequence_command idle[] = {
        SEQUENCE_DO_HOLD, SEQUENCE_DO_GO, SEQUENCE_DO_CONFIRM, SEQUENCE_DO_SKIP, SEQUENCE_DO_ABORT};
    for (unsigned i = 0; i < sizeof idle / sizeof idle[0]; i++)
        seq(idle[i]);
    seq((enum sequence_command)200);
    TEST_ASSERT_EQUAL(6, happened(EVENT_REQUEST_REFUSED, "seq"));
    TEST_ASSERT_EQUAL(SEQUENCE_IDLE, seq_state()->state);
    TEST_ASSERT_EQUAL(SUPERVISOR_RUN, bench.s.state); /* nobody asked for the safe state */
}

static void without_rows_there_is_nothing_to_start(void)
{
    bench_start();
    seq(SEQUENCE_DO_START);
    seq(SEQUENCE_DO_STOP);
    TEST_ASSERT_EQUAL(2, happened(EVENT_REQUEST_REFUSED, "seq"));
    TEST_ASSERT_EQUAL(SEQUENCE_IDLE, seq_state()->state);
}

static void rows_that_change_meanwhile_end_it_in_the_safe_state(void)
{
    started_at(ROW_HEAT);
    set_and_apply("step4.limit", "105");
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_ABORTED, SEQUENCE_CONFIGURATION));
    tank_tick();
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
}

static void channels_that_change_places_end_it_too(void)
{
    started_at(ROW_HEAT);
    put_all((const char *const[]){"meas5.name", "CW", "meas5.unit", "l/h", "meas5.hi", "100",
                                  "meas6.name", "level", "meas6.unit", "cm", "meas6.hi", "40",
                                  NULL});
    apply();
    TEST_ASSERT_EQUAL(1, ended(EVENT_SEQUENCE_ABORTED, SEQUENCE_CONFIGURATION));
}

static void other_settings_change_meanwhile_without_disturbing_it(void)
{
    started_at(ROW_HEAT);
    set_and_apply("loop2.gain", "1.7");
    set_and_apply("meas5.offset", "7");
    tank_tick();
    TEST_ASSERT_EQUAL(ROW_HEAT, seq_state()->step);
    TEST_ASSERT_TRUE(reaches(ROW_REFLUX, 600));
    TEST_ASSERT_EQUAL_FLOAT(7.0f,
                            measurement_offset_in_force(&bench.s.measurement[LEVEL],
                                                        &bench.s.plan->config.measurement[LEVEL]));
}

/* ---- the offset ---- */

static double level_now(void)
{
    float value;
    TEST_ASSERT_TRUE(sequence_reading(&bench.s, LEVEL, &value));
    return (double)value;
}

static void an_offset_is_subtracted_from_the_tick_on_that_switches_it(void)
{
    set_and_apply("meas5.filter", "100"); /* which does not smear it */
    tank.level_mine = true;
    reading(LEVEL, 20);
    tank_ticks(5);
    double before = level_now();
    measurement_offset(&bench.s, LEVEL, true);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, before - 8, level_now());
    tank_tick();
    TEST_ASSERT_DOUBLE_WITHIN(0.1, before - 8, level_now());
    tank_ticks(1000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 12, level_now());
    TEST_ASSERT_EQUAL_FLOAT(12.0f, bench.s.measurement[LEVEL].raw);
    measurement_offset(&bench.s, LEVEL, false);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 20, level_now());
    TEST_ASSERT_EQUAL(2, happened(EVENT_OFFSET, "level"));
}

static void what_is_valid_is_judged_by_what_the_instrument_says(void)
{
    tank.level_mine = true;
    measurement_offset(&bench.s, LEVEL, true);
    reading(LEVEL, 1); /* -7: further outside the span than is valid of an instrument */
    tank_tick();
    TEST_ASSERT_FALSE(bench.s.measurement[LEVEL].alarm);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, -7, level_now());
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, bench.s.measurement[LEVEL].quality);
    reading(LEVEL, 47);
    tank_tick();
    TEST_ASSERT_TRUE(bench.s.measurement[LEVEL].alarm);
}

static void an_interlock_sees_the_corrected_reading(void)
{
    put_all((const char *const[]){"lock1.meas", "level", "lock1.mv", "heat", "lock1.side", "below",
                                  "lock1.limit", "6", NULL});
    apply();
    tank.level_mine = true;
    reading(LEVEL, 13);
    tank_ticks(3);
    TEST_ASSERT_EQUAL(0, happened(EVENT_INTERLOCK_ON, NULL));
    measurement_offset(&bench.s, LEVEL, true);
    tank_tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_INTERLOCK_ON, "heat"));
}

static void a_loop_takes_the_switch_without_a_bump(void)
{
    put_all((const char *const[]){"loop1.name", "level_pi", "loop1.pv", "level", "loop1.out",
                                  "spare", "loop1.gain", "5", NULL});
    put("loop3.out", "draw");
    apply();
    tank.level_mine = true;
    reading(LEVEL, 20);
    tank_ticks(3);
    out(TOP, 50);
    tank_tick();
    mode(TOP, LOOP_AUTO);
    tank_ticks(3);
    double before = sent(SPARE);
    measurement_offset(&bench.s, LEVEL, true);
    tick();
    ASSERT_NO_BUMP(before, sent(SPARE));
}

static void an_offset_stays_through_the_safe_state_and_ends_with_its_measurement(void)
{
    measurement_offset(&bench.s, LEVEL, true);
    supervisor_go_safe(&bench.s, "test");
    tank_tick();
    TEST_ASSERT_TRUE(bench.s.measurement[LEVEL].offset.on);
    bench_config(); /* without rows, level or offset */
    apply();
    TEST_ASSERT_EQUAL(2, happened(EVENT_OFFSET, "level"));
    TEST_ASSERT_FALSE(bench.s.measurement[LEVEL].offset.on);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_start_goes_from_cold_to_control_row_by_row);
    RUN_TEST(a_stop_takes_loops_off_and_ends_when_cold);
    RUN_TEST(a_stop_takes_over_from_a_start_anywhere);
    RUN_TEST(a_start_is_refused_while_a_loop_acts_or_it_runs);
    RUN_TEST(rows_that_wait_for_nothing_run_in_one_tick);
    RUN_TEST(a_condition_must_hold_for_its_time_without_a_break);
    RUN_TEST(a_limit_is_passed_not_touched);
    RUN_TEST(steady_is_a_width_kept_for_a_time);
    RUN_TEST(a_time_out_does_what_its_row_says);
    RUN_TEST(a_time_counts_from_the_tick_the_step_begins_in);
    RUN_TEST(held_by_a_person_its_clocks_stand_and_it_goes_on_where_it_was);
    RUN_TEST(held_by_a_time_out_the_step_begins_again);
    RUN_TEST(a_confirmation_counts_for_the_step_that_was_shown);
    RUN_TEST(nobody_confirms_in_advance);
    RUN_TEST(a_skip_gives_up_the_waiting_of_one_step);
    RUN_TEST(an_abort_is_the_safe_state_from_every_step);
    RUN_TEST(what_makes_no_sense_now_is_refused);
    RUN_TEST(without_rows_there_is_nothing_to_start);
    RUN_TEST(rows_that_change_meanwhile_end_it_in_the_safe_state);
    RUN_TEST(channels_that_change_places_end_it_too);
    RUN_TEST(other_settings_change_meanwhile_without_disturbing_it);
    RUN_TEST(an_offset_is_subtracted_from_the_tick_on_that_switches_it);
    RUN_TEST(what_is_valid_is_judged_by_what_the_instrument_says);
    RUN_TEST(an_interlock_sees_the_corrected_reading);
    RUN_TEST(a_loop_takes_the_switch_without_a_bump);
    RUN_TEST(an_offset_stays_through_the_safe_state_and_ends_with_its_measurement);
    return UNITY_END();
}

/* The estimator of compositions when readings lie or are missing, when its settings change, and when it settles. */
#include "composition_bench.h"

void setUp(void)
{
    bench_pilot();
}

void tearDown(void) {}

static void retune(void)
{
    accepted();
    TEST_ASSERT_EQUAL(ERR_OK, kind->configure(&block, &setup, true));
}

/* Locked on, with integrals that hold something: the plant has more heat than is said. */
static void begin_with_a_past(void)
{
    begin();
    plant.model.inputs.heat += 20;
    plant_runs(1000);
    steps(1000);
    TEST_ASSERT_TRUE(fabsf(block.sensors.sensor[1].sum) > 10);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, point_quality[0]);
}

/* ---- the gate ---- */

static void a_reading_that_jumps_is_not_believed(void)
{
    begin();
    steps(GATED + 10);
    float before = block.model.x[9], sum = block.sensors.sensor[1].sum;
    put(T_HIGH, truth(10) + 15);
    steps(30);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, before, block.model.x[9]);
    TEST_ASSERT_TRUE(fabsf(block.sensors.sensor[1].sum - sum) < 1);
    TEST_ASSERT_TRUE(raised(EVENT_LOST));
    TEST_ASSERT_EQUAL_FLOAT(T_HIGH + 1, event_value[EVENT_LOST]);
    measure();
    step();
    TEST_ASSERT_FALSE(raised(EVENT_LOST));
}

static void what_goes_on_being_far_away_is_believed_after_a_time(void)
{
    begin();
    steps(GATED + 10);
    put(T_HIGH, truth(10) - 15);
    for (unsigned n = 0; n < 30; n++) { /* 300 s */
        step();
        TEST_ASSERT_FALSE(block.sensors.sensor[1].present);
    }
    step();
    TEST_ASSERT_TRUE(block.sensors.sensor[1].present);
    TEST_ASSERT_FALSE(raised(EVENT_LOST));
}

static void a_jump_that_comes_back_counts_anew(void)
{
    begin();
    steps(GATED + 10);
    for (unsigned n = 0; n < 60; n++) {
        put(T_HIGH, truth(10) - (n == 20 || n == 45 ? 1.0f : 15.0f));
        step();
        TEST_ASSERT_EQUAL(n == 20 || n == 45, block.sensors.sensor[1].present);
    }
}

static void readings_on_the_gate_s_near_side_are_taken(void)
{
    begin();
    steps(GATED + 10);
    put(T_HIGH, (float)block.model.column.temperature[9] + 9.9f);
    step();
    TEST_ASSERT_TRUE(block.sensors.sensor[1].present);
    put(T_HIGH, (float)composition_model_temperature(&block.model, 9) - 10.1f);
    step();
    TEST_ASSERT_FALSE(block.sensors.sensor[1].present);
}

static void before_it_had_time_to_find_its_plant_all_readings_are_taken(void)
{
    begin();
    put(T_HIGH, truth(10) + 15);
    step();
    TEST_ASSERT_TRUE(block.sensors.sensor[1].present);
    measure();
    steps(GATED - 2);
    put(T_HIGH, truth(10) + 15);
    step();
    TEST_ASSERT_TRUE(block.sensors.sensor[1].present);
    steps(2);
    put(T_HIGH, truth(10) + 30);
    step();
    TEST_ASSERT_FALSE(block.sensors.sensor[1].present);
}

static void a_reading_that_another_of_its_section_contradicts_waits_for_as_long(void)
{
    all_settings.s.place[T_LOW][AT_STAGE] = 8;
    begin();
    steps(2 * LOCKED + 10);
    put(T_HIGH, truth(10) - 15);
    for (unsigned n = 0; n < 200; n++) {
        step();
        TEST_ASSERT_FALSE(block.sensors.sensor[1].present);
    }
    put(T_LOW, truth(8) - 15); /* now they agree */
    step();
    TEST_ASSERT_TRUE(block.sensors.sensor[1].present);
    TEST_ASSERT_FALSE(block.sensors.sensor[0].present);
}

static void at_a_limit_of_its_mole_fraction_the_integral_gathers_no_more(void)
{
    begin();
    steps(LOCKED);
    put(T_HIGH, truth(10) - 5); /* below what pure TCE boils at */
    steps(300);
    float sum = block.sensors.sensor[1].sum;
    TEST_ASSERT_TRUE(block.model.x[9] > 0.999f);
    steps(300);
    TEST_ASSERT_EQUAL_FLOAT(sum, block.sensors.sensor[1].sum);
    measure();
    step();
    TEST_ASSERT_TRUE(fabsf(block.sensors.sensor[1].sum) < fabsf(sum));
}

static void without_a_gate_everything_is_believed(void)
{
    all_settings.gate = 0;
    begin();
    steps(GATED + 10);
    put(T_HIGH, truth(10) + 30);
    step();
    TEST_ASSERT_TRUE(block.sensors.sensor[1].present);
}

/* A second temperature of its section. */
static void begin_with_another(unsigned stage, unsigned component)
{
    temperature_at(FURTHER, stage, component);
    setup.inputs++;
    begin();
    steps(GATED + 10);
}

static bool is_believed_after(unsigned n)
{
    put(T_HIGH, truth(10) - 15);
    steps(n);
    return block.sensors.sensor[1].present;
}

static void while_another_of_its_section_agrees_it_is_never_believed(void)
{
    begin_with_another(8, 1);
    TEST_ASSERT_FALSE(is_believed_after(500));
    quality[FURTHER] = QUALITY_BAD;
    step();
    TEST_ASSERT_TRUE(block.sensors.sensor[1].present);
}

static void one_of_the_other_section_or_that_moves_nothing_does_not_contradict(void)
{
    begin_with_another(5, 1);
    TEST_ASSERT_TRUE(is_believed_after(31));
    setUp();
    begin_with_another(8, 0);
    TEST_ASSERT_TRUE(is_believed_after(31));
    setUp();
    temperature_at(T_LOW, 1, 1);
    temperature_at(T_HIGH, 5, 1); /* both below, from the feed stage down */
    begin();
    steps(GATED + 10);
    put(T_HIGH, truth(5) - 15);
    steps(31);
    TEST_ASSERT_FALSE(block.sensors.sensor[1].present);
}

static void where_all_of_a_section_are_far_away_they_are_believed_after_the_time(void)
{
    begin_with_another(8, 1);
    put(FURTHER, truth(8) - 15);
    TEST_ASSERT_FALSE(is_believed_after(30));
    TEST_ASSERT_TRUE(is_believed_after(1));
    TEST_ASSERT_TRUE(block.sensors.sensor[3].present);
}

/* ---- missing ---- */

static void what_a_missing_temperature_had_learned_fades(void)
{
    begin_with_a_past();
    double sum = (double)block.sensors.sensor[1].sum, part = 10 * (10.0 / 3600) / (2 * 3);
    quality[T_HIGH] = QUALITY_BAD;
    for (unsigned n = 0; n < 100; n++) {
        step();
        sum *= 1 - part;
        TEST_ASSERT_DOUBLE_WITHIN(fabs(sum) * 1e-3, sum, (double)block.sensors.sensor[1].sum);
    }
    steps(3000);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 0, block.sensors.sensor[1].sum);
}

static void what_is_forgotten_within_a_step_is_forgotten_whole(void)
{
    all_settings.tune[T_HIGH][TUNE_LAMBDA] = 1e4f;
    all_settings.tune[T_HIGH][TUNE_ZETA] = 0.1f;
    begin();
    block.sensors.sensor[1].sum = 1;
    quality[T_HIGH] = QUALITY_MISSING;
    step();
    TEST_ASSERT_EQUAL_FLOAT(0, block.sensors.sensor[1].sum);
}

static void only_a_good_temperature_draws(void)
{
    for (uint8_t q = QUALITY_UNCERTAIN; q <= QUALITY_MISSING; q++) {
        setUp();
        begin();
        steps(2);
        float alone = block.model.x[9];
        put(T_HIGH, truth(10) + 8);
        quality[T_HIGH] = q;
        step();
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, alone, block.model.x[9]);
        quality[T_HIGH] = QUALITY_GOOD;
        step();
        TEST_ASSERT_TRUE(block.model.x[9] < alone - 1e-3f);
    }
}

static void a_temperature_that_is_only_compared_does_not_move_the_model(void)
{
    struct composition_block before;
    for (unsigned k = 0; k < 2; k++) {
        setUp();
        all_settings.s.method = k ? METHOD_REKF : METHOD_GEOMETRIC;
        begin();
        put(T_COMPARED, truth(7) + 8);
        steps(50);
        before = block;
        setUp();
        all_settings.s.method = k ? METHOD_REKF : METHOD_GEOMETRIC;
        begin();
        steps(50);
        TEST_ASSERT_EQUAL_MEMORY(before.model.x, block.model.x, sizeof block.model.x);
        TEST_ASSERT_FLOAT_WITHIN(0.1f, 8, before.sensors.sensor[2].e);
        TEST_ASSERT_EQUAL_FLOAT(0, before.sensors.sensor[2].correction);
    }
}

static void a_flow_that_is_missing_stays_as_it_was(void)
{
    begin();
    put(REFLUX, 4.6f);
    step();
    quality[REFLUX] = QUALITY_BAD;
    put(REFLUX, 1);
    steps(3);
    TEST_ASSERT_FLOAT_WITHIN(1e-11f, 4.6f / 3.6e6f, (float)block.model.column.inputs.reflux_flow);
    quality[REFLUX] = QUALITY_UNCERTAIN; /* good enough */
    step();
    TEST_ASSERT_FLOAT_WITHIN(1e-11f, 1 / 3.6e6f, (float)block.model.column.inputs.reflux_flow);
}

/* ---- other settings ---- */

static void other_settings_leave_the_estimate_and_its_past(void)
{
    struct composition_block before;
    begin_with_a_past();
    before = block;
    all_settings.s.show[TOP_FRACTION][UNIT_FACTOR] = 0.5f;
    all_settings.noise = 1;
    all_settings.gate = 5;
    all_settings.gate_s = 60;
    all_settings.s.watch_s = 600;
    all_settings.s.doubt = DOUBT_UNCERTAIN;
    retune();
    TEST_ASSERT_EQUAL_MEMORY(before.model.x, block.model.x, sizeof before.model.x);
    for (unsigned k = 0; k < before.sensors.n; k++)
        before.sensors.sensor[k].noise2 = 1;
    TEST_ASSERT_EQUAL_MEMORY(before.sensors.sensor, block.sensors.sensor,
                             sizeof before.sensors.sensor);
    TEST_ASSERT_EQUAL(before.judge.steps, block.judge.steps);
    TEST_ASSERT_EQUAL(before.watch.steps, block.watch.steps);
    TEST_ASSERT_EQUAL_FLOAT(5, (float)block.sensors.gate);
    TEST_ASSERT_EQUAL(6, block.sensors.gate_steps);
    step();
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.5f * before.model.x[11], given(TOP_FRACTION));
    TEST_ASSERT_EQUAL(QUALITY_GOOD, point_quality[0]);
}

static void other_gains_leave_what_the_integral_does(void)
{
    begin_with_a_past();
    float rate = block.sensors.sensor[1].ki * block.sensors.sensor[1].sum;
    all_settings.tune[T_HIGH][TUNE_LAMBDA] = 30;
    all_settings.tune[T_HIGH][TUNE_ZETA] = 1;
    retune();
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 30.0f / 3600 * 30 / 3600, block.sensors.sensor[1].ki);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 2.0f * 30 / 3600, block.sensors.sensor[1].kp);
    TEST_ASSERT_FLOAT_WITHIN(fabsf(rate) * 1e-3f, rate,
                             block.sensors.sensor[1].ki * block.sensors.sensor[1].sum);
    float x = block.model.x[9];
    steps(20);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, x, block.model.x[9]);
}

static void begins_afresh(void)
{
    retune();
    for (unsigned s = 0; s < 12; s++)
        TEST_ASSERT_EQUAL_FLOAT(block.model.table.profile[s], block.model.x[s]);
    TEST_ASSERT_EQUAL(0, block.judge.steps);
    TEST_ASSERT_EQUAL(0, block.watch.steps);
    TEST_ASSERT_EQUAL_FLOAT(0, block.sensors.sensor[1].sum);
    TEST_ASSERT_FALSE(block.begun);
}

static void another_table_is_a_fresh_beginning(void)
{
    static struct column_record other;
    begin_with_a_past();
    change_record(&record, COLUMN_TABLE_EFFICIENCY, 0.8f);
    begins_afresh();
    TEST_ASSERT_EQUAL_FLOAT(0.8f, (float)block.model.table.config.efficiency);
    setUp();
    begin_with_a_past();
    other = record;
    setup.named = &other; /* the same, where a state must not point any more to the old one */
    begins_afresh();
}

static void temperatures_elsewhere_are_a_fresh_beginning(void)
{
    begin_with_a_past();
    temperature_at(T_HIGH, 11, 1);
    begins_afresh();
    TEST_ASSERT_EQUAL(10, block.sensors.sensor[1].stage);
}

static void inputs_of_another_meaning_are_a_fresh_beginning(void)
{
    begin_with_a_past();
    all_settings.s.role[REFLUX] = IS_FEED_TEMPERATURE;
    all_settings.s.si[REFLUX][UNIT_FACTOR] = 20;
    begins_afresh();
}

static void another_method_is_a_fresh_beginning(void)
{
    begin_with_a_past();
    all_settings.s.method = METHOD_REKF;
    begins_afresh();
    TEST_ASSERT_EQUAL_FLOAT(0, block.sensors.sensor[1].ki);
}

/* ---- settle ---- */

/* As the supervisor does it: what is asked for runs on between steps. */
static unsigned settles(void)
{
    unsigned works = 1;
    TEST_ASSERT_NULL(kind->verb[0].run(&block, NULL));
    step();
    TEST_ASSERT_EQUAL(1, io.requests.ask_work);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, point_quality[0]);
    io.requests.work_wanted = true;
    while (kind->work(&block)) {
        works++;
        float x = block.model.x[0];
        step();
        TEST_ASSERT_EQUAL_FLOAT(x, block.model.x[0]); /* left alone */
        TEST_ASSERT_TRUE(works < 400);
    }
    io.requests.work_wanted = false;
    io.requests.work_done = true;
    step();
    io.requests.work_done = false;
    return works;
}

static void it_settles_to_the_steady_state_of_its_model_at_the_inputs_that_there_are(void)
{
    begin();
    put(REFLUX, 5);
    quality[T_LOW] = quality[T_HIGH] = QUALITY_BAD;
    steps(2);
    TEST_ASSERT_TRUE(settles() > 5);
    TEST_ASSERT_FALSE(block.settle);
    TEST_ASSERT_EQUAL_FLOAT(10, (float)block.model.h);
    float kept[12];
    memcpy(kept, block.model.x, sizeof kept);
    TEST_ASSERT_TRUE(fabsf(kept[0] - block.model.table.profile[0]) > 0.01f);
    steps(500);
    for (unsigned s = 0; s < 12; s++)
        TEST_ASSERT_FLOAT_WITHIN(4e-4f, kept[s], block.model.x[s]);
}

static void while_it_settles_it_does_not_begin(void)
{
    begin();
    put(REFLUX, 5);
    step();
    TEST_ASSERT_NULL(kind->verb[0].run(&block, NULL));
    step();
    io.requests.work_wanted = true;
    TEST_ASSERT_TRUE(kind->work(&block));
    float x = block.model.x[0];
    TEST_ASSERT_NOT_NULL(kind->verb[1].run(&block, NULL));
    TEST_ASSERT_EQUAL_FLOAT(x, block.model.x[0]);
}

static void where_the_model_has_no_solution_it_does_not_settle(void)
{
    begin();
    block.model.inputs.pressure_top = 1;
    TEST_ASSERT_NULL(kind->verb[0].run(&block, NULL));
    step();
    TEST_ASSERT_FALSE(kind->work(&block));
    TEST_ASSERT_EQUAL(1, block.model.restarts);
    TEST_ASSERT_EQUAL_FLOAT(block.model.table.profile[0], block.model.x[0]);
}

static void what_the_model_cannot_bear_is_kept_at_its_limits(void)
{
    all_settings.s.role[FURTHER] = IS_PRESSURE;
    setup.inputs++;
    setup.input[FURTHER] = (struct block_signal){0, 1e6f, false};
    put(FURTHER, 101325);
    begin();
    put(FURTHER, 1);
    step();
    TEST_ASSERT_FLOAT_WITHIN(1, 101325.0f / 2, (float)block.model.inputs.pressure_top);
    put(FURTHER, 1e6f);
    step();
    TEST_ASSERT_FLOAT_WITHIN(1, 101325.0f * 2, (float)block.model.inputs.pressure_top);
    TEST_ASSERT_EQUAL(0, block.model.restarts);
}

static void a_plant_that_goes_away_while_it_settles_leaves_the_state_to_the_work(void)
{
    begin();
    steps(20);
    TEST_ASSERT_NULL(kind->verb[0].run(&block, NULL));
    block.model.x[0] = 0.125f;
    kind->follow(&block, &io);
    TEST_ASSERT_EQUAL_FLOAT(0.125f, block.model.x[0]);
    TEST_ASSERT_FALSE(block.begun);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_reading_that_jumps_is_not_believed);
    RUN_TEST(what_goes_on_being_far_away_is_believed_after_a_time);
    RUN_TEST(a_jump_that_comes_back_counts_anew);
    RUN_TEST(readings_on_the_gate_s_near_side_are_taken);
    RUN_TEST(before_it_had_time_to_find_its_plant_all_readings_are_taken);
    RUN_TEST(a_reading_that_another_of_its_section_contradicts_waits_for_as_long);
    RUN_TEST(at_a_limit_of_its_mole_fraction_the_integral_gathers_no_more);
    RUN_TEST(without_a_gate_everything_is_believed);
    RUN_TEST(while_another_of_its_section_agrees_it_is_never_believed);
    RUN_TEST(one_of_the_other_section_or_that_moves_nothing_does_not_contradict);
    RUN_TEST(where_all_of_a_section_are_far_away_they_are_believed_after_the_time);
    RUN_TEST(what_a_missing_temperature_had_learned_fades);
    RUN_TEST(what_is_forgotten_within_a_step_is_forgotten_whole);
    RUN_TEST(only_a_good_temperature_draws);
    RUN_TEST(a_temperature_that_is_only_compared_does_not_move_the_model);
    RUN_TEST(a_flow_that_is_missing_stays_as_it_was);
    RUN_TEST(other_settings_leave_the_estimate_and_its_past);
    RUN_TEST(other_gains_leave_what_the_integral_does);
    RUN_TEST(another_table_is_a_fresh_beginning);
    RUN_TEST(temperatures_elsewhere_are_a_fresh_beginning);
    RUN_TEST(inputs_of_another_meaning_are_a_fresh_beginning);
    RUN_TEST(another_method_is_a_fresh_beginning);
    RUN_TEST(it_settles_to_the_steady_state_of_its_model_at_the_inputs_that_there_are);
    RUN_TEST(while_it_settles_it_does_not_begin);
    RUN_TEST(where_the_model_has_no_solution_it_does_not_settle);
    RUN_TEST(what_the_model_cannot_bear_is_kept_at_its_limits);
    RUN_TEST(a_plant_that_goes_away_while_it_settles_leaves_the_state_to_the_work);
    return UNITY_END();
}

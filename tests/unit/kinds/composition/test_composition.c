/* The estimator of compositions as a block: what it takes, what it gives, how it follows its plant. */
#include "composition_bench.h"

void setUp(void)
{
    bench_pilot();
}

void tearDown(void) {}

static float plant_fraction(unsigned stage)
{
    return (float)column_fraction(&plant.model.column, plant.model.x, stage - 1, 0);
}

/* Nowhere near the plant. */
static void start_far_away(void)
{
    begin();
    for (unsigned s = 0; s < 12; s++)
        block.model.x[s] *= 0.6f;
}

/* ---- follows ---- */

static void at_the_steady_state_of_the_table_it_stays_there(void)
{
    begin();
    steps(200);
    for (unsigned s = 0; s < 12; s++)
        TEST_ASSERT_FLOAT_WITHIN(2e-4f, plant.model.table.profile[s], block.model.x[s]);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, plant.model.table.profile[11], given(TOP_FRACTION));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, plant.model.table.profile[0], given(BOTTOM_FRACTION));
    TEST_ASSERT_FLOAT_WITHIN(0.05f, truth(7), given(INNER_TEMPERATURE));
}

static void comes_to_the_plant_from_far_away(void)
{
    start_far_away();
    steps(1440);
    TEST_ASSERT_FLOAT_WITHIN(2e-3f, plant_fraction(12), given(TOP_FRACTION));
    TEST_ASSERT_FLOAT_WITHIN(2e-3f, plant_fraction(1), given(BOTTOM_FRACTION));
    TEST_ASSERT_FLOAT_WITHIN(0.1f, truth(7), given(INNER_TEMPERATURE));
}

static void from_far_away_the_geometric_estimator_comes_to_the_plant(void)
{
    comes_to_the_plant_from_far_away();
}

static void from_far_away_the_reduced_filter_comes_to_the_plant(void)
{
    all_settings.s.method = METHOD_REKF;
    comes_to_the_plant_from_far_away();
}

static void it_is_faster_than_its_model_alone(void)
{
    float far[2];
    for (unsigned alone = 0; alone < 2; alone++) {
        setUp();
        start_far_away();
        if (alone)
            quality[T_LOW] = quality[T_HIGH] = QUALITY_BAD;
        steps(60);
        far[alone] = fabsf(plant_fraction(10) - block.model.x[9]);
    }
    TEST_ASSERT_TRUE(far[0] < 0.3f * far[1]);
}

/* Of a heat that is not what it was said to be: the integral takes what is left of a temperature. */
static void an_integral_takes_what_the_gain_leaves(void)
{
    begin();
    plant.model.inputs.heat += 20;
    plant_runs(4000);
    steps(4000);
    TEST_ASSERT_FLOAT_WITHIN(0.02f, 0, shown("e_1"));
    TEST_ASSERT_FLOAT_WITHIN(0.02f, 0, shown("e_2"));
    TEST_ASSERT_TRUE(fabsf(block.sensors.sensor[1].sum) > 10);
}

/* d(dx/dt)/dx of a stage's fraction, by a difference. */
static double rate_by_itself(unsigned at)
{
    static struct column_table table;
    static struct column column;
    real_t x[COLUMN_STATES_MAX], rates[COLUMN_STATES_MAX], difference = 0;
    struct column_fault why;
    TEST_ASSERT_EQUAL(ERR_OK, column_record_open(&record, &table, &column));
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &block.model.inputs, &why));
    for (int side = -1; side <= 1; side += 2) {
        memcpy(x, block.model.x, sizeof x);
        x[at] += REAL_C(2e-3) * (real_t)side;
        TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
        difference += (real_t)side * rates[at];
    }
    return (double)difference / 4e-3;
}

/* A temperature that is not there: what the reduced filter knows of its fraction is less in each step. */
static void the_variance_of_a_fraction_grows_by_its_own_rate(void)
{
    static const uint16_t stages[] = {2, 3, 4, 5, 6, 11, 12};
    for (unsigned k = 0; k < sizeof stages / sizeof stages[0]; k++) {
        setUp();
        all_settings.s.method = METHOD_REKF;
        all_settings.s.place[T_LOW][AT_STAGE] = stages[k];
        begin();
        quality[T_LOW] = quality[T_HIGH] = QUALITY_BAD;
        steps(2);
        double h = (double)block.model.h, rate = rate_by_itself(stages[k] - 1u);
        double part = exp(2 * rate * h), before = (double)block.sensors.sensor[0].variance;
        double wanted = part * before + (double)block.sensors.model2 * (part - 1) / (2 * rate);
        step();
        /* On the feed's stage the difference also has what a cold feed condenses. */
        TEST_ASSERT_DOUBLE_WITHIN((stages[k] == 5 ? 2e-2 : 1e-3) * wanted, wanted,
                                  (double)block.sensors.sensor[0].variance);
    }
}

/* ---- ticks ---- */

static void in_its_first_tick_it_gives_the_profile_and_makes_no_step(void)
{
    begin(); /* makes that tick */
    for (unsigned s = 0; s < 12; s++)
        TEST_ASSERT_EQUAL_FLOAT(block.model.table.profile[s], block.model.x[s]);
    TEST_ASSERT_EQUAL(0, block.judge.steps);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, point_quality[TOP_FRACTION]);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, block.model.table.profile[11], given(TOP_FRACTION));
    step();
    TEST_ASSERT_EQUAL(1, block.judge.steps);
}

static void in_its_first_tick_a_temperature_is_that_of_the_profile(void)
{
    begin();
    TEST_ASSERT_FLOAT_WITHIN(0.05f, truth(7), given(INNER_TEMPERATURE));
}

static void after_the_plant_was_away_it_begins_again(void)
{
    begin();
    quality[T_COMPARED] = QUALITY_BAD;
    put(T_LOW, truth(3) + 3);
    steps(400);
    TEST_ASSERT_TRUE(block.sensors.sensor[0].sum > 0);
    kind->follow(&block, &io);
    step();
    TEST_ASSERT_EQUAL(0, block.judge.steps);
    TEST_ASSERT_EQUAL_FLOAT(0, block.sensors.sensor[0].sum);
    TEST_ASSERT_EQUAL_FLOAT(block.model.table.profile[2], block.model.x[2]);
    TEST_ASSERT_EQUAL(0, block.watch.steps);
}

static void asked_to_begin_it_takes_the_profile_of_the_table(void)
{
    begin();
    put(T_LOW, truth(3) + 3);
    steps(200);
    TEST_ASSERT_NULL(kind->verb[1].run(&block, NULL));
    TEST_ASSERT_EQUAL_FLOAT(block.model.table.profile[2], block.model.x[2]);
    TEST_ASSERT_EQUAL_FLOAT(0, block.sensors.sensor[0].sum);
    step();
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, point_quality[0]);
    TEST_ASSERT_EQUAL(1, block.judge.steps);
}

/* ---- what comes in and goes out ---- */

static void flows_are_taken_in_the_units_that_are_given(void)
{
    all_settings.s.si[HEAT][UNIT_FACTOR] = 1000;
    all_settings.s.si[HEAT][UNIT_ZERO] = 50;
    setup.input[HEAT] = (struct block_signal){-1, 2, false};
    begin();
    put(FEED, 7.2f);
    put(HEAT, 0.9f);
    put(REFLUX, 3.6f);
    step();
    TEST_ASSERT_FLOAT_WITHIN(1e-11f, 2e-6f, (float)block.model.column.inputs.feed_flow);
    TEST_ASSERT_FLOAT_WITHIN(1e-2f, 950 - 150, (float)block.model.column.inputs.heat);
    TEST_ASSERT_FLOAT_WITHIN(1e-11f, 1e-6f, (float)block.model.column.inputs.reflux_flow);
}

static void temperatures_are_taken_in_the_units_that_are_given(void)
{
    all_settings.s.si[T_LOW][UNIT_FACTOR] = 5.0f / 9.0f; /* Fahrenheit */
    all_settings.s.si[T_LOW][UNIT_ZERO] = 255.372f;
    setup.input[T_LOW] = (struct block_signal){100, 300, false};
    begin();
    put(T_LOW, (truth(3) + 2.0f - 255.372f) * 1.8f);
    step();
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 2, shown("e_1"));
}

static void a_pressure_and_the_state_of_the_feed_may_be_inputs(void)
{
    all_settings.s.role[FURTHER] = IS_PRESSURE;
    all_settings.s.role[FURTHER + 1] = IS_FEED_TEMPERATURE;
    setup.inputs += 2;
    setup.input[FURTHER] = (struct block_signal){0, 200000, false};
    setup.input[FURTHER + 1] = (struct block_signal){0, 1000, false};
    put(FURTHER, 101000);
    put(FURTHER + 1, 340);
    begin();
    step();
    TEST_ASSERT_FLOAT_WITHIN(1, 101000, (float)block.model.column.inputs.pressure_top);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 340, (float)block.model.column.inputs.feed_temperature);
    put(FURTHER + 1, 100);
    step();
    TEST_ASSERT_EQUAL_FLOAT(280, (float)block.model.column.inputs.feed_temperature);
    put(FURTHER + 1, 800);
    step();
    TEST_ASSERT_EQUAL_FLOAT(430, (float)block.model.column.inputs.feed_temperature);
}

static void a_boil_up_and_a_quality_of_the_feed_may_be_inputs(void)
{
    change_record(&record, COLUMN_TABLE_FEED_BASIS, 0);
    change_record(&record, COLUMN_TABLE_FEED, 0.0137f);
    change_record(&record, COLUMN_TABLE_FEED_BY, 1);
    change_record(&record, COLUMN_TABLE_FEED_STATE, 1);
    change_record(&record, COLUMN_TABLE_BOILUP_GIVEN, 1);
    change_record(&record, COLUMN_TABLE_HEAT_LOSS, 0);
    change_record(&record, COLUMN_TABLE_HEAT, 0.02f);
    all_settings.s.role[FEED] = IS_FEED_QUALITY;
    all_settings.s.role[HEAT] = IS_BOILUP;
    all_settings.s.si[FEED][UNIT_FACTOR] = 0;
    setup.input[FEED] = (struct block_signal){0, 2, false};
    setup.input[HEAT] = (struct block_signal){-1, 1, false};
    begin();
    put(FEED, 0.75f);
    put(HEAT, 0.021f);
    step();
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.75f, (float)block.model.column.inputs.feed_quality);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.021f, (float)block.model.column.inputs.boilup);
    put(HEAT, -0.5f);
    step();
    TEST_ASSERT_EQUAL_FLOAT(0, (float)block.model.column.inputs.boilup);
}

static void no_flow_is_less_than_nothing(void)
{
    begin();
    put(FEED, -1);
    put(HEAT, 100); /* less than is lost */
    put(REFLUX, -2);
    step();
    TEST_ASSERT_EQUAL_FLOAT(0, (float)block.model.column.inputs.feed_flow);
    TEST_ASSERT_EQUAL_FLOAT(0, (float)block.model.column.inputs.heat);
    TEST_ASSERT_EQUAL_FLOAT(0, (float)block.model.column.inputs.reflux_flow);
    TEST_ASSERT_FALSE(raised(EVENT_NO_STATE));
}

static void a_point_is_shown_by_factor_and_zero(void)
{
    all_settings.s.show[TOP_FRACTION][UNIT_FACTOR] = -100;
    all_settings.s.show[TOP_FRACTION][UNIT_ZERO] = 100;
    setup.point[TOP_FRACTION] = (struct block_signal){-10, 10, false};
    all_settings.s.show[INNER_TEMPERATURE][UNIT_ZERO] = -273.15f;
    setup.point[INNER_TEMPERATURE] = (struct block_signal){0, 200, false};
    begin();
    step();
    TEST_ASSERT_FLOAT_WITHIN(2e-3f, 100 - 100 * block.model.x[11], given(TOP_FRACTION));
    TEST_ASSERT_FLOAT_WITHIN(0.05f, truth(7) - 273.15f, given(INNER_TEMPERATURE));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, block.model.x[0], given(BOTTOM_FRACTION));
}

static void the_closing_component_has_the_rest(void)
{
    point_of(TOP_FRACTION, 12, 2);
    begin();
    step();
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1 - block.model.x[11], given(TOP_FRACTION));
}

static void by_mass_a_fraction_goes_with_its_molar_mass(void)
{
    all_settings.s.basis = BASIS_MASS;
    begin();
    step();
    float x = block.model.x[0], light = 0.13138834f * x, heavy = 0.1658334f * (1 - x);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, light / (light + heavy), given(BOTTOM_FRACTION));
}

static void a_temperature_is_that_at_the_end_of_the_step(void)
{
    begin();
    put(T_LOW, truth(3) + 4);
    put(T_HIGH, truth(10) - 4);
    all_settings.s.point[INNER_TEMPERATURE][AT_STAGE] = 10;
    block.s.point[INNER_TEMPERATURE][AT_STAGE] = 10;
    step();
    float now = given(INNER_TEMPERATURE);
    TEST_ASSERT_TRUE(fabsf(now - (float)block.model.column.temperature[9]) > 0.1f);
    float before = (float)block.model.column.temperature[9];
    step(); /* evaluates it there */
    TEST_ASSERT_FLOAT_WITHIN(0.02f * fabsf(now - before), (float)block.model.column.temperature[9],
                             now);
}

/* Nothing of the column boils lower than its lightest component. */
static void a_temperature_is_that_of_fractions_within_limits(void)
{
    temperature_at(T_HIGH, 12, 1);
    point_of(INNER_TEMPERATURE, 12, 0);
    begin();
    steps(2 * LOCKED);
    put(T_HIGH, truth(12) - 9);
    step();
    TEST_ASSERT_TRUE(shown("clipped") > 0);
    float now = given(INNER_TEMPERATURE);
    step();
    TEST_ASSERT_FLOAT_WITHIN(0.02f, (float)block.model.column.temperature[11], now);
}

/* ---- inner values ---- */

static void inner_values_have_the_number_of_their_input(void)
{
    temperature_at(FURTHER, 12, 1);
    setup.inputs++;
    begin();
    put(T_COMPARED, truth(7) + 1);
    put(FURTHER, truth(12) + 0.5f);
    step();
    TEST_ASSERT_EQUAL_FLOAT(12, shown("states"));
    TEST_ASSERT_EQUAL_FLOAT(0, shown("clipped"));
    TEST_ASSERT_EQUAL_FLOAT(0, shown("bounced"));
    TEST_ASSERT_EQUAL_FLOAT(block.model.column.flows.distillate, shown("distillate"));
    TEST_ASSERT_EQUAL_FLOAT(block.model.column.flows.bottoms, shown("bottoms"));
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 1, shown("e_3"));
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 0.5f, shown("e_7"));
    TEST_ASSERT_TRUE(shown("slope_1") < -10);
    TEST_ASSERT_EQUAL_FLOAT(block.sensors.sensor[3].slope, shown("slope_7"));
    float value;
    size_t n = 0;
    while (kind->describe(&block, n, &value))
        n++;
    TEST_ASSERT_EQUAL(5 + 4 * 5, n);
}

static void means_of_the_monitor_are_shown(void)
{
    begin();
    block.watch.sensor[1].pull = 7;
    block.watch.sensor[1].square = 4;
    block.watch.sensor[1].product = -1;
    TEST_ASSERT_EQUAL_FLOAT(7, shown("pull_2"));
    TEST_ASSERT_EQUAL_FLOAT(4, shown("nis_2"));
    TEST_ASSERT_EQUAL_FLOAT(-0.25f, shown("rho_2"));
    TEST_ASSERT_EQUAL_FLOAT(0, shown("rho_1"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(at_the_steady_state_of_the_table_it_stays_there);
    RUN_TEST(from_far_away_the_geometric_estimator_comes_to_the_plant);
    RUN_TEST(from_far_away_the_reduced_filter_comes_to_the_plant);
    RUN_TEST(it_is_faster_than_its_model_alone);
    RUN_TEST(an_integral_takes_what_the_gain_leaves);
    RUN_TEST(the_variance_of_a_fraction_grows_by_its_own_rate);
    RUN_TEST(in_its_first_tick_it_gives_the_profile_and_makes_no_step);
    RUN_TEST(in_its_first_tick_a_temperature_is_that_of_the_profile);
    RUN_TEST(after_the_plant_was_away_it_begins_again);
    RUN_TEST(asked_to_begin_it_takes_the_profile_of_the_table);
    RUN_TEST(flows_are_taken_in_the_units_that_are_given);
    RUN_TEST(temperatures_are_taken_in_the_units_that_are_given);
    RUN_TEST(a_pressure_and_the_state_of_the_feed_may_be_inputs);
    RUN_TEST(a_boil_up_and_a_quality_of_the_feed_may_be_inputs);
    RUN_TEST(no_flow_is_less_than_nothing);
    RUN_TEST(a_point_is_shown_by_factor_and_zero);
    RUN_TEST(the_closing_component_has_the_rest);
    RUN_TEST(by_mass_a_fraction_goes_with_its_molar_mass);
    RUN_TEST(a_temperature_is_that_at_the_end_of_the_step);
    RUN_TEST(a_temperature_is_that_of_fractions_within_limits);
    RUN_TEST(inner_values_have_the_number_of_their_input);
    RUN_TEST(means_of_the_monitor_are_shown);
    return UNITY_END();
}

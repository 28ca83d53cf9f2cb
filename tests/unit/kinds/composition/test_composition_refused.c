/* Settings of the kind `composition`: its parameters, and what is refused in which words. */
#include "base/workspace.h"
#include "composition_bench.h"
#include "kinds/composition/composition_job_state.h"

void setUp(void)
{
    bench_pilot();
}

void tearDown(void) {}

static void refused(const char *field, const char *words)
{
    TEST_ASSERT_EQUAL_MESSAGE(ERR_RANGE, kind->check(&setup, &fault), words);
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(fault.wanted, words), fault.wanted);
    bench_pilot();
    accepted();
}

static void its_parameters_are_those_that_boards_have_stored(void)
{
    static const struct {
        const char *name;
        unsigned id, rows, cols;
        float lo, hi, initial;
        const char *words;
    } page[] = {
        {"column", 1, 1, 1, 0, 4, 0, NULL},
        {"method", 2, 1, 1, 0, 0, 0, "geometric|rekf|ekf|kalman"},
        {"is", 3, 12, 1, 0, 0, 0,
         "temperature|feed|feed_temperature|feed_quality|reflux|heat|boilup|pressure|analysis"},
        {"place", 4, 12, 2, 0, 200, 0, NULL},
        {"tune", 5, 12, 2, 0, 1e4f, 0, NULL},
        {"si", 6, 12, 2, -1e9f, 1e9f, 0, NULL},
        {"point", 7, 8, 2, 0, 200, 0, NULL},
        {"show", 8, 8, 2, -1e9f, 1e9f, 0, NULL},
        {"noise", 9, 1, 1, 0, 100, 0, NULL},
        {"model", 10, 1, 1, 0, 100, 0, NULL},
        {"gate", 11, 1, 1, 0, 1000, 10, NULL},
        {"gate_time", 12, 1, 1, 0, 1e6f, 300, NULL},
        {"pull", 13, 1, 1, 0, 1e5f, 0, NULL},
        {"watch", 14, 1, 1, 1, 1e6f, 1800, NULL},
        {"nis", 15, 1, 1, 0, 1e6f, 400, NULL},
        {"alone", 16, 1, 1, 0, 1e7f, 600, NULL},
        {"apart", 18, 1, 1, 0, 1e5f, 0, NULL},
        {"doubt", 19, 1, 1, 0, 0, 0, "bad|uncertain"},
        {"basis", 20, 1, 1, 0, 0, 0, "mole|mass"},
        {"far", 21, 1, 1, 0, 1, 0.05f, NULL},
        {"late", 22, 1, 1, 0, 1e7f, 7200, NULL},
        {"reach", 23, 1, 1, 1, 1e6f, 3600, NULL},
        {"covariance", 24, 1, 1, 0, 0, 0, "full|band|steady"},
        {"cycle", 25, 1, 1, 0, 60, 0, NULL},
        {"feed_z", 26, 1, 1, 0, 1, 0.1f, NULL},
        {"feed_f", 27, 1, 1, -1, 1, -1, NULL},
        {"feed_time", 28, 1, 1, 60, 1e7f, 3600, NULL},
        {"analyser", 29, 1, 1, 1e-6f, 1, 5e-4f, NULL},
        {"offset", 30, 1, 1, 0, 1, 5e-3f, NULL},
        {"sure", 31, 1, 1, 0, 1, 0, NULL},
        {"nis_full", 32, 1, 1, 0, 1e6f, 4, NULL},
        {"of", 33, 8, 1, 0, 0, 0, "stage|feed_fraction|feed_flow"},
        {"return", 34, 8, 2, -1e9f, 1e9f, 0, NULL},
        {"sure_part", 35, 1, 1, 0, 10, 0.5f, NULL},
        {"lasting", 36, 1, 1, 0, 10, 0.25f, NULL},
        {"between", 17, 1, 1, 0, 0, 0, "line|mean"},
    };
    TEST_ASSERT_EQUAL(sizeof page / sizeof page[0], kind->parameters);
    for (unsigned i = 0; i < kind->parameters; i++) {
        const struct block_parameter *p = &kind->parameter[i];
        TEST_ASSERT_EQUAL_STRING(page[i].name, p->name);
        TEST_ASSERT_EQUAL_MESSAGE(page[i].id, p->id, p->name);
        TEST_ASSERT_EQUAL_MESSAGE(page[i].rows, p->rows, p->name);
        TEST_ASSERT_EQUAL_MESSAGE(page[i].cols, p->cols, p->name);
        TEST_ASSERT_EQUAL_FLOAT(page[i].initial, p->initial);
        if (page[i].words) {
            TEST_ASSERT_EQUAL_STRING(page[i].words, p->unit);
            continue;
        }
        TEST_ASSERT_EQUAL_FLOAT(page[i].lo, p->lo);
        TEST_ASSERT_EQUAL_FLOAT(page[i].hi, p->hi);
    }
}

static void it_is_an_estimator_that_names_a_column(void)
{
    TEST_ASSERT_EQUAL_STRING("composition", kind->name);
    TEST_ASSERT_EQUAL(STAGE_ESTIMATE, kind->stage);
    TEST_ASSERT_EQUAL(1, kind->names);
    TEST_ASSERT_EQUAL_STRING("column", kind->named_kind);
    TEST_ASSERT_EQUAL(0, kind->members_most);
    TEST_ASSERT_EQUAL(BLOCK_INPUTS_MAX, kind->inputs_most);
    TEST_ASSERT_EQUAL(BLOCK_POINTS_MAX, kind->points_most);
    TEST_ASSERT_EQUAL(BAD_INPUT_IS_TOLD, kind->bad_input);
    TEST_ASSERT_EQUAL(sizeof(struct composition_record), kind->settings_bytes);
    TEST_ASSERT_EQUAL(offsetof(struct composition_record, back), kind->returns);
    TEST_ASSERT_EQUAL(0, kind->bytes(&setup) % 8);
}

static void its_events_and_verbs_have_the_names_of_the_page(void)
{
    static const char *const codes[] = {"lost",  "alone",    "pull",     "nis",
                                        "apart", "no_state", "no_input", "no_boil"};
    TEST_ASSERT_EQUAL(COMPOSITION_EVENTS, kind->events);
    for (unsigned i = 0; i < kind->events; i++) {
        TEST_ASSERT_EQUAL_STRING(codes[i], kind->event[i].code);
        TEST_ASSERT_EQUAL(i == EVENT_LOST || i == EVENT_NO_BOIL ? BLOCK_INFO : BLOCK_ALARM,
                          kind->event[i].level);
    }
    static const char *const verbs[] = {"settle", "begin", "free", "take"};
    TEST_ASSERT_EQUAL(sizeof verbs / sizeof verbs[0], kind->verbs);
    for (unsigned i = 0; i < kind->verbs; i++) {
        TEST_ASSERT_EQUAL_STRING(verbs[i], kind->verb[i].name);
        TEST_ASSERT_EQUAL(ACCESS_ENGINEER, kind->verb[i].access);
    }
}

/* ---- the column ---- */

static void it_needs_a_block_with_a_column(void)
{
    setup.named = NULL;
    refused("column", "needs the number of a block");
    all_settings.s.column = 0;
    refused("column", "needs the number of a block");
    record.value[COLUMN_TABLE_EFFICIENCY] = 0.5f; /* and the checksum as it was */
    refused("column", "table that is in order");
}

static void it_serves_no_loop(void)
{
    setup.members = 1;
    refused("loops", "must be none");
}

static void mass_fractions_need_molar_masses(void)
{
    unsigned mass = COLUMN_TABLE_FIXED + COLUMN_TABLE_C_MASS;
    change_record(&record, COLUMN_TABLE_HOLDUP, 0); /* a column that needs none */
    change_record(&record, COLUMN_TABLE_FEED_BASIS, 0);
    change_record(&record, COLUMN_TABLE_REFLUX_BASIS, 0);
    change_record(&record, mass + COLUMN_TABLE_C_VALUES, 0);
    accepted();
    all_settings.s.basis = BASIS_MASS;
    refused("basis", "must be mole");
    all_settings.s.basis = BASIS_MASS;
    accepted();
}

/* NRTL with nothing in it, for two components. */
static void truncated_stages_need_an_ideal_liquid(void)
{
    float values[COLUMN_TABLE_MOST] = {0};
    unsigned behind = COLUMN_TABLE_FIXED + 2 * COLUMN_TABLE_C_VALUES;
    memcpy(values, pilot_values, behind * sizeof values[0]);
    memcpy(values + behind + 12, pilot_values + behind, 12 * sizeof values[0]);
    for (unsigned i = 0; i < 4; i++)
        values[behind + 8 + i] = i == 0 || i == 3 ? 0.0f : 0.3f;
    values[COLUMN_TABLE_ACTIVITY] = 2;
    put_record(&record, values, behind + 24);
    accepted();
    change_record(&record, COLUMN_TABLE_TRUNCATED, 1u << 7);
    refused("column", "without truncated stages");
    change_record(&record, COLUMN_TABLE_TRUNCATED, 1u << 7);
    accepted();
}

/* ---- inputs ---- */

static void a_temperature_needs_a_stage_of_the_column(void)
{
    temperature_at(T_LOW, 0, 1);
    refused("place", "1 to that of the condenser");
    temperature_at(T_LOW, 13, 1);
    refused("place", "1 to that of the condenser");
    temperature_at(T_LOW, 12, 1);
    temperature_at(T_HIGH, 1, 1);
    accepted();
}

static void a_temperature_moves_a_component_that_is_integrated_or_none(void)
{
    temperature_at(T_LOW, 3, 2);
    refused("place", "the closing one");
    temperature_at(T_LOW, 3, 0);
    temperature_at(T_HIGH, 10, 0);
    refused("place", "at least that moves a component");
    all_settings.s.role[T_COMPARED] = IS_PRESSURE; /* whose place counts for nothing */
    all_settings.s.place[T_COMPARED][OF_COMPONENT] = 1;
    temperature_at(T_LOW, 3, 0);
    temperature_at(T_HIGH, 10, 0);
    refused("place", "at least that moves a component");
}

static void a_temperature_is_not_on_a_truncated_stage_or_on_another_s(void)
{
    change_record(&record, COLUMN_TABLE_TRUNCATED, 1u << 6); /* stage 7 */
    refused("place", "truncated");
    temperature_at(T_HIGH, 3, 1);
    refused("place", "another stage");
    all_settings.s.place[FEED][AT_STAGE] = 12; /* of a flow it counts for nothing */
    temperature_at(FURTHER, 12, 1);
    setup.inputs++;
    accepted();
}

static void an_mv_is_no_temperature(void)
{
    setup.input[T_HIGH].is_mv = true;
    refused("is", "of an MV");
}

static void each_flow_is_there_once(void)
{
    all_settings.s.role[REFLUX] = IS_FEED;
    refused("is", "once");
    all_settings.s.role[T_COMPARED] = IS_PRESSURE;
    all_settings.s.role[REFLUX] = IS_PRESSURE;
    refused("is", "once");
}

static void flows_are_of_the_kind_that_the_table_has(void)
{
    all_settings.s.role[HEAT] = IS_BOILUP;
    refused("is", "heat or boilup");
    change_record(&record, COLUMN_TABLE_BOILUP_GIVEN, 1);
    change_record(&record, COLUMN_TABLE_HEAT_LOSS, 0);
    refused("is", "heat or boilup");
    all_settings.s.role[REFLUX] = IS_FEED_QUALITY;
    refused("is", "feed's temperature or quality");
    all_settings.s.role[REFLUX] = IS_FEED_TEMPERATURE;
    accepted();
    change_record(&record, COLUMN_TABLE_FEED_BASIS, 0);
    change_record(&record, COLUMN_TABLE_FEED_BY, 1);
    change_record(&record, COLUMN_TABLE_FEED_STATE, 1);
    refused("is", "feed's temperature or quality");
}

static void only_inputs_that_there_are_count(void)
{
    all_settings.s.role[FURTHER] = IS_FEED;
    all_settings.s.role[FURTHER + 1] = IS_BOILUP;
    accepted();
    setup.inputs = T_HIGH; /* one temperature alone */
    accepted();
    setup.inputs = 0;
    refused("place", "at least");
}

/* ---- points ---- */

static void a_point_of_the_feed_has_no_stage_and_a_component_as_it_needs_one(void)
{
    all_settings.s.quantity[BOTTOM_FRACTION] = OF_FEED_FRACTION;
    refused("point", "stage 0");
    all_settings.s.quantity[BOTTOM_FRACTION] = OF_FEED_FRACTION;
    point_of(BOTTOM_FRACTION, 0, 0);
    refused("point", "not the closing one");
    all_settings.s.quantity[BOTTOM_FRACTION] = OF_FEED_FRACTION;
    point_of(BOTTOM_FRACTION, 0, 2);
    refused("point", "not the closing one");
    all_settings.s.quantity[BOTTOM_FRACTION] = OF_FEED_FLOW;
    point_of(BOTTOM_FRACTION, 0, 1);
    refused("point", "component 0");
    all_settings.s.quantity[BOTTOM_FRACTION] = OF_FEED_FRACTION;
    point_of(BOTTOM_FRACTION, 0, 1);
    all_settings.s.quantity[INNER_TEMPERATURE] = OF_FEED_FLOW;
    point_of(INNER_TEMPERATURE, 0, 0);
    accepted();
}

static void it_needs_a_point_with_a_stage_and_a_component_of_the_table(void)
{
    setup.points = 0;
    refused("points", "one at least");
    point_of(BOTTOM_FRACTION, 0, 1);
    refused("point", "a stage for each");
    point_of(BOTTOM_FRACTION, 13, 1);
    refused("point", "a stage for each");
    point_of(BOTTOM_FRACTION, 12, 3);
    refused("point", "a component of the table, or 0");
    point_of(BOTTOM_FRACTION, 12, 2);
    accepted();
}

static void analysis_at(unsigned k, unsigned stage, unsigned component, float share)
{
    setup.inputs = (uint8_t)(k + 1);
    setup.input[k] = setup.input[T_LOW];
    all_settings.s.role[k] = IS_ANALYSIS;
    all_settings.s.place[k][AT_STAGE] = (uint16_t)stage;
    all_settings.s.place[k][OF_COMPONENT] = (uint16_t)component;
    all_settings.tune[k][TUNE_LAMBDA] = share;
}

static void an_analysis_has_a_place_a_share_and_is_no_mv(void)
{
    analysis_at(FURTHER, 12, 2, 1); /* the closing one may be analysed */
    accepted();
    analysis_at(FURTHER, 12, 2, 1.1f);
    refused("tune", "share");
    analysis_at(FURTHER, 12, 3, 0);
    refused("place", "stage and component");
    analysis_at(FURTHER, 12, 0, 0);
    refused("place", "stage and component");
    analysis_at(FURTHER, 13, 1, 0);
    refused("place", "stage and component");
    analysis_at(FURTHER, 12, 1, 0);
    setup.input[FURTHER].is_mv = true;
    refused("is", "MV");
}

static void there_are_two_analyses_at_most(void)
{
    for (unsigned k = 0; k < 2; k++)
        analysis_at(FURTHER + k, 12, 1, 0);
    accepted();
    analysis_at(FURTHER + 2, 12, 1, 0);
    refused("is", "two analyses");
}

/* ---- complete innovation ---- */

/* The splitter without truncated stages, estimated with a covariance. */
static void splitter_with(unsigned method, unsigned covariance)
{
    PUT_RECORD(&record, splitter_values);
    change_record(&record, COLUMN_TABLE_TRUNCATED, 0);
    change_record(&record, COLUMN_TABLE_TRUNCATED + 1, 0);
    all_settings.s.method = (uint8_t)method;
    all_settings.s.covariance = (uint8_t)covariance;
}

static void a_feed_is_found_by_as_many_temperatures_as_it_has_mole_fractions(void)
{
    for (unsigned method = METHOD_EKF; method <= METHOD_KALMAN; method++) {
        bench_pilot();
        splitter_with(method, COVARIANCE_BAND);
        accepted();
        temperature_at(T_LOW, 3, 0); /* only compared */
        refused("feed_z", "must be 0 with fewer temperatures");
        splitter_with(method, COVARIANCE_BAND);
        temperature_at(T_LOW, 3, 0);
        all_settings.s.feed_z = 0;
        all_settings.s.feed_f = 0.1f;
        accepted();
        bench_pilot();
        all_settings.s.method = (uint8_t)method;
        temperature_at(T_LOW, 3, 0); /* of two components one will do */
        accepted();
    }
}

static void complete_innovation_needs_all_stages(void)
{
    for (unsigned method = METHOD_EKF; method <= METHOD_KALMAN; method++)
        for (unsigned half = 0; half < 2; half++) {
            splitter_with(method, COVARIANCE_BAND);
            change_record(&record, COLUMN_TABLE_TRUNCATED + half, 1u << 6);
            refused("method", "must be geometric or rekf");
        }
}

static void three_analyses_are_refused_with_a_covariance_too(void)
{
    all_settings.s.method = METHOD_EKF;
    for (unsigned k = 0; k < 2; k++)
        analysis_at(FURTHER + k, 12, 1, 0);
    accepted();
    analysis_at(FURTHER + 2, 12, 1, 0);
    refused("is", "two analyses");
    all_settings.s.method = METHOD_KALMAN;
    for (unsigned k = 0; k < 6; k++)
        analysis_at(FURTHER + k, 12, 1, 0);
    refused("is", "two analyses");
}

static void up_to_which_size_a_covariance_has_room(void)
{
    unsigned m = COLUMN_COMPONENTS_MAX - 1, stages = COLUMN_STAGES_MAX;
    while (stages * m > COLUMN_STATES_MAX)
        stages--;
    TEST_ASSERT_TRUE(composition_job_bytes(COVARIANCE_FULL, 12, 1, 2) <= WORKSPACE_BYTES);
    TEST_ASSERT_TRUE(composition_job_bytes(COVARIANCE_FULL, 37, 2, 5) <= WORKSPACE_BYTES);
    TEST_ASSERT_TRUE(composition_job_bytes(COVARIANCE_BAND, stages, m, COVARIANCE_EXTRAS_MAX) <=
                     WORKSPACE_BYTES);
    TEST_ASSERT_FALSE(composition_job_bytes(COVARIANCE_FULL, 100, 2, 2) <= WORKSPACE_BYTES);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(its_parameters_are_those_that_boards_have_stored);
    RUN_TEST(it_is_an_estimator_that_names_a_column);
    RUN_TEST(its_events_and_verbs_have_the_names_of_the_page);
    RUN_TEST(it_needs_a_block_with_a_column);
    RUN_TEST(it_serves_no_loop);
    RUN_TEST(mass_fractions_need_molar_masses);
    RUN_TEST(truncated_stages_need_an_ideal_liquid);
    RUN_TEST(a_temperature_needs_a_stage_of_the_column);
    RUN_TEST(a_temperature_moves_a_component_that_is_integrated_or_none);
    RUN_TEST(a_temperature_is_not_on_a_truncated_stage_or_on_another_s);
    RUN_TEST(an_mv_is_no_temperature);
    RUN_TEST(each_flow_is_there_once);
    RUN_TEST(flows_are_of_the_kind_that_the_table_has);
    RUN_TEST(only_inputs_that_there_are_count);
    RUN_TEST(a_point_of_the_feed_has_no_stage_and_a_component_as_it_needs_one);
    RUN_TEST(it_needs_a_point_with_a_stage_and_a_component_of_the_table);
    RUN_TEST(an_analysis_has_a_place_a_share_and_is_no_mv);
    RUN_TEST(there_are_two_analyses_at_most);
    RUN_TEST(a_feed_is_found_by_as_many_temperatures_as_it_has_mole_fractions);
    RUN_TEST(complete_innovation_needs_all_stages);
    RUN_TEST(three_analyses_are_refused_with_a_covariance_too);
    RUN_TEST(up_to_which_size_a_covariance_has_room);
    return UNITY_END();
}

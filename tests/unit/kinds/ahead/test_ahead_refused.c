/* Settings of the kind `ahead`: its parameters, and what is refused in which words. */
#include "ahead_bench.h"

void setUp(void)
{
    bench_pilot();
}

void tearDown(void) {}

static void refused(unsigned member, const char *field, const char *words)
{
    TEST_ASSERT_EQUAL_MESSAGE(ERR_RANGE, kind->check(&setup, &fault), words);
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_EQUAL_MESSAGE(member, fault.member, words);
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
        {"is", 2, 12, 1, 0, 0, 0,
         "temperature|fraction|feed_fraction|feed|feed_temperature|feed_quality|reflux|heat|boilup|"
         "pressure"},
        {"place", 3, 12, 2, 0, 200, 0, NULL},
        {"si", 4, 12, 2, -1e9f, 1e9f, 0, NULL},
        {"moves", 5, 1, 4, 0, 12, 0, NULL},
        {"target", 6, 4, 2, 0, 200, 0, NULL},
        {"pv_si", 7, 4, 2, -1e9f, 1e9f, 0, NULL},
        {"tau", 8, 1, 4, 0, 1e6f, 0, NULL},
        {"miss", 9, 1, 1, 0, 1e6f, 0, NULL},
        {"far", 10, 1, 4, 0, 1e6f, 0, NULL},
        {"trust", 11, 1, 1, 0.01f, 1, 1, NULL},
        {"basis", 12, 1, 1, 0, 0, 0, "mole|mass"},
        {"parts", 13, 1, 1, 1, 16, 3, NULL},
        {"doubt", 14, 1, 1, 0, 1, 0.4f, NULL},
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

static void it_needs_one_to_four_loops_and_a_table(void)
{
    setup.members = 0;
    refused(0, "loops", "one to four");
    setup.members = 5;
    refused(0, "loops", "one to four");
    setup.named = NULL;
    refused(0, "column", "block of the kind column");
    settings.column = 0;
    refused(0, "column", "block of the kind column");
    record.checksum[0] ^= 1;
    refused(0, "column", "table that is in order");
}

static void a_table_with_truncated_stages_is_refused(void)
{
    PUT_RECORD(&record, splitter_values);
    TEST_ASSERT_EQUAL(ERR_RANGE, kind->check(&setup, &fault));
    TEST_ASSERT_NOT_NULL(strstr(fault.wanted, "truncated"));
}

static void each_input_needs_a_place_that_the_column_has(void)
{
    settings.place[2][AHEAD_STAGE] = 13;
    refused(0, "place", "stage, 1 to that of the condenser");
    settings.place[2][AHEAD_STAGE] = 0;
    refused(0, "place", "stage, 1 to that of the condenser");
    settings.place[2][AHEAD_COMPONENT] = 2;
    refused(0, "place", "not the closing one");
    settings.place[2][AHEAD_COMPONENT] = 0;
    refused(0, "place", "component of the table");
    settings.place[2][AHEAD_STAGE] = (uint16_t)stage_seen[0];
    refused(0, "place", "once");
    setup.input[2].is_mv = true;
    refused(0, "is", "of an MV");
}

static void what_drives_the_column_is_told_once_and_as_the_table_has_it(void)
{
    settings.role[IN_FEED] = AHEAD_REFLUX;
    refused(0, "is", "once");
    settings.role[IN_FEED] = AHEAD_BOILUP;
    refused(0, "is", "heat or boilup");
    settings.role[IN_FEED] = AHEAD_FEED_QUALITY;
    refused(0, "is", "temperature or quality");
    settings.role[IN_FEED] = AHEAD_FEED_FRACTION;
    refused(0, "place", "not the closing one");
    settings.role[IN_FEED] = AHEAD_FEED_FRACTION;
    settings.place[IN_FEED][AHEAD_COMPONENT] = 1;
    accepted();
}

static void each_loop_needs_an_mv_of_its_own_among_the_inputs(void)
{
    settings.moves[BOTTOM] = 0;
    refused(BOTTOM, "moves", "number of an input");
    settings.moves[BOTTOM] = IN_ALL + 1;
    refused(BOTTOM, "moves", "number of an input");
    settings.moves[BOTTOM] = 1;
    refused(BOTTOM, "moves", "number of an input");
    settings.moves[BOTTOM] = settings.moves[TOP];
    refused(BOTTOM, "moves", "another MV");
    setup.member[TOP].drives_mv = false;
    refused(TOP, "loops", "move an MV");
}

static void each_loop_needs_a_place_and_a_time_constant(void)
{
    settings.target[TOP][AHEAD_STAGE] = 0;
    refused(TOP, "target", "stage");
    settings.target[BOTTOM][AHEAD_STAGE] = 13;
    refused(BOTTOM, "target", "stage");
    settings.target[BOTTOM][AHEAD_COMPONENT] = 2;
    refused(BOTTOM, "target", "closing one");
    settings.tau_s[BOTTOM] = 0;
    refused(BOTTOM, "tau", "above 0");
    settings.tau_s[TOP] = NAN;
    refused(TOP, "tau", "above 0");
}

static void fractions_by_mass_need_molar_masses(void)
{
    float values[sizeof pilot_values / sizeof pilot_values[0]];
    memcpy(values, pilot_values, sizeof values);
    settings.basis = AHEAD_MASS;
    accepted();
    values[COLUMN_TABLE_FIXED + COLUMN_TABLE_C_MASS] = 0;
    PUT_RECORD(&record, values);
    if (kind->check(&setup, &fault) != ERR_OK) /* the table itself may ask for them */
        TEST_ASSERT_NOT_NULL(strstr("basis column", fault.field));
}

static void refused_settings_need_no_memory(void)
{
    setup.named = NULL;
    TEST_ASSERT_EQUAL(0, kind->bytes(&setup));
    setup.named = &record;
    record.size = 3;
    TEST_ASSERT_EQUAL(0, kind->bytes(&setup));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(its_parameters_are_those_that_boards_have_stored);
    RUN_TEST(it_needs_one_to_four_loops_and_a_table);
    RUN_TEST(a_table_with_truncated_stages_is_refused);
    RUN_TEST(each_input_needs_a_place_that_the_column_has);
    RUN_TEST(what_drives_the_column_is_told_once_and_as_the_table_has_it);
    RUN_TEST(each_loop_needs_an_mv_of_its_own_among_the_inputs);
    RUN_TEST(each_loop_needs_a_place_and_a_time_constant);
    RUN_TEST(fractions_by_mass_need_molar_masses);
    RUN_TEST(refused_settings_need_no_memory);
    return UNITY_END();
}

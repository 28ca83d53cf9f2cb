/* Reading the compact table of a column: what each value must be, said by the name of the field. Tables are made from the
 * simulated plants and read with the code of the board, in float. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "columns/table_task.h"
#include "plants/plant_library.h"
#include "unity.h"

#define SUBSET "C3,iC4,nC4"

static struct table_lines whole;
static struct table_says says;
static char words[1024];

static bool made(struct table_lines *lines, const char *plant, struct table_task task)
{
    const struct plant_class *class = plant_open(plant, words, sizeof words);
    TEST_ASSERT_NOT_NULL_MESSAGE(class, words);
    struct plant *p = plant_create(class, words, sizeof words);
    TEST_ASSERT_NOT_NULL_MESSAGE(p, words);
    bool good = table_task_make(class, p, &task, lines, &says, words, sizeof words);
    class->destroy(p);
    return good;
}

void setUp(void)
{
    static struct table_lines kept;
    if (!kept.size)
        TEST_ASSERT_TRUE_MESSAGE(
            made(&kept, "splitter",
                 (struct table_task){.components = SUBSET, .truncated = "2-9,12"}),
            words);
    whole = kept;
}

void tearDown(void) {}

/* With the checksum that belongs to it: a table that somebody made so. */
static void is_refused(unsigned place, float value, const char *begin)
{
    struct table_lines lines = whole;
    lines.value[place] = value;
    table_close(&lines, lines.size);
    words[0] = '\0';
    TEST_ASSERT_FALSE_MESSAGE(table_check(&lines, &says, words, sizeof words), begin);
    TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(begin, words, strlen(begin), words);
}

/* ---- refused ---- */

static void every_field_is_refused_by_its_name_with_what_would_be_right(void)
{
    enum { FIRST = COLUMN_TABLE_FIXED, SECOND = COLUMN_TABLE_FIXED + COLUMN_TABLE_C_VALUES };
    static const struct {
        unsigned place;
        float value;
        const char *words;
    } wrong[] = {
        {COLUMN_TABLE_TITLE, 0.5f, "name: must be 1 to 15 letters"},
        {COLUMN_TABLE_TITLE, 0.0f, "name: must be"},
        {COLUMN_TABLE_TITLE, 16777216.0f, "name: must be"},
        {COLUMN_TABLE_N_STAGES, 3.0f, "stages: must be 4 to 40"},
        {COLUMN_TABLE_N_STAGES, 41.0f, "stages: must be 4 to 40"},
        {COLUMN_TABLE_N_STAGES, 36.0f, "size: must be that of its stages"},
        {COLUMN_TABLE_N_STAGES, 37.5f, "stages: must be"},
        {COLUMN_TABLE_N_STAGES, -37.0f, "stages: must be"},
        {COLUMN_TABLE_N_COMPONENTS, 1.0f, "components: must be 2 to 4"},
        {COLUMN_TABLE_N_COMPONENTS, 5.0f, "components: must be 2 to 4"},
        {COLUMN_TABLE_FEED_STAGE, 1.0f, "feed_stage: must be 2 to stages - 2"},
        {COLUMN_TABLE_FEED_STAGE, 36.0f, "feed_stage: must be"},
        {COLUMN_TABLE_FEED_STAGE, 12.0f, "truncated: must be stages from 2 to stages - 1, not"},
        {COLUMN_TABLE_EFFICIENCY, 0.0f, "efficiency: must be"},
        {COLUMN_TABLE_PRESSURE_DROP, -1.0f, "pressure_drop: must be"},
        {COLUMN_TABLE_HOLDUP, 3.0f, "holdup: must be 0 molar"},
        {COLUMN_TABLE_HOLDUP_REBOILER, 0.0f, "holdup_reboiler: must be above 0"},
        {COLUMN_TABLE_HOLDUP_TRAY, -1.0f, "holdup_tray: must be"},
        {COLUMN_TABLE_HOLDUP_CONDENSER, 0.0f, "holdup_condenser: must be"},
        {COLUMN_TABLE_HOLDUP_BOTTOM_K, 100.0f, "holdup_temperature_bottom: must be"},
        {COLUMN_TABLE_HOLDUP_TOP_K, 500.0f, "holdup_temperature_top: must be"},
        {COLUMN_TABLE_LOWEST_K, 20.0f, "temperature_min: must be 50 to 1000 K"},
        {COLUMN_TABLE_HIGHEST_K, 200.0f, "temperature_max: must be"},
        {COLUMN_TABLE_SOFTNESS, 0.6f, "limit_softness: must be 0.001 to 0.5"},
        {COLUMN_TABLE_ACTIVITY, 1.0f, "size: must be that of its stages"},
        {COLUMN_TABLE_ACTIVITY, 3.0f, "activity: must be 0 ideal"},
        {COLUMN_TABLE_FEED_BASIS, 3.0f, "feed_basis: must be"},
        {COLUMN_TABLE_FEED, -1.0f, "feed_flow: must be 0 or more"},
        {COLUMN_TABLE_FEED_BY, 2.0f, "feed_state: must be"},
        {COLUMN_TABLE_FEED_STATE, 500.0f, "feed_temperature: must be"},
        {COLUMN_TABLE_REFLUX_BASIS, 0.5f, "reflux_basis: must be"},
        {COLUMN_TABLE_REFLUX, -1.0f, "reflux_flow: must be"},
        {COLUMN_TABLE_SUBCOOLING, 101.0f, "reflux_subcooling: must be 0 to 100 K"},
        {COLUMN_TABLE_BOILUP_GIVEN, 2.0f, "boilup_given: must be"},
        {COLUMN_TABLE_HEAT, -1.0f, "heat: must be"},
        {COLUMN_TABLE_HEAT_LOSS, -1.0f, "heat_loss: must be 0 or more"},
        {COLUMN_TABLE_PRESSURE, 0.0f, "pressure_top: must be"},
        {COLUMN_TABLE_TRUNCATED, 1.0f, "truncated: must be"},                  /* the reboiler */
        {COLUMN_TABLE_TRUNCATED, (float)(1u << 18), "truncated: must be"},     /* the feed stage */
        {COLUMN_TABLE_TRUNCATED + 1, (float)(1u << 12), "truncated: must be"}, /* the condenser */
        {COLUMN_TABLE_TRUNCATED + 1, (float)(1u << 13), "truncated: must be"}, /* above it */
        {COLUMN_TABLE_TRUNCATED, 0.5f, "truncated: must be"},
        {FIRST + COLUMN_TABLE_C_NAME, 0.0f, "component.name: must be 1 to 15"},
        {SECOND + COLUMN_TABLE_C_ANTOINE + 2, -400.0f, "component.antoine: must be"},
        {SECOND + COLUMN_TABLE_C_MASS, 11.0f, "component.molar_mass: must be"},
        {SECOND + COLUMN_TABLE_C_MASS, 0.0f, "component.molar_mass: must be"},
        {FIRST + COLUMN_TABLE_C_DENSITY, -5.0f, "component.density: must be"},
        {FIRST + COLUMN_TABLE_C_HEAT, -1.0f, "component.vaporisation_heat: must be"},
        {FIRST + COLUMN_TABLE_C_BOILING, -1.0f, "component.boiling_point: must be"},
        {FIRST + COLUMN_TABLE_C_CRITICAL, 300.0f, "component.critical_temperature: must be"},
        {FIRST + COLUMN_TABLE_C_CAPACITY, -1.0f, "component.heat_capacity: must be"},
        {FIRST + COLUMN_TABLE_C_FEED, 0.282f, "feed_fraction: must be"},
        {FIRST + COLUMN_TABLE_C_FEED, -0.1f, "feed_fraction: must be"},
        {COLUMN_TABLE_FIXED + 3 * COLUMN_TABLE_C_VALUES, 1.1f, "profile: must be mole fractions"},
        {COLUMN_TABLE_FIXED + 3 * COLUMN_TABLE_C_VALUES + 73, 0.999f, "profile: must be"},
        {COLUMN_TABLE_FIXED + 3 * COLUMN_TABLE_C_VALUES, -1e-6f, "profile: must be"},
    };
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        is_refused(wrong[i].place, wrong[i].value, wrong[i].words);
}

static void no_value_may_be_no_number(void)
{
    static const float none[] = {NAN, INFINITY, -INFINITY};
    for (unsigned i = 0; i < whole.size; i += 7)
        is_refused(i, none[i % 3], "value: must be a number everywhere");
}

static void any_value_that_changes_is_seen(void)
{
    for (unsigned i = 0; i < COLUMN_TABLE_MOST; i++) {
        struct table_lines lines = whole;
        lines.value[i] = nextafterf(lines.value[i], 1e9f);
        TEST_ASSERT_FALSE(table_check(&lines, &says, words, sizeof words));
        TEST_ASSERT_EQUAL_STRING_LEN(i < whole.size ? "checksum: " : "value: must be 0 behind",
                                     words, i < whole.size ? 10 : 23);
    }
}

static void version_size_and_checksum_must_be_right(void)
{
    struct table_lines lines = whole;
    lines.version = 2;
    TEST_ASSERT_FALSE(table_check(&lines, &says, words, sizeof words));
    TEST_ASSERT_EQUAL_STRING("version: must be 1, of a table that is made for this firmware",
                             words);
    static const uint16_t sizes[] = {0, 1, 31, 281, 65535};
    for (unsigned i = 0; i < 5; i++) {
        lines = whole;
        lines.size = sizes[i];
        TEST_ASSERT_FALSE(table_check(&lines, &says, words, sizeof words));
        TEST_ASSERT_EQUAL_STRING("size: must be the number of values, at most those of 40 stages "
                                 "and 4 components",
                                 words);
    }
    lines = whole;
    table_close(&lines, whole.size + 1u); /* a whole checksum, of one value too many */
    TEST_ASSERT_FALSE(table_check(&lines, &says, words, sizeof words));
    TEST_ASSERT_EQUAL_STRING_LEN("size: must be that", words, 18);
}

static void two_components_need_two_names(void)
{
    struct table_lines lines = whole;
    float *first = lines.value + COLUMN_TABLE_FIXED;
    memcpy(first + COLUMN_TABLE_C_VALUES, first, COLUMN_TABLE_NAME * sizeof *first);
    table_close(&lines, lines.size);
    TEST_ASSERT_FALSE(table_check(&lines, &says, words, sizeof words));
    TEST_ASSERT_EQUAL_STRING("component.name: must be another for each component", words);
}

/* ---- made ---- */

static void the_table_says_what_was_asked_for(void)
{
    TEST_ASSERT_TRUE(table_check(&whole, &says, words, sizeof words));
    TEST_ASSERT_EQUAL_STRING("splitter", says.title);
    TEST_ASSERT_EQUAL(37, says.stages);
    TEST_ASSERT_EQUAL(19, says.feed_stage);
    TEST_ASSERT_EQUAL(9, says.truncated);
    TEST_ASSERT_EQUAL(37 * 2 - 9, says.states);
    TEST_ASSERT_EQUAL(32 + 3 * 19 + 37 * 2, whole.size);
    TEST_ASSERT_EQUAL_STRING("nC4", says.component[2]);
}

/* Components that are left out go to the closing one: the splitter's feed has 0.281 C3, 0.236 iC4. */
static void what_is_left_out_goes_to_the_closing_component(void)
{
    float *c = whole.value + COLUMN_TABLE_FIXED + COLUMN_TABLE_C_FEED;
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.281f, c[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.236f, c[COLUMN_TABLE_C_VALUES]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.483f, c[(size_t)2 * COLUMN_TABLE_C_VALUES]);
    TEST_ASSERT_TRUE(
        made(&whole, "splitter", (struct table_task){.components = SUBSET, .closing = "iC4"}));
    TEST_ASSERT_EQUAL_STRING("iC4", says.component[2]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.0f - 0.281f - 0.4746f, c[(size_t)2 * COLUMN_TABLE_C_VALUES]);
}

/* With all its components a column's table has the bubble points of the column. */
static void a_table_of_all_components_has_the_temperatures_of_the_column(void)
{
    const struct plant_class *class = plant_open("pilot", words, sizeof words);
    struct plant *p = plant_create(class, words, sizeof words);
    struct table_task task = {.block = 1};
    unsigned seen = 0;
    TEST_ASSERT_TRUE_MESSAGE(table_task_make(class, p, &task, &whole, &says, words, sizeof words),
                             words);
    for (size_t i = 0; i < class->n_channels; i++) {
        unsigned stage = 0;
        if (sscanf(class->channels[i].name, "T%u", &stage) != 1 || stage < 1 || stage > says.stages)
            continue;
        double kelvin = class->value(p, i) + (strcmp(class->channels[i].unit, "K") ? 273.15 : 0.0);
        bool near = false; /* channels of this plant count trays */
        for (unsigned s = 0; s < says.stages; s++)
            near = near || fabs(says.temperature[s] - kelvin) < 2e-3;
        TEST_ASSERT_TRUE_MESSAGE(near, class->channels[i].name);
        seen++;
    }
    TEST_ASSERT_TRUE(seen >= 5);
    class->destroy(p);
}

/* Files of columns with what the two above have not. */
static void a_column_of_constant_volatility_leaves_its_levels_behind(void)
{
    TEST_ASSERT_TRUE_MESSAGE(
        made(&whole, TABLE_DATA "/constant_volatility.json", (struct table_task){0}), words);
    TEST_ASSERT_EQUAL_STRING("constant_volati", says.title);
    TEST_ASSERT_EQUAL(40, says.states);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, whole.value[COLUMN_TABLE_FEED_BY]);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, whole.value[COLUMN_TABLE_BOILUP_GIVEN]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 3.206f / 60.0f, whole.value[COLUMN_TABLE_HEAT]);
    const float *light = whole.value + COLUMN_TABLE_FIXED;
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, logf(1.5f),
                             light[COLUMN_TABLE_C_ANTOINE] -
                                 light[COLUMN_TABLE_C_VALUES + COLUMN_TABLE_C_ANTOINE]);
}

static void activity_keeps_the_rows_and_columns_of_the_components_named(void)
{
    static const char file[] = TABLE_DATA "/methanol_ethanol_water.json";
    TEST_ASSERT_TRUE_MESSAGE(made(&whole, file, (struct table_task){0}), words);
    TEST_ASSERT_EQUAL(32 + 3 * 19 + 3 * 9 + 12 * 2, whole.size);
    TEST_ASSERT_EQUAL_FLOAT(2000.0f, whole.value[COLUMN_TABLE_HEAT_LOSS]);
    TEST_ASSERT_EQUAL_FLOAT(55000.0f, whole.value[COLUMN_TABLE_HEAT]);
    TEST_ASSERT_TRUE_MESSAGE(made(&whole, file, (struct table_task){.components = "H2O,MeOH"}),
                             words);
    const float *b = whole.value + COLUMN_TABLE_FIXED + (size_t)2 * COLUMN_TABLE_C_VALUES + 4;
    TEST_ASSERT_EQUAL_FLOAT(0.0f, b[0]);
    TEST_ASSERT_EQUAL_FLOAT(260.0f, b[1]); /* water, methanol */
    TEST_ASSERT_EQUAL_FLOAT(-50.0f, b[2]);
    TEST_ASSERT_EQUAL_FLOAT(0.3f, b[5]); /* alpha */
    is_refused(COLUMN_TABLE_FIXED + 2 * COLUMN_TABLE_C_VALUES + 1, 1e6f, "activity.a: must be");
    is_refused(COLUMN_TABLE_FIXED + 2 * COLUMN_TABLE_C_VALUES + 9, 2.0f, "activity.alpha: must be");
}

static void what_cannot_be_made_is_said_in_words(void)
{
    static const struct {
        struct table_task task;
        const char *plant, *words;
    } bad[] = {
        {{.components = NULL}, "splitter", "--components: a table has 4 components at most"},
        {{.components = "C3,C1"}, "splitter", "C1: no component of this column; there is"},
        {{.components = "C3,C3"}, "splitter", "--components: C3 stands there twice"},
        {{.components = "C3"}, "splitter", "--components: must name two or more"},
        {{.components = SUBSET, .closing = "C2"}, "splitter", "--closing C2: must be one"},
        {{.components = SUBSET, .truncated = "1-4"}, "splitter", "--truncated 1-4: must be stages"},
        {{.components = SUBSET, .truncated = "36-37"}, "splitter", "--truncated 36-37: must be"},
        {{.components = SUBSET, .truncated = "9-2"}, "splitter", "--truncated 9-2: must be"},
        {{.components = SUBSET, .truncated = "4-"}, "splitter", "--truncated 4-: must be"},
        {{.components = SUBSET, .truncated = "-4"}, "splitter", "--truncated -4: must be"},
        {{.components = SUBSET, .truncated = "12-22"}, "splitter", "--truncated 12-22: must leave"},
        {{.components = NULL}, "wood-berry", "--table: wood-berry is not a column"},
        {{.components = NULL}, "pilot-cold", "--table: pilot-cold is not a column"},
    };
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct table_lines lines;
        words[0] = '\0';
        TEST_ASSERT_FALSE_MESSAGE(made(&lines, bad[i].plant, bad[i].task), bad[i].words);
        TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(bad[i].words, words, strlen(bad[i].words), words);
    }
}

/* ---- as lines ---- */

static bool read_back(const char *text, struct table_lines lines[TABLE_BLOCKS],
                      bool has[TABLE_BLOCKS])
{
    FILE *from = fmemopen((void *)(uintptr_t)text, strlen(text), "r");
    TEST_ASSERT_NOT_NULL(from);
    bool good = table_lines_read(from, "f", lines, has, words, sizeof words);
    fclose(from);
    return good;
}

static void lines_are_read_back_to_the_bit(void)
{
    static struct table_lines lines[TABLE_BLOCKS];
    bool has[TABLE_BLOCKS];
    char *text;
    size_t size;
    FILE *to = open_memstream(&text, &size);
    table_lines_print(to, 3, &whole);
    fclose(to);
    TEST_ASSERT_TRUE_MESSAGE(read_back(text, lines, has), words);
    for (unsigned n = 0; n < TABLE_BLOCKS; n++)
        TEST_ASSERT_EQUAL(n == 2, has[n]);
    TEST_ASSERT_EQUAL_MEMORY(&whole, &lines[2], sizeof whole);
    free(text);
}

static void lines_that_are_none_are_named_by_their_number(void)
{
    static const char *const bad[][2] = {
        {"set block1.gain 3\n", "f: no line `set blockN.kind column`"},
        {"set block1.kind column\nset block1.value.1 1,2\n", "f:2: block1.value.1: must be eight"},
        {"set block1.kind column\n\nset block1.value.36 1\n",
         "f:3: block1.value.36: must be version"},
        {"set block1.kind column\nset block1.size -4\n",
         "f:2: block1.size: must be a whole number"},
        {"set block1.kind column\nset block1.checksum.1 4\n",
         "f:2: block1.checksum.1: must be two"},
        {"set block1.kind column\nset block1.value.1 1,2,3,4,5,6,7,nan\n", "f:2: block1.value.1"},
        {"set block1.kind column\nset block1.weight 1\n", "f:2: block1.weight: must be version"}};
    static struct table_lines lines[TABLE_BLOCKS];
    bool has[TABLE_BLOCKS];
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        TEST_ASSERT_FALSE_MESSAGE(read_back(bad[i][0], lines, has), bad[i][0]);
        TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(bad[i][1], words, strlen(bad[i][1]), words);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_field_is_refused_by_its_name_with_what_would_be_right);
    RUN_TEST(no_value_may_be_no_number);
    RUN_TEST(any_value_that_changes_is_seen);
    RUN_TEST(version_size_and_checksum_must_be_right);
    RUN_TEST(two_components_need_two_names);
    RUN_TEST(the_table_says_what_was_asked_for);
    RUN_TEST(what_is_left_out_goes_to_the_closing_component);
    RUN_TEST(a_table_of_all_components_has_the_temperatures_of_the_column);
    RUN_TEST(a_column_of_constant_volatility_leaves_its_levels_behind);
    RUN_TEST(activity_keeps_the_rows_and_columns_of_the_components_named);
    RUN_TEST(what_cannot_be_made_is_said_in_words);
    RUN_TEST(lines_are_read_back_to_the_bit);
    RUN_TEST(lines_that_are_none_are_named_by_their_number);
    plant_library_free();
    return UNITY_END();
}

/* The declaration of the parameters, each one of it: names, ids, defaults, ranges, refusals. */
#include <stdio.h>
#include <string.h>

#include "settings/parameters.h"
#include "unity.h"

static struct config config, before;
static char name[64], value[64], range[160];

void setUp(void)
{
    parameters_defaults(&config);
}
void tearDown(void) {}

static void texts(const struct parameter *p)
{
    struct text n = text_on(name, sizeof name), v = text_on(value, sizeof value),
                r = text_on(range, sizeof range);
    parameter_name(p, &n);
    parameter_value(p, &config, &v);
    parameter_range(p, &r);
}

static void refused(const struct parameter *p, const char *text)
{
    char message[200];
    before = config;
    snprintf(message, sizeof message, "set %s %s", name, text);
    TEST_ASSERT_NOT_EQUAL_MESSAGE(ERR_OK, parameter_set(p, &config, text), message);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&before, &config, sizeof config, message);
}

static bool number(const struct parameter *p)
{
    return p->field->type == PARAMETER_FLOAT || p->field->type == PARAMETER_U32 ||
           p->field->type == PARAMETER_U16;
}

static void every_parameter_is_found_by_its_name(void)
{
    struct parameter p, found;
    for (unsigned n = 0; parameter_at(n, &p); n++) {
        texts(&p);
        TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_find(name, &found), name);
        TEST_ASSERT_EQUAL_PTR(p.group, found.group);
        TEST_ASSERT_EQUAL_PTR(p.field, found.field);
        TEST_ASSERT_EQUAL(p.index, found.index);
    }
}

static void ids_and_places_are_unique(void)
{
    static uint8_t seen[32u << 12];
    struct parameter p;
    unsigned n = 0;
    memset(seen, 0, sizeof seen);
    for (; parameter_at(n, &p); n++) {
        texts(&p);
        TEST_ASSERT_TRUE_MESSAGE(p.field->id < 64 && p.group->id < 32 && p.index < 64, name);
        TEST_ASSERT_EQUAL_MESSAGE(0, seen[parameter_id(&p)]++, name);
    }
    TEST_ASSERT_TRUE(n > 300);
}

static void every_parameter_has_help_and_a_range_in_words(void)
{
    struct parameter p;
    for (unsigned n = 0; parameter_at(n, &p); n++) {
        texts(&p);
        TEST_ASSERT_TRUE_MESSAGE(strlen(p.field->help) > 5, name);
        TEST_ASSERT_TRUE_MESSAGE(range[0], name);
        TEST_ASSERT_NOT_NULL_MESSAGE(field_unit(p.field), name);
    }
}

static void every_default_is_in_its_range_and_reads_back_as_itself(void)
{
    struct parameter p;
    char initial[64];
    for (unsigned n = 0; parameter_at(n, &p); n++) {
        struct text d = text_on(initial, sizeof initial);
        texts(&p);
        parameter_default(&p, &config, &d);
        TEST_ASSERT_EQUAL_STRING_MESSAGE(initial, value, name);
        if (p.field->type == PARAMETER_FIXED)
            continue;
        before = config;
        TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_set(&p, &config, initial), name);
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&before, &config, sizeof config, name);
    }
}

static void what_is_no_number_or_outside_the_range_is_refused_and_nothing_changes(void)
{
    static const char *const bad[] = {"",     "abc", "1e",  "0x10", "nan",   "inf", "-inf",
                                      "1e99", "--1", "1 2", "1,5",  "-1e10", "1e10"};
    struct parameter p;
    for (unsigned n = 0; parameter_at(n, &p); n++) {
        texts(&p);
        if (!number(&p))
            continue;
        for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++)
            refused(&p, bad[i]);
    }
}

static void the_ends_of_each_range_are_accepted_and_what_is_beyond_is_not(void)
{
    struct parameter p;
    char text[40];
    for (unsigned n = 0; parameter_at(n, &p); n++) {
        texts(&p);
        if (!number(&p))
            continue;
        float lo = field_lo(p.field), hi = field_hi(p.field);
        snprintf(text, sizeof text, "%.9g", (double)hi);
        if (p.field->type != PARAMETER_FLOAT)
            snprintf(text, sizeof text, "%.0f", (double)hi);
        TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_set(&p, &config, text), name);
        snprintf(text, sizeof text, p.field->type == PARAMETER_FLOAT ? "%.9g" : "%.0f", (double)lo);
        TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_set(&p, &config, text), name);
        snprintf(text, sizeof text, "%.9g",
                 (double)hi + (hi < 0 ? -1e-5 : 1e-5) * (double)hi + 1e-6);
        refused(&p, text);
        snprintf(text, sizeof text, "%.9g",
                 (double)lo - (lo < 0 ? -1e-5 : 1e-5) * (double)lo - 1e-6);
        refused(&p, text);
    }
}

static void words_are_taken_whole_and_nothing_else(void)
{
    struct parameter p;
    for (unsigned n = 0; parameter_at(n, &p); n++) {
        if (p.field->type != PARAMETER_WORD)
            continue;
        texts(&p);
        refused(&p, field_words(p.field)); /* all of them at once */
        refused(&p, "");
        refused(&p, "1");
        refused(&p, "o");
        char words[320], *save = NULL; /* the pins of all ports */
        strcpy(words, field_words(p.field));
        for (char *w = strtok_r(words, "|", &save); w; w = strtok_r(NULL, "|", &save)) {
            TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_set(&p, &config, w), w);
            texts(&p);
            TEST_ASSERT_EQUAL_STRING(w, value);
        }
    }
}

static void names_are_letters_digits_and_underscore_up_to_fifteen(void)
{
    struct parameter p;
    for (unsigned n = 0; parameter_at(n, &p); n++) {
        if (p.field->type != PARAMETER_NAME)
            continue;
        texts(&p);
        refused(&p, "");
        refused(&p, "a b");
        refused(&p, "a,b");
        refused(&p, "a-b");
        refused(&p, "T\xC3\xA4");
        refused(&p, "sixteen_letters_");
        TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_set(&p, &config, "fifteen_letters"), name);
        texts(&p);
        TEST_ASSERT_EQUAL_STRING(parameter_is_secret(&p) ? "***" : "fifteen_letters", value);
        TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_set(&p, &config, "-"), name);
        texts(&p);
        TEST_ASSERT_EQUAL_STRING("-", value);
    }
}

static void units_are_printable_and_never_break_a_telemetry_header(void)
{
    struct parameter p;
    TEST_ASSERT_EQUAL(ERR_OK, parameter_find("meas1.unit", &p));
    texts(&p);
    refused(&p, "a,b");
    refused(&p, "a[b");
    refused(&p, "a]b");
    refused(&p, "m\x01");
    refused(&p, "twelve_bytes");
    TEST_ASSERT_EQUAL(ERR_OK, parameter_set(&p, &config, "kg/m3*s^-1%"));
    texts(&p);
    TEST_ASSERT_EQUAL_STRING("kg/m3*s^-1%", value);
}

static void the_schema_cannot_be_changed(void)
{
    struct parameter p;
    TEST_ASSERT_EQUAL(ERR_OK, parameter_find("config.schema", &p));
    before = config;
    TEST_ASSERT_EQUAL(ERR_READ_ONLY, parameter_set(&p, &config, "1"));
    TEST_ASSERT_EQUAL_MEMORY(&before, &config, sizeof config);
}

static void names_of_no_parameter_are_not_found(void)
{
    static const char *const none[] = {"",
                                       "loop",
                                       "loop1",
                                       "loop1.",
                                       "loop.gain",
                                       "loop0.gain",
                                       "loop17.gain",
                                       "loop1.gainx",
                                       "loop01.gain",
                                       "loop1.gai",
                                       "tick1.base",
                                       "loop99999999999.gain",
                                       "LOOP1.gain",
                                       "meas17.lo",
                                       "decouple1.d9",
                                       "decouple9.d1",
                                       ".",
                                       "tick.",
                                       "loop1.gain ",
                                       "loop1xgain",
                                       "loop1:gain",
                                       "tickxbase"};
    struct parameter p;
    for (unsigned i = 0; i < sizeof none / sizeof none[0]; i++)
        TEST_ASSERT_EQUAL_MESSAGE(ERR_UNKNOWN, parameter_find(none[i], &p), none[i]);
}

static void the_decoupler_is_the_identity_by_default(void)
{
    for (unsigned i = 0; i < DECOUPLER_MAX; i++)
        for (unsigned j = 0; j < DECOUPLER_MAX; j++)
            TEST_ASSERT_EQUAL_FLOAT(i == j ? 1 : 0, config.decoupler[i][j]);
}

static void setting_one_parameter_changes_no_other(void)
{
    struct parameter p, q;
    TEST_ASSERT_EQUAL(ERR_OK, parameter_find("loop3.ti", &p));
    before = config;
    TEST_ASSERT_EQUAL(ERR_OK, parameter_set(&p, &config, "123"));
    for (unsigned n = 0; parameter_at(n, &q); n++)
        TEST_ASSERT_EQUAL(!(q.field == p.field && q.index == p.index && q.group == p.group),
                          parameter_equal(&q, &before, &config));
}

static void set_both(const char *first, const char *value_1, const char *second,
                     const char *value_2)
{
    struct parameter p;
    TEST_ASSERT_EQUAL(ERR_OK, parameter_find(first, &p));
    TEST_ASSERT_EQUAL(ERR_OK, parameter_set(&p, &config, value_1));
    TEST_ASSERT_EQUAL(ERR_OK, parameter_find(second, &p));
    TEST_ASSERT_EQUAL(ERR_OK, parameter_set(&p, &config, value_2));
}

static void the_highest_output_is_the_end_of_the_span_until_it_has_a_value_of_its_own(void)
{
    struct parameter p;
    set_both("mv2.hi", "40", "mv3.hi", "400");
    TEST_ASSERT_EQUAL_FLOAT(40, config.mv[1].max);
    TEST_ASSERT_EQUAL_FLOAT(400, config.mv[2].max);
    TEST_ASSERT_EQUAL_FLOAT(100, config.mv[0].max);
    set_both("mv2.max", "30", "mv2.hi", "50");
    TEST_ASSERT_EQUAL_FLOAT(30, config.mv[1].max);
    set_both("mv4.hi", "200", "mv4.max",
             "100"); /* that which it would have had for a span to 100 */
    TEST_ASSERT_EQUAL_FLOAT(100, config.mv[3].max);
    TEST_ASSERT_EQUAL(ERR_OK, parameter_find("mv1.hi", &p));
    TEST_ASSERT_EQUAL(ERR_OK, parameter_set_number(&p, &config, 7));
    TEST_ASSERT_EQUAL_FLOAT(7, config.mv[0].max);
}

static void only_its_default_is_taken_for_the_default(void)
{
    struct parameter p;
    char text[40];
    for (unsigned n = 0; parameter_at(n, &p); n++) {
        parameters_defaults(&config); /* one default moves with another parameter */
        texts(&p);
        if (strcmp(p.group->name, "decouple") != 0) /* whose diagonal is 1 */
            TEST_ASSERT_TRUE_MESSAGE(parameter_is_default(&p, &config), name);
        if (!number(&p))
            continue;
        float there =
            field_hi(p.field) > field_initial(p.field) ? field_hi(p.field) : field_lo(p.field);
        snprintf(text, sizeof text, p.field->type == PARAMETER_FLOAT ? "%.9g" : "%.0f",
                 (double)there);
        TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_set(&p, &config, text), name);
        TEST_ASSERT_FALSE_MESSAGE(parameter_is_default(&p, &config), name);
    }
}

static void only_numbers_and_words_have_an_initial_value_and_only_numbers_a_range(void)
{
    struct parameter p;
    for (unsigned n = 0; parameter_at(n, &p); n++) {
        bool text = p.field->type == PARAMETER_NAME || p.field->type == PARAMETER_UNIT;
        texts(&p);
        if (number(&p))
            TEST_ASSERT_TRUE_MESSAGE(field_lo(p.field) <= field_initial(p.field) &&
                                         field_initial(p.field) <= field_hi(p.field),
                                     name);
        else if (text)
            TEST_ASSERT_TRUE_MESSAGE(field_lo(p.field) == 0.0f && field_hi(p.field) == 0.0f &&
                                         field_initial(p.field) == 0.0f,
                                     name);
        else if (p.field->type == PARAMETER_WORD)
            TEST_ASSERT_TRUE_MESSAGE(field_initial(p.field) < (float)parameter_words(&p), name);
    }
}

static void zero_has_one_sign(void)
{
    struct parameter p;
    before = config;
    TEST_ASSERT_EQUAL(ERR_OK, parameter_find("loop3.ti", &p));
    TEST_ASSERT_EQUAL(ERR_OK, parameter_set(&p, &config, "-0"));
    TEST_ASSERT_EQUAL_MEMORY(&before, &config, sizeof config);
}

static void a_secret_is_never_shown_and_what_is_shown_instead_changes_nothing(void)
{
    struct parameter p;
    struct config other = config;
    TEST_ASSERT_EQUAL(ERR_OK, parameter_find("console.key", &p));
    TEST_ASSERT_EQUAL(ERR_OK, parameter_set(&p, &config, "reflux7"));
    TEST_ASSERT_FALSE(parameter_equal(&p, &config, &other));
    texts(&p);
    TEST_ASSERT_EQUAL_STRING("***", value);
    other = config;
    TEST_ASSERT_EQUAL(ERR_OK, parameter_set(&p, &config, value));
    TEST_ASSERT_TRUE(parameter_equal(&p, &config, &other));
    TEST_ASSERT_EQUAL(ERR_OK, parameter_set(&p, &config, "-"));
    texts(&p);
    TEST_ASSERT_EQUAL_STRING("-", value);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_parameter_is_found_by_its_name);
    RUN_TEST(ids_and_places_are_unique);
    RUN_TEST(every_parameter_has_help_and_a_range_in_words);
    RUN_TEST(every_default_is_in_its_range_and_reads_back_as_itself);
    RUN_TEST(what_is_no_number_or_outside_the_range_is_refused_and_nothing_changes);
    RUN_TEST(the_ends_of_each_range_are_accepted_and_what_is_beyond_is_not);
    RUN_TEST(words_are_taken_whole_and_nothing_else);
    RUN_TEST(names_are_letters_digits_and_underscore_up_to_fifteen);
    RUN_TEST(a_secret_is_never_shown_and_what_is_shown_instead_changes_nothing);
    RUN_TEST(units_are_printable_and_never_break_a_telemetry_header);
    RUN_TEST(the_schema_cannot_be_changed);
    RUN_TEST(names_of_no_parameter_are_not_found);
    RUN_TEST(the_decoupler_is_the_identity_by_default);
    RUN_TEST(setting_one_parameter_changes_no_other);
    RUN_TEST(the_highest_output_is_the_end_of_the_span_until_it_has_a_value_of_its_own);
    RUN_TEST(only_its_default_is_taken_for_the_default);
    RUN_TEST(only_numbers_and_words_have_an_initial_value_and_only_numbers_a_range);
    RUN_TEST(zero_has_one_sign);
    return UNITY_END();
}

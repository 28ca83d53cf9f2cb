/* Numbers as text and back. Contract: every finite float survives text_float and text_float9 bit for bit. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "random_source.h"
#include "service/text.h"
#include "unity.h"

#define SEED 0x5EED0001u

static char buffer[64];
static struct text t;

void setUp(void)
{
    t = text_on(buffer, sizeof buffer);
}
void tearDown(void) {}

static float from_bits(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static void survives(float x, void (*write)(struct text *, float))
{
    char message[96];
    float back = 0;
    struct text line = text_on(buffer, sizeof buffer);
    write(&line, x);
    snprintf(message, sizeof message, "seed 0x%x, %s", SEED, buffer);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, text_parse_float(buffer, &back), message);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&x, &back, sizeof x, message);
}

static void every_finite_float_reads_back_bit_for_bit(void)
{
    struct random_source r = {SEED};
    for (unsigned n = 0; n < 100000; n++) {
        float x = from_bits((uint32_t)random_next(&r));
        if (!isfinite(x))
            continue;
        survives(x, text_float);
        survives(x, text_float9);
    }
}

static void the_ends_of_the_range_read_back(void)
{
    static const uint32_t bits[] = {0x00000000, 0x80000000, 0x00000001, 0x007FFFFF, 0x00800000,
                                    0x7F7FFFFF, 0xFF7FFFFF, 0x3F800000, 0x3DCCCCCD, 0x4B800001};
    for (unsigned i = 0; i < sizeof bits / sizeof bits[0]; i++) {
        survives(from_bits(bits[i]), text_float);
        survives(from_bits(bits[i]), text_float9);
    }
}

static void a_short_number_is_written_short(void)
{
    text_float(&t, 78.5f);
    text_char(&t, ' ');
    text_float(&t, 0.1f);
    text_char(&t, ' ');
    text_float(&t, -3.0f);
    TEST_ASSERT_EQUAL_STRING("78.5 0.1 -3", buffer);
}

static void numbers_people_write_are_read(void)
{
    static const struct {
        const char *text;
        float value;
    } good[] = {{"0", 0},   {"-0", -0.0f}, {"+5", 5},        {"5.", 5},         {".5", 0.5f},
                {"007", 7}, {"1e3", 1000}, {"1E-3", 0.001f}, {"-2.5e+2", -250}, {"1e-60", 0}};
    for (unsigned i = 0; i < sizeof good / sizeof good[0]; i++) {
        float x = 99;
        TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, text_parse_float(good[i].text, &x), good[i].text);
        TEST_ASSERT_EQUAL_FLOAT(good[i].value, x);
    }
}

static void what_is_no_number_is_refused_and_nothing_changes(void)
{
    static const char *const bad[] = {"",
                                      "abc",
                                      "1e",
                                      "0x10",
                                      "nan",
                                      "NaN",
                                      "inf",
                                      "-inf",
                                      "infinity",
                                      "--1",
                                      "1 2",
                                      " 1",
                                      "1 ",
                                      "1,5",
                                      ".",
                                      "-",
                                      "+",
                                      "e5",
                                      "1e+",
                                      "1.2.3",
                                      "1f",
                                      "1e5e5",
                                      "½",
                                      "1_000",
                                      "+-1",
                                      "1\n",
                                      "0b1",
                                      "1e0x2",
                                      "00000000000000000000000000000000000000001"};
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        float x = 99;
        TEST_ASSERT_EQUAL_MESSAGE(ERR_PARSE, text_parse_float(bad[i], &x), bad[i]);
        TEST_ASSERT_EQUAL_FLOAT(99, x);
    }
}

static void a_number_no_float_holds_is_out_of_range(void)
{
    float x = 99;
    TEST_ASSERT_EQUAL(ERR_RANGE, text_parse_float("1e99", &x));
    TEST_ASSERT_EQUAL(ERR_RANGE, text_parse_float("-3.5e38", &x));
    TEST_ASSERT_EQUAL(ERR_RANGE, text_parse_float("1e999999999999999999", &x));
    TEST_ASSERT_EQUAL_FLOAT(99, x);
}

static void whole_numbers_are_digits_only(void)
{
    uint32_t x = 7;
    static const char *const bad[] = {"", "-1", "+1", "1.0", "0x1", "1e3", " 1", "abc"};
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++)
        TEST_ASSERT_EQUAL_MESSAGE(ERR_PARSE, text_parse_u32(bad[i], &x), bad[i]);
    TEST_ASSERT_EQUAL(ERR_RANGE, text_parse_u32("4294967296", &x));
    TEST_ASSERT_EQUAL(ERR_RANGE, text_parse_u32("99999999999999999999", &x));
    TEST_ASSERT_EQUAL(7, x);
    TEST_ASSERT_EQUAL(ERR_OK, text_parse_u32("4294967295", &x));
    TEST_ASSERT_EQUAL_HEX32(0xFFFFFFFF, x);
}

static void whole_numbers_and_times_are_written_in_full(void)
{
    text_u32(&t, 0);
    text_char(&t, ' ');
    text_u32(&t, 4294967295u);
    text_char(&t, ' ');
    text_hex(&t, 0xBEEF, 4);
    text_char(&t, ' ');
    text_seconds(&t, 1230500);
    text_char(&t, ' ');
    text_seconds(&t, 7);
    TEST_ASSERT_EQUAL_STRING("0 4294967295 beef 1230.500 0.007", buffer);
    t = text_on(buffer, sizeof buffer);
    text_seconds(&t, UINT64_MAX);
    TEST_ASSERT_EQUAL_STRING("18446744073709551.615", buffer);
}

static void what_does_not_fit_is_cut_and_said_so(void)
{
    char small[6];
    memset(small, 'x', sizeof small);
    struct text s = text_on(small, 5);
    text_str(&s, "abcdefgh");
    TEST_ASSERT_EQUAL_STRING("abcd", small);
    TEST_ASSERT_TRUE(s.cut);
    TEST_ASSERT_EQUAL_CHAR('x', small[5]);
    s = text_on(small, 1);
    text_char(&s, 'a');
    TEST_ASSERT_EQUAL_STRING("", small);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_finite_float_reads_back_bit_for_bit);
    RUN_TEST(the_ends_of_the_range_read_back);
    RUN_TEST(a_short_number_is_written_short);
    RUN_TEST(numbers_people_write_are_read);
    RUN_TEST(what_is_no_number_is_refused_and_nothing_changes);
    RUN_TEST(a_number_no_float_holds_is_out_of_range);
    RUN_TEST(whole_numbers_are_digits_only);
    RUN_TEST(whole_numbers_and_times_are_written_in_full);
    RUN_TEST(what_does_not_fit_is_cut_and_said_so);
    return UNITY_END();
}

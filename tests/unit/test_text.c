/* Numbers as text and back. Contract: every finite float survives text_float and text_float9 bit for bit; both write
 * what the host's C library writes, and text_parse_float reads what it reads: correctly rounded, ties to even. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "random_source.h"
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

/* Four digits, and zeros in front of the point where the number is longer. */
static void writes_four_digits(float x)
{
    char four[40], want[40];
    struct text line = text_on(buffer, sizeof buffer);
    text_float4(&line, x);
    snprintf(four, sizeof four, "%.4g", (double)x);
    snprintf(want, sizeof want, "%.9g", strtod(four, NULL));
    TEST_ASSERT_EQUAL_STRING(want, buffer);
}

static void writes_as_the_c_library(float x)
{
    char want[40];
    struct text line = text_on(buffer, sizeof buffer);
    text_float9(&line, x);
    snprintf(want, sizeof want, "%.9g", (double)x);
    TEST_ASSERT_EQUAL_STRING(want, buffer);
    for (int digits = 6; digits <= 9; digits++) {
        snprintf(want, sizeof want, "%.*g", digits, (double)x);
        if (strtof(want, NULL) == x)
            break;
    }
    line = text_on(buffer, sizeof buffer);
    text_float(&line, x);
    TEST_ASSERT_EQUAL_STRING(want, buffer);
}

static void numbers_are_written_as_the_c_library_writes_them(void)
{
    struct random_source r = {SEED};
    for (unsigned n = 0; n < 100000; n++) {
        float x = from_bits((uint32_t)random_next(&r));
        if (isfinite(x))
            writes_as_the_c_library(x);
        /* Draws numbers of everyday size, and such as end in a five: where rounding has to choose. */
        writes_as_the_c_library((float)(int32_t)random_next(&r) / 1024.0f);
        writes_as_the_c_library((float)(random_next(&r) % 1000000u) / 64.0f);
    }
    for (uint32_t power = 0; power < 0x7F8; power++) { /* and their neighbours */
        writes_as_the_c_library(from_bits(power << 20));
        writes_as_the_c_library(from_bits((power << 20) + 1u));
        writes_as_the_c_library(from_bits((power << 20) ^ 0xFFFFFu));
    }
}

static void people_get_four_digits(void)
{
    struct random_source r = {SEED};
    writes_four_digits(21.646257f);
    writes_four_digits(87.1299973f);
    writes_four_digits(-12345.6f);
    writes_four_digits(0.0f);
    writes_four_digits(9999.7f);
    for (unsigned n = 0; n < 10000; n++) {
        float x = from_bits((uint32_t)random_next(&r));
        if (isfinite(x))
            writes_four_digits(x);
        writes_four_digits((float)(int32_t)random_next(&r) / 1024.0f);
    }
}

/* Whoever reads a line meets a number or a word, never a number that is none. */
static void what_is_no_number_is_written_as_none(void)
{
    const float bad[] = {(float)INFINITY, -(float)INFINITY, (float)NAN, -(float)NAN};
    for (unsigned k = 0; k < 4; k++) {
        struct text line = text_on(buffer, sizeof buffer);
        text_float(&line, bad[k]);
        TEST_ASSERT_EQUAL_STRING("none", buffer);
        line = text_on(buffer, sizeof buffer);
        text_float9(&line, bad[k]);
        TEST_ASSERT_EQUAL_STRING("none", buffer);
    }
}

static void reads_as_the_c_library(const char *text)
{
    float x = 99, want = strtof(text, NULL);
    enum err err = text_parse_float(text, &x);
    TEST_ASSERT_EQUAL_MESSAGE(isinf(want) ? ERR_RANGE : ERR_OK, err, text);
    if (!err)
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&want, &x, sizeof x, text);
}

static void numbers_are_read_as_the_c_library_reads_them(void)
{
    struct random_source r = {SEED};
    char text[64];
    for (unsigned n = 0; n < 100000; n++) {
        unsigned digits = 1u + (unsigned)(random_next(&r) % 30u), at = 0;
        for (unsigned i = 0; i < digits; i++) {
            if (i == digits / 3u)
                text[at++] = '.';
            text[at++] = (char)('0' + random_next(&r) % 10u);
        }
        snprintf(text + at, sizeof text - at, "e%d", (int)(random_next(&r) % 100u) - 50);
        reads_as_the_c_library(text);
    }
}

/* Halfway between two floats as far as 40 characters tell, there, and a digit to both sides of it. */
static void numbers_halfway_between_two_floats_are_read_as_the_c_library_reads_them(void)
{
    struct random_source r = {SEED};
    char text[80];
    for (unsigned n = 0; n < 100000; n++) {
        float x = from_bits((uint32_t)random_next(&r) & 0x7F7FFFFFu);
        double halfway = ((double)x + (double)nextafterf(x, 2.0f * x + 1e-45f)) / 2.0;
        if (!isfinite(halfway))
            continue;
        int size = snprintf(text, sizeof text, "%.*e", (int)(random_next(&r) % 34u), halfway);
        reads_as_the_c_library(text);
        for (int i = size - 5; i >= 0; i -= 5)
            if (text[i] > '0' && text[i] < '9') {
                text[i]++;
                reads_as_the_c_library(text);
                text[i]--;
                break;
            }
    }
    reads_as_the_c_library("16777217");
    reads_as_the_c_library("16777219");
    reads_as_the_c_library("16777217.00000000000000000000000000001");
    reads_as_the_c_library("3.4028235677973366163753939545814e38");
    reads_as_the_c_library("3.4028235677973366163753939545813e38");
    reads_as_the_c_library("7.006492321624085354618e-46");
    reads_as_the_c_library("7.006492321624085354619e-46");
    reads_as_the_c_library("0000000000000000000000000000000000000001");
    reads_as_the_c_library("0.00000000000000000000000000000000000001");
    reads_as_the_c_library("9999999999999999999999999999999999999999");
    reads_as_the_c_library("340282350000000000000000000000000000000");
    reads_as_the_c_library("0e9999");
    reads_as_the_c_library("-0.000e-30");
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
    RUN_TEST(numbers_are_written_as_the_c_library_writes_them);
    RUN_TEST(people_get_four_digits);
    RUN_TEST(what_is_no_number_is_written_as_none);
    RUN_TEST(numbers_are_read_as_the_c_library_reads_them);
    RUN_TEST(numbers_halfway_between_two_floats_are_read_as_the_c_library_reads_them);
    RUN_TEST(a_short_number_is_written_short);
    RUN_TEST(numbers_people_write_are_read);
    RUN_TEST(what_is_no_number_is_refused_and_nothing_changes);
    RUN_TEST(a_number_no_float_holds_is_out_of_range);
    RUN_TEST(whole_numbers_are_digits_only);
    RUN_TEST(whole_numbers_and_times_are_written_in_full);
    RUN_TEST(what_does_not_fit_is_cut_and_said_so);
    return UNITY_END();
}

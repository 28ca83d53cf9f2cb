/* base/: checksum and error texts.
 *
 * Contract
 *   crc32_update   the published check value; equal however the data are cut; every single-bit error, every
 *                  burst up to 32 bits and every single-byte error of a frame-sized message is noticed
 *   elapsed_ms     what the compiler's own conversion gives, bit for bit
 *   err_name/text  every code has its own name and a text; any other int gives "?", never a crash
 */
#include <limits.h>
#include <string.h>

#include "base/channel.h"
#include "base/crc32.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void the_crc_of_123456789_is_the_published_check_value(void)
{
    TEST_ASSERT_EQUAL_HEX32(0xCBF43926u, crc32_update(0, "123456789", 9));
}

/* Values any zlib gives. */
static void the_crc_agrees_with_zlib_on_other_vectors(void)
{
    static const uint8_t zeros[32];
    uint8_t ones[32];
    memset(ones, 0xFF, sizeof ones);
    TEST_ASSERT_EQUAL_HEX32(0x00000000u, crc32_update(0, "", 0));
    TEST_ASSERT_EQUAL_HEX32(0xE8B7BE43u, crc32_update(0, "a", 1));
    TEST_ASSERT_EQUAL_HEX32(0x352441C2u, crc32_update(0, "abc", 3));
    TEST_ASSERT_EQUAL_HEX32(0x190A55ADu, crc32_update(0, zeros, sizeof zeros));
    TEST_ASSERT_EQUAL_HEX32(0xFF6CAB0Bu, crc32_update(0, ones, sizeof ones));
}

static void a_crc_in_two_parts_equals_the_crc_of_the_whole(void)
{
    const char text[] = "the quick brown fox jumps over the lazy dog";
    size_t n = sizeof text - 1;
    uint32_t whole = crc32_update(0, text, n);
    for (size_t cut = 0; cut <= n; cut++)
        TEST_ASSERT_EQUAL_HEX32(whole,
                                crc32_update(crc32_update(0, text, cut), text + cut, n - cut));
}

static void fill(uint8_t *message, size_t n)
{
    for (size_t i = 0; i < n; i++)
        message[i] = (uint8_t)(i * 37u + 11u);
}

static void every_single_byte_error_is_noticed(void)
{
    uint8_t message[80];
    fill(message, sizeof message);
    uint32_t good = crc32_update(0, message, sizeof message);
    for (size_t i = 0; i < sizeof message; i++) {
        for (unsigned flip = 1; flip < 256; flip++) {
            message[i] ^= (uint8_t)flip;
            TEST_ASSERT_NOT_EQUAL(good, crc32_update(0, message, sizeof message));
            message[i] ^= (uint8_t)flip;
        }
    }
}

static void every_burst_up_to_32_bits_is_noticed(void)
{
    uint8_t message[24];
    fill(message, sizeof message);
    uint32_t good = crc32_update(0, message, sizeof message);
    uint32_t pattern = 0x2545F491u;
    for (unsigned start = 0; start + 32 <= 8 * sizeof message; start++) {
        for (int trial = 0; trial < 50; trial++) {
            pattern ^= pattern << 13;
            pattern ^= pattern >> 17;
            pattern ^= pattern << 5;
            uint8_t damaged[sizeof message];
            memcpy(damaged, message, sizeof message);
            for (unsigned b = 0; b < 32; b++)
                if (pattern >> b & 1u)
                    damaged[(start + b) / 8] ^= (uint8_t)(1u << ((start + b) % 8));
            TEST_ASSERT_NOT_EQUAL(good, crc32_update(0, damaged, sizeof damaged));
        }
    }
}

static void every_error_code_has_its_own_name_and_a_text(void)
{
    for (int a = 0; a >= ERR_LAST; a--) {
        TEST_ASSERT_NOT_NULL(err_name((enum err)a));
        TEST_ASSERT_TRUE(strlen(err_name((enum err)a)) >= 2);
        TEST_ASSERT_TRUE(strlen(err_text((enum err)a)) >= 2);
        for (int b = 0; b > a; b--)
            TEST_ASSERT_TRUE(strcmp(err_name((enum err)a), err_name((enum err)b)) != 0);
    }
    TEST_ASSERT_EQUAL_STRING("RANGE", err_name(ERR_RANGE));
    TEST_ASSERT_EQUAL_STRING("CONFLICT", err_name(ERR_CONFLICT));
    TEST_ASSERT_EQUAL_STRING("OK", err_name(ERR_OK));
}

static void a_value_that_is_no_error_code_is_a_question_mark(void)
{
    const int strangers[] = {1, ERR_LAST - 1, INT_MAX, INT_MIN};
    for (size_t i = 0; i < sizeof strangers / sizeof strangers[0]; i++) {
        TEST_ASSERT_EQUAL_STRING("?", err_name((enum err)strangers[i]));
        TEST_ASSERT_EQUAL_STRING("unknown error code", err_text((enum err)strangers[i]));
    }
}

static void infinities_and_nan_are_not_finite_and_all_else_is(void)
{
    float zero = 0.0f;
    TEST_ASSERT_FALSE(float_is_finite(1.0f / zero));
    TEST_ASSERT_FALSE(float_is_finite(-1.0f / zero));
    TEST_ASSERT_FALSE(float_is_finite(zero / zero));
    TEST_ASSERT_TRUE(float_is_finite(0.0f));
    TEST_ASSERT_TRUE(float_is_finite(-3.4e38f));
    TEST_ASSERT_TRUE(float_is_finite(1e-45f));
}

static void elapsed_time_is_rounded_to_the_nearest_float(void)
{
    static const uint64_t some[] = {0, 1, 16777217, 16777219, 0xFFFFFFFF, 0xFFFFFF80, 0xFFFFFF7F};
    for (unsigned i = 0; i < sizeof some / sizeof some[0]; i++)
        TEST_ASSERT_EQUAL_FLOAT((float)some[i], elapsed_ms(some[i] + 7, 7));
    /* Around every halfway case of every length. */
    for (unsigned bits = 1; bits <= 40; bits++)
        for (uint64_t mantissa = 0xFFFFF0; mantissa <= 0x100000F; mantissa++)
            for (int near = -1; near <= 1; near++) {
                uint64_t ms = (mantissa << bits >> 1) + (uint64_t)(int64_t)near;
                float want = (float)ms, is = elapsed_ms(ms + 1000, 1000);
                TEST_ASSERT_EQUAL_MEMORY(&want, &is, sizeof is);
            }
    TEST_ASSERT_EQUAL_FLOAT((float)UINT64_MAX, elapsed_ms(0, 1)); /* a clock set back */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(elapsed_time_is_rounded_to_the_nearest_float);
    RUN_TEST(the_crc_of_123456789_is_the_published_check_value);
    RUN_TEST(the_crc_agrees_with_zlib_on_other_vectors);
    RUN_TEST(a_crc_in_two_parts_equals_the_crc_of_the_whole);
    RUN_TEST(every_single_byte_error_is_noticed);
    RUN_TEST(every_burst_up_to_32_bits_is_noticed);
    RUN_TEST(every_error_code_has_its_own_name_and_a_text);
    RUN_TEST(a_value_that_is_no_error_code_is_a_question_mark);
    RUN_TEST(infinities_and_nan_are_not_finite_and_all_else_is);
    return UNITY_END();
}

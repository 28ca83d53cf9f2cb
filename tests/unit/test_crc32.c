/* The checksum with every size of its table against the definition, worked out bit by bit in another way.
 *
 * Contract
 *   the same value for each size of table, for every length and address, however the data are cut
 */
#include <stdio.h>
#include <string.h>

#include "random_source.h"
#include "unity.h"

#define SEED    20260111u
#define LONGEST 80u

uint32_t crc32_table_0(uint32_t crc, const void *data, size_t n);
uint32_t crc32_table_16(uint32_t crc, const void *data, size_t n);
uint32_t crc32_table_256(uint32_t crc, const void *data, size_t n);

static const struct {
    unsigned entries;
    uint32_t (*update)(uint32_t crc, const void *data, size_t n);
} sizes[] = {{0, crc32_table_0}, {16, crc32_table_16}, {256, crc32_table_256}};

#define SIZES (sizeof sizes / sizeof sizes[0])

void setUp(void) {}
void tearDown(void) {}

/* The bits in the order in which they are sent, 32 zeros behind them, the first 32 inverted; divided by the polynomial
 * as it is printed, the highest power first; what remains, inverted, read in the order of sending again. */
static uint32_t by_long_division(const uint8_t *data, size_t n)
{
    static const uint8_t divisor[33] = {1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 0, 1,
                                        0, 0, 0, 1, 1, 1, 0, 1, 1, 0, 1, 1, 0, 1, 1, 1};
    static uint8_t bit[8 * LONGEST + 32];
    memset(bit, 0, sizeof bit);
    for (size_t i = 0; i < 8 * n; i++)
        bit[i] = (uint8_t)(data[i / 8] >> i % 8) & 1u;
    for (size_t i = 0; i < 32; i++)
        bit[i] ^= 1u;
    for (size_t i = 0; i < 8 * n; i++)
        if (bit[i])
            for (size_t k = 0; k < 33; k++)
                bit[i + k] ^= divisor[k];
    uint32_t crc = 0;
    for (unsigned k = 0; k < 32; k++)
        crc |= (bit[8 * n + k] ^ 1u) << k;
    return crc;
}

static void assert_every_size_gives(uint32_t crc, const uint8_t *data, size_t n)
{
    for (size_t s = 0; s < SIZES; s++)
        TEST_ASSERT_EQUAL_HEX32(crc, sizes[s].update(0, data, n));
}

static void the_reference_gives_the_published_check_value(void)
{
    TEST_ASSERT_EQUAL_HEX32(0xCBF43926u, by_long_division((const uint8_t *)"123456789", 9));
    assert_every_size_gives(0xCBF43926u, (const uint8_t *)"123456789", 9);
}

/* Each entry of each table, in each of the four steps of a word and in the single step behind. */
static void every_size_of_table_is_right_for_every_byte_in_every_place(void)
{
    uint8_t data[5];
    for (size_t at = 0; at < sizeof data; at++)
        for (unsigned byte = 0; byte < 256; byte++) {
            memset(data, 0x5A, sizeof data);
            data[at] = (uint8_t)byte;
            assert_every_size_gives(by_long_division(data, sizeof data), data, sizeof data);
        }
}

static void every_size_of_table_is_right_for_every_length_at_every_address(void)
{
    static uint8_t data[LONGEST + 4];
    struct random_source r = {SEED};
    printf("random bytes, seed %u\n", SEED);
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (uint8_t)random_next(&r);
    for (size_t n = 0; n <= LONGEST; n++)
        for (size_t from = 0; from < 4; from++)
            assert_every_size_gives(by_long_division(data + from, n), data + from, n);
}

/* Storage checks in pieces what was written whole, and the other way round. */
static void every_size_of_table_goes_on_where_another_stopped(void)
{
    static uint8_t data[LONGEST];
    struct random_source r = {SEED + 1};
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (uint8_t)random_next(&r);
    uint32_t whole = by_long_division(data, sizeof data);
    for (size_t cut = 0; cut <= sizeof data; cut++)
        for (size_t a = 0; a < SIZES; a++)
            for (size_t b = 0; b < SIZES; b++) {
                uint32_t begun = sizes[a].update(0, data, cut);
                TEST_ASSERT_EQUAL_HEX32(whole,
                                        sizes[b].update(begun, data + cut, sizeof data - cut));
            }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_reference_gives_the_published_check_value);
    RUN_TEST(every_size_of_table_is_right_for_every_byte_in_every_place);
    RUN_TEST(every_size_of_table_is_right_for_every_length_at_every_address);
    RUN_TEST(every_size_of_table_goes_on_where_another_stopped);
    return UNITY_END();
}

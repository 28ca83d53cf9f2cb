/* hal/stm32/memory.c: memset and memcpy by words, under other names so that they run here.
 *
 * Contract
 *   every length to 70 from every place of a word to every other      the bytes asked for, and no byte beside them
 *   random lengths and places (seed printed)                          likewise
 */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "random_source.h"
#include "unity.h"

void *by_words_memset(void *to, int value, size_t n);
void *by_words_memcpy(void *restrict to, const void *restrict from, size_t n);

#define SEED 405u
#define ROOM 4096u

static uint8_t ours[ROOM], expected[ROOM], source[ROOM];

void setUp(void) {}
void tearDown(void) {}

static void fill(struct random_source *r)
{
    for (unsigned i = 0; i < ROOM; i++) {
        ours[i] = expected[i] = (uint8_t)random_below(r, 256);
        source[i] = (uint8_t)random_below(r, 256);
    }
}

static void once(struct random_source *r, unsigned to, unsigned from, unsigned n)
{
    int value = (int)random_below(r, 1024) - 512; /* its lowest byte counts */
    for (unsigned i = 0; i < n; i++)
        expected[to + i] = source[from + i];
    TEST_ASSERT_EQUAL_PTR(ours + to, by_words_memcpy(ours + to, source + from, n));
    TEST_ASSERT_EQUAL_UINT8_ARRAY(expected, ours, ROOM);
    for (unsigned i = 0; i < n; i++)
        expected[to + i] = (uint8_t)value;
    TEST_ASSERT_EQUAL_PTR(ours + to, by_words_memset(ours + to, value, n));
    TEST_ASSERT_EQUAL_UINT8_ARRAY(expected, ours, ROOM);
}

static void short_ones_at_every_place_of_a_word(void)
{
    struct random_source r = {SEED};
    fill(&r);
    for (unsigned n = 0; n <= 70; n++)
        for (unsigned to = 0; to < 4; to++)
            for (unsigned from = 0; from < 4; from++)
                once(&r, 16 + to, 16 + from, n);
}

static void long_ones_anywhere(void)
{
    struct random_source r = {SEED};
    printf("seed %u\n", SEED);
    fill(&r);
    for (unsigned k = 0; k < 2000; k++) {
        unsigned n = random_below(&r, ROOM + 1);
        once(&r, random_below(&r, ROOM - n + 1), random_below(&r, ROOM - n + 1), n);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(short_ones_at_every_place_of_a_word);
    RUN_TEST(long_ones_anywhere);
    return UNITY_END();
}

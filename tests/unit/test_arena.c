/* States keep what is in them while the arena is divided anew. */
#include <stdio.h>
#include <string.h>

#include "random_source.h"
#include "supervise/supervisor.h"
#include "unity.h"

static struct supervisor s;
static const uint8_t most[PLACED_KINDS] = {CHANNEL_MAX,
                                           CHANNEL_MAX,
                                           CONFIG_LOOPS,
                                           CONFIG_INTERLOCKS,
                                           CONFIG_ALARMS,
                                           CONFIG_FEEDFORWARDS,
                                           1};
static const size_t size[PLACED_KINDS] = {
    sizeof *s.measurement, sizeof *s.output,      sizeof *s.loop,     sizeof *s.interlock,
    sizeof *s.alarm,       sizeof *s.feedforward, sizeof *s.decoupler};
static uint8_t model[PLACED_KINDS][16 * 1024]; /* what each kind should hold */

void setUp(void)
{
    memset(&s, 0, sizeof s);
    memset(model, 0, sizeof model);
}
void tearDown(void) {}

static uint8_t *kind(unsigned k)
{
    void *const at[PLACED_KINDS] = {s.measurement, s.output,      s.loop,     s.interlock,
                                    s.alarm,       s.feedforward, s.decoupler};
    return at[k];
}

static void place(const uint8_t n[PLACED_KINDS])
{
    for (unsigned k = 0; k < PLACED_KINDS; k++) {
        uint8_t kept = s.placed[k] < n[k] ? s.placed[k] : n[k];
        memset(model[k] + kept * size[k], 0, sizeof model[k] - kept * size[k]);
    }
    arena_place(&s, n);
}

static void as_modelled(void)
{
    uint8_t *end = (uint8_t *)s.arena;
    for (unsigned k = 0; k < PLACED_KINDS; k++) {
        TEST_ASSERT_TRUE(kind(k) >= end);
        TEST_ASSERT_EQUAL(0, (uintptr_t)kind(k) % 8u);
        end = kind(k) + s.placed[k] * size[k];
        if (s.placed[k])
            TEST_ASSERT_EQUAL_MEMORY(model[k], kind(k), s.placed[k] * size[k]);
    }
    TEST_ASSERT_TRUE(end <= (uint8_t *)s.arena + arena_state_bytes(s.placed));
}

static void scribble(struct random_source *r)
{
    for (unsigned k = 0; k < PLACED_KINDS; k++)
        for (size_t n = 0; n < s.placed[k] * size[k]; n++)
            model[k][n] = kind(k)[n] = (uint8_t)random_below(r, 256);
}

static void test_states_survive_any_order_of_growing_and_shrinking(void)
{
    struct random_source r = {20261121};
    printf("seed %u\n", (unsigned)r.state);
    for (unsigned turn = 0; turn < 2000; turn++) {
        uint8_t n[PLACED_KINDS];
        for (unsigned k = 0; k < PLACED_KINDS; k++)
            n[k] = (uint8_t)random_below(&r, most[k] + 1u);
        place(n);
        as_modelled();
        scribble(&r);
    }
}

static void test_all_places_and_none(void)
{
    static const uint8_t none[PLACED_KINDS];
    struct random_source r = {7};
    place(most);
    as_modelled();
    scribble(&r);
    place(most);
    as_modelled();
    place(none);
    TEST_ASSERT_EQUAL(0, arena_state_bytes(s.placed));
    place(most);
    as_modelled(); /* nothing of before is left */
    printf("arena: states %u of %u bytes at most\n", (unsigned)arena_state_bytes(most),
           (unsigned)PLAN_ARENA_BYTES);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_states_survive_any_order_of_growing_and_shrinking);
    RUN_TEST(test_all_places_and_none);
    return UNITY_END();
}

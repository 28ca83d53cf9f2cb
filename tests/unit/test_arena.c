/* States keep what is in them while the arena is divided anew. */
#include <stdio.h>
#include <string.h>

#include "exchange/arena_sizes.h"
#include "random_source.h"
#include "supervise/arena.h"
#include "supervise/supervisor.h"
#include "unity.h"

static struct supervisor s;
static struct plan plan;
static const uint8_t most[PLACED_KINDS] = {CHANNEL_MAX, CHANNEL_MAX, CONFIG_LOOPS,
                                           CONFIG_INTERLOCKS, CONFIG_ALARMS};
static const size_t size[PLACED_KINDS] = {sizeof *s.measurement, sizeof *s.mv, sizeof *s.loop,
                                          sizeof *s.interlock, sizeof *s.alarm};
#define BLOCK_BYTES_MOST 600
/* Contents that each kind of state, and each block, should have. */
static uint8_t model[PLACED_KINDS][16 * 1024], block_model[PLAN_BLOCKS][BLOCK_BYTES_MOST];

void setUp(void)
{
    memset(&s, 0, sizeof s);
    memset(model, 0, sizeof model);
    memset(block_model, 0, sizeof block_model);
    for (unsigned b = 0; b < PLAN_BLOCKS; b++)
        s.block[b].kind = PLAN_NONE;
}
void tearDown(void) {}

static uint8_t *kind(unsigned k)
{
    void *const at[PLACED_KINDS] = {s.measurement, s.mv, s.loop, s.interlock, s.alarm};
    return at[k];
}

/* A plan that needs so many of each, and blocks of these sizes (0: none) and kinds. */
static void make_plan(const uint8_t n[PLACED_KINDS], const uint8_t grains[PLAN_BLOCKS],
                      const uint8_t kinds[PLAN_BLOCKS])
{
    struct config *c = &plan.config;
    char *name[PLACED_KINDS] = {
        n[0] ? c->measurement[n[0] - 1].name : NULL, n[1] ? c->mv[n[1] - 1].name : NULL,
        n[2] ? c->loop[n[2] - 1].name : NULL, n[3] ? c->interlock[n[3] - 1].measurement : NULL,
        n[4] ? c->alarm[n[4] - 1].on : NULL};
    memset(&plan, 0, sizeof plan);
    uint32_t at = arena_state_bytes(n) / ARENA_GRAIN;
    for (unsigned k = 0; k < PLACED_KINDS; k++)
        if (name[k])
            strcpy(name[k], "x");
    for (unsigned b = 0; b < PLAN_BLOCKS; b++) {
        plan.block[b] = (struct block_place){(uint16_t)at, grains[b],
                                             grains[b] ? kinds[b] : (uint8_t)PLAN_NONE, 0};
        at += grains[b];
    }
    TEST_ASSERT_TRUE(at * ARENA_GRAIN <= PLAN_ARENA_BYTES);
}

static void place(const uint8_t n[PLACED_KINDS], const uint8_t grains[PLAN_BLOCKS],
                  const uint8_t kinds[PLAN_BLOCKS])
{
    make_plan(n, grains, kinds);
    for (unsigned k = 0; k < PLACED_KINDS; k++) {
        uint8_t kept = s.placed[k] < n[k] ? s.placed[k] : n[k];
        memset(model[k] + kept * size[k], 0, sizeof model[k] - kept * size[k]);
    }
    for (unsigned b = 0; b < PLAN_BLOCKS; b++)
        if (s.block[b].kind != plan.block[b].kind || s.block[b].grains != plan.block[b].grains)
            memset(block_model[b], 0, sizeof block_model[b]);
    arena_place(&s, &plan);
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
    for (unsigned b = 0; b < PLAN_BLOCKS; b++) {
        uint8_t *state = supervisor_block(&s, (uint8_t)b);
        if (s.block[b].kind == PLAN_NONE)
            continue;
        TEST_ASSERT_TRUE(state >= end);
        TEST_ASSERT_EQUAL(0, (uintptr_t)state % 8u);
        TEST_ASSERT_EQUAL_MEMORY(block_model[b], state, s.block[b].grains * ARENA_GRAIN);
        end = state + s.block[b].grains * ARENA_GRAIN;
    }
}

static void scribble(struct random_source *r)
{
    for (unsigned k = 0; k < PLACED_KINDS; k++)
        for (size_t n = 0; n < s.placed[k] * size[k]; n++)
            model[k][n] = kind(k)[n] = (uint8_t)random_below(r, 256);
    for (unsigned b = 0; b < PLAN_BLOCKS; b++)
        for (size_t n = 0; s.block[b].kind != PLAN_NONE && n < s.block[b].grains * ARENA_GRAIN; n++)
            block_model[b][n] = ((uint8_t *)supervisor_block(&s, (uint8_t)b))[n] =
                (uint8_t)random_below(r, 256);
}

static void test_states_survive_any_order_of_growing_and_shrinking(void)
{
    struct random_source r = {20261121};
    uint8_t grains[PLAN_BLOCKS], kinds[PLAN_BLOCKS];
    printf("seed %u\n", (unsigned)r.state);
    for (unsigned turn = 0; turn < 2000; turn++) {
        uint8_t n[PLACED_KINDS];
        for (unsigned k = 0; k < PLACED_KINDS; k++)
            n[k] = (uint8_t)random_below(&r, most[k] + 1u);
        /* Most blocks stay what they were. */
        for (unsigned b = 0; b < PLAN_BLOCKS; b++) {
            if (turn && random_below(&r, 3))
                continue;
            grains[b] = (uint8_t)random_below(&r, BLOCK_BYTES_MOST / ARENA_GRAIN);
            kinds[b] = (uint8_t)random_below(&r, 2);
        }
        place(n, grains, kinds);
        as_modelled();
        scribble(&r);
    }
}

static void test_all_places_and_none(void)
{
    static const uint8_t none[PLACED_KINDS], no_grains[PLAN_BLOCKS], kinds[PLAN_BLOCKS];
    uint8_t grains[PLAN_BLOCKS];
    struct random_source r = {7};
    memset(grains, 20, sizeof grains);
    place(most, grains, kinds);
    as_modelled();
    scribble(&r);
    place(most, grains, kinds);
    as_modelled();
    place(none, no_grains, kinds);
    TEST_ASSERT_EQUAL(0, arena_state_bytes(s.placed));
    place(most, grains, kinds);
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

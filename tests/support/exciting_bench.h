/* Two blocks that excite (exciting_kinds.h) on the bench of the supervisor: a controller of both loops, and an estimator. */
#ifndef REFLUX_TESTS_EXCITING_BENCH_H
#define REFLUX_TESTS_EXCITING_BENCH_H

#include "exchange/block_settings.h"
#include "exciting_kinds.h"
#include "settings/block_pool.h"
#include "supervisor_bench.h"

static inline void put_block(unsigned n, const char *kind, const char *loops, const char *inputs)
{
    struct block_config *b = &bench.config.block[n];
    uint32_t needed, room;
    TEST_ASSERT_EQUAL(ERR_OK, record_make(&bench.config, (uint8_t)n, kind, &needed, &room));
    strcpy(b->loops, loops);
    strcpy(b->inputs, inputs);
}

static inline void put_size(unsigned n, float size)
{
    memcpy(bench.config.pool + bench.config.block[n].offset, &size, sizeof size);
}

static inline void blocks(void)
{
    put_block(CONTROLLER, "held", "top bottom", "spare feed");
    put_block(ESTIMATOR, "shake", "", "spare feed");
    put("meas3.hold", "2");
}

/* Both loops in auto; reflux and heat at half their spans. */
static inline void begin_with(void (*more)(void))
{
    memset(wish, 0, sizeof wish);
    bench_start_with(more);
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    ticks(2);
}

static inline void begin(void)
{
    begin_with(blocks);
}

/* It excites both MVs and the setpoint of top. */
static inline void excite_all(void)
{
    wish[CONTROLLER].ask[0] = on(EXCITE_MV, 0, 0.05);
    wish[CONTROLLER].ask[1] = on(EXCITE_MV, 1, -0.1);
    wish[CONTROLLER].ask[2] = on(EXCITE_SETPOINT, 0, 0.02);
    ticks(2);
    TEST_ASSERT_EQUAL(EXCITE_RUNS, wish[CONTROLLER].state);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.27, setpoint_of(TOP));
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_EXCITATION_BEGUN, "held"));
}

static inline void nothing_is_excited(void)
{
    for (unsigned j = 0; j < 3; j++)
        TEST_ASSERT_TRUE(num_eq(bench.s.mv[j].excitation, num_zero()));
    for (unsigned i = 0; i < 2; i++) {
        TEST_ASSERT_TRUE(num_eq(bench.s.loop[i].of_block.excite, num_zero()));
        TEST_ASSERT_TRUE(num_eq(bench.s.loop[i].of_block.excited, num_zero()));
    }
    TEST_ASSERT_NULL(supervisor_excited_by(&bench.s));
}

static inline void ended(const char *reason)
{
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_EXCITATION_ENDED, reason));
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_EXCITATION_ENDED, NULL));
    nothing_is_excited();
}

/* ... and in the same tick nothing of it is left in what is sent. */
static inline void gone(const char *reason)
{
    ended(reason);
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    ASSERT_NO_BUMP(0.5, sent(HEAT));
}

#endif

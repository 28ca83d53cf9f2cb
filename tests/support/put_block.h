/* blockN of the configuration of supervisor_bench.h, as the console sets it. */
#ifndef REFLUX_TESTS_PUT_BLOCK_H
#define REFLUX_TESTS_PUT_BLOCK_H

#include <string.h>

#include "exchange/block_settings.h"
#include "settings/block_pool.h"
#include "supervisor_bench.h"

/* Settings of its kind, whom it serves, what it reads and writes. */
static inline void put_block(unsigned n, const char *kind, const char *loops, const char *inputs,
                             const char *points)
{
    struct block_config *b = &bench.config.block[n];
    uint32_t needed, room;
    TEST_ASSERT_EQUAL(ERR_OK, record_make(&bench.config, (uint8_t)n, kind, &needed, &room));
    strcpy(b->loops, loops);
    strcpy(b->inputs, inputs);
    strcpy(b->points, points);
}

#endif

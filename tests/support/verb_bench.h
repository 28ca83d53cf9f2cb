/* The bench of the supervisor with a block that watches T1 and one that serves top and bottom. */
#ifndef REFLUX_TESTS_VERB_BENCH_H
#define REFLUX_TESTS_VERB_BENCH_H

#include "exchange/block_settings.h"
#include "put_block.h"
#include "supervisor_bench.h"
#include "verb_kinds.h"

enum { WATCH, PAIR };
enum { SEEN = 4 };

static inline void watch_and_pair(void)
{
    put_all((const char *const[]){"meas5.name", "seen", "meas5.unit", "degC", "meas5.lo", "60",
                                  "meas5.hi", "160", "meas3.hold", "2", NULL});
    put_block(WATCH, "watch", "", "T1", "seen");
    put_block(PAIR, "pair", "top bottom", "feed", "");
}

static inline double seen_value(void)
{
    return (double)span_to_eu(bench.s.measurement[SEEN].value, 60, 160);
}

static inline const struct event *last(enum event_code code)
{
    bench_events();
    for (unsigned i = bench.n_seen; i-- > 0;)
        if (bench.seen[i].code == code)
            return &bench.seen[i];
    TEST_FAIL_MESSAGE(event_name((uint8_t)code));
    return NULL;
}

#endif

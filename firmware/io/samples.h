/* Does a sample make a tick? Plant time decides (docs/tick.md, "Samples that are not on time"); the board's clock
 * watches only whether samples that keep coming make ticks at all. Lives in the tick context.
 */
#ifndef REFLUX_IO_SAMPLES_H
#define REFLUX_IO_SAMPLES_H

#include <stdbool.h>
#include <stdint.h>

#include "base/event.h"
#include "hal/io.h"

#define SAMPLES_STALL_LEAST_MS 2000 /* board time without a tick that is borne at any base tick */

enum sample_verdict {
    SAMPLE_NO_TICK, /* early, or come twice: the last command is its answer */
    SAMPLE_TICK,
    SAMPLE_TICK_LOST, /* too many are missing before it: the safe state, then the tick */
    /* Samples come, but plant time stands still between two ticks or was set back: the safe state, and a tick all
     * the same. Plant time goes on from this sample. */
    SAMPLE_TICK_STALLED
};

struct samples {
    bool any;     /* a tick since the plant has come */
    bool overdue; /* none for too long, and that has been said */
    bool
        stalled; /* those that come make no tick, and that has been said; until one does by itself */
    uint32_t number, idle_number; /* of the last tick; of the last sample that made none */
    uint32_t idle;    /* samples since the last tick that made none; one repeated counts once */
    uint32_t idle_ms; /* board time since the last tick in which samples came */
    uint64_t time_ms; /* plant time of the last tick */
    uint64_t seen_ms; /* board time of the last sample, or of the plant's coming */
};

/* The plant has come, gone or changed: the next sample makes a tick. */
void samples_forget(struct samples *s, uint64_t now_ms);

/* Judges a sample that came at now_ms of the board's clock and keeps what it did. tick_s: base tick, s, above 0;
 * miss_limit: base ticks that may be missing, or pass without one. Events go to `events` with the plant time of the
 * last tick. */
enum sample_verdict samples_judge(struct samples *s, const struct io_sample *sample,
                                  uint64_t now_ms, float tick_s, uint32_t miss_limit,
                                  struct event_queue *events);

/* No sample at now_ms. True once when there has been none for timeout_s of the board's clock (0: any time is
 * borne), with its event. */
bool samples_overdue(struct samples *s, uint64_t now_ms, float timeout_s,
                     struct event_queue *events);

#endif

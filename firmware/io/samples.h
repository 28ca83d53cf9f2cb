/* Decides whether a sample makes a tick. Plant time decides (docs/inside/tick.md, "Samples that are not on time"). The board's
 * clock only watches whether the samples that come make ticks at all. All functions run in the tick context.
 */
#ifndef REFLUX_IO_SAMPLES_H
#define REFLUX_IO_SAMPLES_H

#include <stdbool.h>
#include <stdint.h>

#include "base/event.h"
#include "hal/io.h"

/* Board time without a tick that is allowed at any base tick, ms. */
#define SAMPLES_STALL_LEAST_MS 2000

enum sample_verdict {
    SAMPLE_NO_TICK, /* early or repeated: the last command is its answer */
    SAMPLE_TICK,
    SAMPLE_TICK_LOST, /* too many samples are missing before it: the safe state, then the tick */
    /* Samples come, but plant time stands still between two ticks or was set back: the safe state, and a tick all
     * the same. Plant time continues from this sample. */
    SAMPLE_TICK_STALLED
};

struct samples {
    bool any;     /* there was a tick since the plant came */
    bool overdue; /* no sample came for too long, and an event has reported that */
    /* Samples come but make no tick, and an event has reported that. It ends with a sample that makes a tick by itself. */
    bool stalled;
    /* Number of the sample of the last tick, and of the last sample that made no tick. */
    uint32_t number, idle_number;
    uint32_t idle;    /* samples without a tick since the last tick; a repeated one counts once */
    uint32_t idle_ms; /* board time since the last tick in which samples came */
    uint64_t time_ms; /* plant time of the last tick */
    uint64_t seen_ms; /* board time of the last sample, or of the plant's arrival */
};

/* Starts anew when the plant has come, gone or changed: the next sample makes a tick. */
void samples_forget(struct samples *s, uint64_t now_ms);

/* Judges a sample that came at now_ms of the board's clock, and keeps the verdict. tick_s: base tick, s, above 0.
 * miss_limit: allowed number of missing samples, and of samples in a row that make no tick. Events go to `events` with
 * the plant time of the last tick. */
enum sample_verdict samples_judge(struct samples *s, const struct io_sample *sample,
                                  uint64_t now_ms, float tick_s, uint32_t miss_limit,
                                  struct event_queue *events);

/* Call when there is no sample at now_ms. Returns true once, and reports an event, when no sample came for timeout_s of
 * the board's clock. timeout_s = 0: never. */
bool samples_overdue(struct samples *s, uint64_t now_ms, float timeout_s,
                     struct event_queue *events);

#endif

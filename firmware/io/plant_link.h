/* Controller side of the plant link (docs/plant-link.md): hal/io.h implemented on frames over a serial line.
 * Lives in the tick context. */
#ifndef REFLUX_IO_PLANT_LINK_H
#define REFLUX_IO_PLANT_LINK_H

#include "base/event.h"
#include "exchange/config.h"
#include "hal/io.h"
#include "io/plant_fault.h"
#include "link/frame.h"
#include "link/messages.h"

#ifndef LINK_RX_BLOCK
#define LINK_RX_BLOCK 64 /* bytes taken from the port at a time */
#endif
#ifndef LINK_TEXT_BYTES
#define LINK_TEXT_BYTES                                                                            \
    (2 * LINK_CHANNELS_ROOM * (CHANNEL_NAME_SIZE + CHANNEL_UNIT_SIZE)) /* never short */
#endif

#if LINK_TEXT_BYTES <= 0xFF
typedef uint8_t link_place;
#else
typedef uint16_t link_place;
#endif

/* Spans that the plant announces, by page: only people look at them, and only where there is start-up. */
#if COMMISSION_CHANNELS
struct plant_spans {
    float lo[2 * LINK_CHANNELS_ROOM], hi[2 * LINK_CHANNELS_ROOM]; /* EU */
};
static inline void plant_spans_keep(struct plant_spans *s, unsigned page, float lo, float hi)
{
    s->lo[page] = lo;
    s->hi[page] = hi;
}
static inline void plant_spans_give(const struct plant_spans *s, unsigned page, float *lo,
                                    float *hi)
{
    *lo = s->lo[page];
    *hi = s->hi[page];
}
#else
struct plant_spans {
};
#define plant_spans_keep(s, page, lo, hi) ((void)(s))
#define plant_spans_give(s, page, lo, hi) ((void)(s), (void)(page))
#endif

struct plant_link {
    enum io_state state;
    uint32_t generation;
    uint32_t session;       /* ours */
    uint32_t plant_session; /* the plant's, of the present or last exchange */
    uint32_t hello;         /* checksum of its HELLO: what it announces */
    uint16_t sequence;
    uint64_t heard_ms, sent_ms,
        asked_ms; /* board time of the last good frame, any frame out, question out */
    uint8_t next_page;
    uint8_t count[2]; /* measurements, manipulated variables */
    uint32_t tick_ms;
    char name[LINK_PLANT_NAME_SIZE];
    uint16_t text_n;
    link_place text_at
        [2 *
         LINK_CHANNELS_ROOM]; /* by page: where name and unit stand in text, a zero after each */
    float safe[LINK_CHANNELS_ROOM];
    struct plant_spans spans;
    char text[LINK_TEXT_BYTES];
    enum plant_fault refused; /* why the plant with this `hello` is not taken */
    uint32_t told_ms,
        odd_ms; /* board time, low word: of the last refusal told; of the first odd sample in a row */
    uint8_t asks;          /* for next_page */
    bool refusal_reported; /* there was one */
    bool odd, odd_told;    /* the last sample was not of the shape announced; that has been said */
    bool role_told;
    struct frame_decoder decoder;
    uint8_t rx[LINK_RX_BLOCK];
    uint8_t rx_n, rx_at;
    uint32_t reception; /* counts of hal_cycles() spent so far on the frame that is coming in */
    uint16_t heard_sequence;
    bool version_told;
    struct {
        uint32_t samples, commands, lost_frames, refused, congested, silences;
    } stats;
    struct event_queue *events;
    const uint64_t *plant_time; /* for the time stamp of events */
};

void plant_link_init(struct plant_link *link, struct event_queue *events,
                     const uint64_t *plant_time);
struct io_port plant_link_port(struct plant_link *link);

#endif

/* Controller side of the plant link (docs/inside/plant-link.md): hal/io.h implemented on frames over a serial line.
 * All functions run in the tick context. */
#ifndef REFLUX_IO_PLANT_LINK_H
#define REFLUX_IO_PLANT_LINK_H

#include "base/event.h"
#include "exchange/config.h"
#include "hal/io.h"
#include "io/plant_fault.h"
#include "link/frame.h"
#include "link/messages.h"

#ifndef LINK_RX_BLOCK
#define LINK_RX_BLOCK 64 /* bytes that one read takes from the port */
#endif
#ifndef LINK_TEXT_BYTES
/* Room for the longest names and units of all channels. */
#define LINK_TEXT_BYTES (2 * LINK_CHANNELS_ROOM * (CHANNEL_NAME_SIZE + CHANNEL_UNIT_SIZE))
#endif

#if LINK_TEXT_BYTES <= 0xFF
typedef uint8_t link_place;
#else
typedef uint16_t link_place;
#endif

/* Spans that the plant announces, by page. Only people look at them, and only on boards with automatic start-up. */
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
    uint32_t hello;         /* checksum of the plant's HELLO, its whole announcement */
    uint16_t sequence;
    /* Board time of the last good frame received, of the last frame sent, and of the last HELLO or page request sent. */
    uint64_t heard_ms, sent_ms, asked_ms;
    uint8_t next_page;
    uint8_t count[2]; /* measurements, manipulated variables */
    uint32_t tick_ms;
    char name[LINK_PLANT_NAME_SIZE];
    uint16_t text_n;
    /* Index in text, by page: the name and the unit stand there, a zero after each. */
    link_place text_at[2 * LINK_CHANNELS_ROOM];
    float safe[LINK_CHANNELS_ROOM];
    struct plant_spans spans;
    char text[LINK_TEXT_BYTES];
    enum plant_fault refused; /* reason to refuse the plant with this `hello` */
    /* Low word of the board time: of the last refusal reported, and of the first odd sample in a row. */
    uint32_t told_ms, odd_ms;
    uint8_t asks;          /* requests for next_page */
    bool refusal_reported; /* told_ms is valid */
    /* The last sample was not of the announced shape; an event has reported that. */
    bool odd, odd_told;
    bool role_told;
    struct frame_decoder decoder;
    uint8_t rx[LINK_RX_BLOCK];
    uint8_t rx_n, rx_at;
    uint32_t reception; /* counts of hal_cycles() spent on the incoming frame so far */
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

/* Refuses the plant and reports that once. The refusal lasts until the plant sends another HELLO or falls silent, or somebody has it
 * judged anew. value: of the event. */
void plant_link_refuse(struct plant_link *link, enum plant_fault fault, float value,
                       uint64_t now_ms);
/* Ends a refusal. The next HELLO of the same plant begins a greeting. */
void plant_link_judge_anew(struct plant_link *link);

/* Answers the sample with this number and time: the outputs of a command from `first` on are those of the plant. Errors as
 * io_port.command(). */
enum err plant_link_answer(struct plant_link *link, const struct io_command *c, uint8_t first,
                           uint32_t number, plant_time_ms time, uint64_t now_ms);

/* Writes the next KEEP_ALIVE frame to wire, for a port that sends it while no tick runs. Returns its bytes, LINK_KEEP_ALIVE_BYTES;
 * 0 without a plant. */
#define LINK_KEEP_ALIVE_BYTES 9
size_t plant_link_keep_alive(struct plant_link *link, uint8_t *wire);

#endif

/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "io/both_io.h"

#include <string.h>

#include "base/elapsed.h"

/* Readings of the link older than so many intervals of its plant are missing. */
#define INTERVALS_MISSED 3u
/* Samples of the link that one poll takes; a longer row goes on at the next. */
#define SAMPLES_MOST 16u

void both_io_init(struct both_io *b, struct board_io *board, struct plant_link *link)
{
    struct io_port port = plant_link_port(link);
    memset(b, 0, sizeof *b);
    b->board = board;
    b->link = link;
    b->link_generation = port.generation(link) - 1u; /* it has not been looked at */
}

uint8_t both_io_first_of_link(const struct both_io *b, bool manipulated)
{
    struct io_port board = board_io_port(b->board);
    return board.count(b->board, manipulated);
}

static uint8_t link_count(const struct both_io *b, bool manipulated)
{
    struct io_port link = plant_link_port(b->link);
    return b->joined ? link.count(b->link, manipulated) : 0;
}

/* ---- the link's plant comes and goes ---- */

static bool board_has(const struct both_io *b, bool manipulated, const char *name)
{
    struct io_port board = board_io_port(b->board);
    for (uint8_t i = 0; i < board.count(b->board, manipulated); i++)
        if (strcmp(board.channel(b->board, manipulated, i).name, name) == 0)
            return true;
    return false;
}

/* Why the link's plant does not go with what is at the pins. *value: of the event. */
static enum plant_fault conflict(const struct both_io *b, float *value)
{
    struct io_port link = plant_link_port(b->link);
    unsigned page = 0;
    for (unsigned kind = 0; kind < 2; kind++) {
        uint8_t n = link.count(b->link, kind != 0);
        unsigned all = both_io_first_of_link(b, kind != 0) + (unsigned)n;
        *value = (float)all;
        if (all > IO_CHANNELS_MAX)
            return PLANT_TOO_LARGE;
        for (uint8_t i = 0; i < n; i++, page++) {
            *value = (float)page;
            if (board_has(b, kind != 0, link.channel(b->link, kind != 0, i).name))
                return PLANT_AT_PINS;
        }
    }
    return PLANT_FINE;
}

/* Takes note of another plant at the link, or none, and of other settings of the board. */
static void look_at_link(struct both_io *b, uint64_t now_ms)
{
    struct io_port link = plant_link_port(b->link), board = board_io_port(b->board);
    bool same_board = board.generation(b->board) == b->board_generation,
         same_link = link.generation(b->link) == b->link_generation;
    if (b->parted || (same_board && same_link))
        return;
    if (!same_board)
        plant_link_judge_anew(b->link);
    b->board_generation = board.generation(b->board);
    b->parted = b->joined;
    b->changed = b->changed || b->joined;
    b->met = b->joined = b->unanswered = b->stale_told = false;
    if (b->parted) {
        b->link_generation = link.generation(b->link) - 1u; /* look again */
        return;
    }
    b->new_ms = now_ms;
    float value = 0.0f;
    enum plant_fault fault = PLANT_FINE;
    b->met = link.state(b->link) == IO_READY;
    if (b->met)
        fault = conflict(b, &value);
    if (fault != PLANT_FINE) {
        b->met = false;
        plant_link_refuse(b->link, fault, value, now_ms);
    }
    b->link_generation = link.generation(b->link);
}

bool both_io_link_changed(struct both_io *b)
{
    bool changed = b->changed;
    b->changed = false;
    return changed;
}

/* ---- samples ---- */

static void keep_readings(struct both_io *b, unsigned kind, const struct io_reading *reading,
                          uint8_t n)
{
    for (unsigned i = 0; i < LINK_CHANNELS_ROOM; i++) {
        b->value[kind][i] = reading[i].value;
        b->quality[kind][i] = (uint8_t)(i < n ? reading[i].quality : QUALITY_MISSING);
    }
}

static void keep_link_sample(struct both_io *b, const struct io_sample *sample, uint64_t now_ms)
{
    b->reception += sample->reception;
    if (!b->met)
        return;
    bool is_new = !b->joined || sample->time > b->time;
    b->changed = b->changed || !b->joined;
    b->joined = true;
    b->number = sample->number;
    b->time = sample->time;
    b->unanswered = true;
    if (!is_new)
        return;
    b->stale_told = false;
    b->new_ms = now_ms;
    keep_readings(b, 0, sample->measurement, sample->n_measurements);
    keep_readings(b, 1, sample->readback, sample->n_readback);
}

/* Whether the newest readings of the link hold. Tells it once when they do not, although the plant is there. */
static bool is_fresh(struct both_io *b, uint64_t now_ms)
{
    struct io_port link = plant_link_port(b->link), board = board_io_port(b->board);
    uint64_t oldest = (uint64_t)INTERVALS_MISSED * link.tick_ms(b->link) + board.tick_ms(b->board);
    if (oldest < LINK_SILENCE_MS)
        oldest = LINK_SILENCE_MS;
    if (!b->met)
        return false;
    if (now_ms - b->new_ms <= oldest)
        return b->joined;
    if (!b->stale_told)
        event_put(b->link->events, *b->link->plant_time, EVENT_SAMPLE_OVERDUE, b->link->name,
                  elapsed_ms(now_ms, b->new_ms) / 1000.0f, 0);
    b->stale_told = true;
    return false;
}

/* Puts the link's readings behind the board's. A channel that was bound before its plant went reads as missing there, too. */
static void add_readings(const struct both_io *b, unsigned kind, bool fresh,
                         struct io_reading *reading, uint8_t *n)
{
    for (unsigned i = *n; i < IO_CHANNELS_MAX; i++) {
        unsigned k = i - *n;
        reading[i] = (struct io_reading){.quality = QUALITY_MISSING};
        if (fresh && k < LINK_CHANNELS_ROOM)
            reading[i] = (struct io_reading){b->value[kind][k], (enum quality)b->quality[kind][k]};
    }
    *n = (uint8_t)(*n + link_count(b, kind != 0));
}

static bool both_poll(void *context, uint64_t now_ms, struct io_sample *sample)
{
    struct both_io *b = context;
    struct io_port link = plant_link_port(b->link), board = board_io_port(b->board);
    bool more = true;
    for (unsigned n = 0; n < SAMPLES_MOST && more; n++) {
        more = link.poll(b->link, now_ms, sample);
        look_at_link(b, now_ms);
        if (more)
            keep_link_sample(b, sample, now_ms);
    }
    if (!board.poll(b->board, now_ms, sample))
        return false;
    bool fresh = is_fresh(b, now_ms);
    add_readings(b, 0, fresh, sample->measurement, &sample->n_measurements);
    add_readings(b, 1, fresh, sample->readback, &sample->n_readback);
    sample->reception = b->reception;
    b->reception = 0;
    b->parted = false;
    return true;
}

/* ---- the port ---- */

static enum io_state both_state(const void *context)
{
    const struct both_io *b = context;
    struct io_port board = board_io_port(b->board);
    return board.state(b->board);
}

static uint32_t both_generation(const void *context)
{
    const struct both_io *b = context;
    struct io_port board = board_io_port(b->board);
    return board.generation(b->board);
}

static uint8_t both_count(const void *context, bool manipulated)
{
    return (uint8_t)(both_io_first_of_link(context, manipulated) +
                     link_count(context, manipulated));
}

static struct io_channel both_channel(const void *context, bool manipulated, uint8_t index)
{
    const struct both_io *b = context;
    struct io_port link = plant_link_port(b->link), board = board_io_port(b->board);
    uint8_t first = both_io_first_of_link(b, manipulated);
    return index < first ? board.channel(b->board, manipulated, index)
                         : link.channel(b->link, manipulated, (uint8_t)(index - first));
}

static uint32_t both_tick_ms(const void *context)
{
    const struct both_io *b = context;
    struct io_port board = board_io_port(b->board);
    return board.tick_ms(b->board);
}

static enum err both_command(void *context, const struct io_command *c, uint64_t now_ms)
{
    struct both_io *b = context;
    struct io_port board = board_io_port(b->board);
    uint8_t first = both_io_first_of_link(b, true);
    enum err err = board.command(b->board, c, now_ms);
    /* Not a command from before the plant came. */
    if (b->joined && b->unanswered && c->n_outputs == first + link_count(b, true))
        b->unanswered = plant_link_answer(b->link, c, first, b->number, b->time, now_ms) != ERR_OK;
    return err;
}

struct io_port both_io_port(struct both_io *b)
{
    return (struct io_port){.context = b,
                            .poll = both_poll,
                            .state = both_state,
                            .generation = both_generation,
                            .count = both_count,
                            .channel = both_channel,
                            .tick_ms = both_tick_ms,
                            .command = both_command};
}

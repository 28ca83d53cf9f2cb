/* The plant in two parts: some channels at the board's own pins, the others at the plant link. hal/io.h implemented on the two (io/board_io.h,
 * io/plant_link.h), each of which works alone as well. io.source chooses.
 *
 *  1. The board's clock samples. A sample has the board's channels first, then the link's, with the newest reading that came over the link.
 *  2. Readings of the link are missing while its plant is silent or greets, and when its last new sample is older than three intervals of the
 *     link's plant and a base tick, LINK_SILENCE_MS at least. A sample that comes again, or whose time does not move on, is not new.
 *  3. A command has both parts. The board's outputs get theirs at once. The link's plant gets its part as the answer to its newest sample, in
 *     each tick that finds one without an answer: a plant in lockstep goes at the board's pace, and a sample that comes again gets what the
 *     next tick commands.
 *  4. The link's plant may come, go and come with another table while the board goes on: neither `state` nor `generation` change, but
 *     both_io_link_changed() says so, because its channels must be bound anew.
 *  5. A plant with a channel of the same kind and name as one at the pins is refused, and one with too many channels beside those.
 * Contexts: functions of the tick.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_IO_BOTH_IO_H
#define REFLUX_IO_BOTH_IO_H

#include "io/board_io.h"
#include "io/plant_link.h"

#if CONFIG_DEVICES && CONFIG_LINK
struct both_io {
    struct board_io *board;
    struct plant_link *link;
    uint32_t board_generation, link_generation; /* that have been looked at */
    bool met;                                   /* the link's plant is accepted */
    bool joined; /* and its channels are here, since its first sample */
    bool parted; /* they were until now: one sample goes without them, so that their loops notice */
    bool changed;    /* since both_io_link_changed() */
    bool sampled;    /* `value` and so on are of a sample */
    bool unanswered; /* the sample `number` has no command */
    bool stale_told;
    uint32_t number; /* of the link's newest sample, new or not */
    plant_time_ms time;
    uint64_t new_ms;    /* board time of the last new one */
    uint32_t reception; /* counts of hal_cycles() since the sample before */
    /* Of the last new one: measurements, read-backs. */
    float value[2][LINK_CHANNELS_ROOM];
    uint8_t quality[2][LINK_CHANNELS_ROOM];
};

/* Returns whether the link's plant has channels in the table. */
static inline bool both_io_has_link(const struct both_io *b)
{
    return b->joined;
}
#else
struct both_io {
};
static inline bool both_io_has_link(const struct both_io *b)
{
    (void)b;
    return false;
}
#endif

/* Begins anew, with whatever plant the link has at the moment. */
void both_io_init(struct both_io *b, struct board_io *board, struct plant_link *link);
struct io_port both_io_port(struct both_io *b);

/* Returns true once when the link's plant has come, gone or changed. */
bool both_io_link_changed(struct both_io *b);
/* Returns the index of the first channel that is not the board's. */
uint8_t both_io_first_of_link(const struct both_io *b, bool manipulated);

#endif

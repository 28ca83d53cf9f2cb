/* What surrounds the pins of a virtual board.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_VIRTUAL_BOARD_WORLD_H
#define REFLUX_VIRTUAL_BOARD_WORLD_H

#include "chips/world.h"

struct board;

/* The world's context lives longer than the board. With a world, verdicts of a run by blocks name the block and not the instruction (replay.h). */
void board_set_world(struct board *b, const struct world *world);

/* The world is another one than before: looks at its pins, and asks anew for its next edge. */
void board_world_changed(struct board *b);

/* What is wired to an input has another level from now on; interrupts of edges come from here. */
void board_set_pin(struct board *b, unsigned pin, enum pin_level level);

#endif

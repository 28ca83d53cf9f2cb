/* The pilot column at a board's link, in this process: a sample each 0.1 s of the board. Every command on the line is looked at, in answer to
 * a sample or not.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_BOARD_CAMPAIGN_PLANT_SIDE_H
#define REFLUX_BOARD_CAMPAIGN_PLANT_SIDE_H

#include "board.h"

struct plant_side;

/* NULL with the reason on stderr. */
struct plant_side *plant_side_new(struct board *board);
void plant_side_turn(struct plant_side *p);

/* Samples answered so far. */
unsigned plant_side_ticks(const struct plant_side *p);
/* The first command with an output that was neither within its limits nor at its safe value, or what else went wrong; "": none. */
const char *plant_side_wrong(const struct plant_side *p);

#endif

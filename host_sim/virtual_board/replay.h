/* Exact addresses in fast mode: what came to the board is kept, with its cycle; at a fault or a verdict within a block a second board runs
 * the same from power-on, and the last block of it instruction by instruction.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_VIRTUAL_BOARD_REPLAY_H
#define REFLUX_VIRTUAL_BOARD_REPLAY_H

#include "board.h"

/* Before board_power_on(), once what is in the flash for settings is there. Without it addresses are those of blocks. */
void replay_begin(struct board *b);
void replay_free(struct board *b);

enum replay_input { REPLAY_CONSOLE, REPLAY_LINK, REPLAY_FAULT };
void replay_note(struct board *b, enum replay_input what, const void *bytes, size_t n);

/* Program counter of the access that is under way in the block that began at the cycle. False: not known. */
bool replay_find_pc(struct board *b, uint64_t block_began, uint32_t *pc);

#endif

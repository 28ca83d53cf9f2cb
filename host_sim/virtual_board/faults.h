/* Faults of the hardware at a moment of the board's time (fault_table.h lists them).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_VIRTUAL_BOARD_FAULTS_H
#define REFLUX_VIRTUAL_BOARD_FAULTS_H

#include "board.h"
#include "virtual_board/fault_table.h"

struct faults *faults_new(struct board *b);
void faults_free(struct faults *f);

/* A fault, or a setting of those that follow. False, with the reason in err: it cannot be done. */
bool faults_add(struct board *b, enum fault_kind kind, double value, char *err, size_t err_size);
/* The same from lines "NAME VALUE\n". */
bool faults_add_text(struct board *b, const char *text, size_t n, char *err, size_t err_size);

/* Cycles at which the core must stop for the next fault, even within a block; BOARD_NEVER: none. Asleep, instructions do not count on. */
uint64_t faults_next(const struct board *b, bool asleep);
/* Does what is due. */
void faults_run(struct board *b);
/* The core has stopped as near to the next fault as it can. */
void faults_run_at_stop(struct board *b);
/* After board_run(): the supply goes where flash_cut_word or flash_cut_erase said. True: it has gone. */
bool faults_take_flash_cut(struct board *b);

#endif

/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_VIRTUAL_BOARD_STORED_FLASH_H
#define REFLUX_VIRTUAL_BOARD_STORED_FLASH_H

#include "models.h"

/* After a change of `open`, `watched` or `cache_old`: it may be read like other memory now, or no longer. */
void stored_flash_changed(struct board *b);

/* at: from the beginning of what is stored. */
void stored_flash_program(struct board *b, uint32_t at, unsigned bytes, uint32_t word);
void stored_flash_erase(struct board *b, uint32_t at, uint32_t bytes);
/* Per mille of the next erase's time after which the supply goes; 1000: it stays. */
uint32_t stored_flash_erase_share(struct board *b);
/* An erase that a reset ends early; a word that one ends early. */
void stored_flash_erase_partly(struct board *b, uint32_t at, uint32_t bytes, uint32_t per_mille);
void stored_flash_weaken(struct board *b, uint32_t at, uint32_t bytes);

#endif

/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_VIRTUAL_BOARD_STORED_FLASH_H
#define REFLUX_VIRTUAL_BOARD_STORED_FLASH_H

#include "models.h"

/* The interface takes stores and erases, or no longer. */
void stored_flash_set_open(struct board *b, bool open);
/* After a change of `watched` or `cache_old`: it may be read like other memory now, or no longer. */
void stored_flash_changed(struct board *b);

/* at: from the beginning of what is stored. */
void stored_flash_program(struct board *b, uint32_t at, unsigned bytes, uint32_t word);
void stored_flash_erase(struct board *b, uint32_t at, uint32_t bytes);
/* Per mille of the next erase's time after which the supply goes; 1000: it stays. */
uint32_t stored_flash_erase_share(struct board *b);
/* An erase that a reset ends early; a word that one ends early. */
void stored_flash_erase_partly(struct board *b, uint32_t at, uint32_t bytes, uint32_t per_mille);
void stored_flash_weaken(struct board *b, uint32_t at, uint32_t bytes);

/* A word or an erase under way, of either chip's flash interface. */
struct flash_operation {
    struct board_event done;
    bool erasing;
    uint32_t at, bytes; /* of the word or of what is erased, from the beginning of what is stored */
    uint64_t began_ns;
};
void flash_operation_start(struct part *interface, struct flash_operation *o,
                           void (*done)(void *context));
/* at and bytes are set, erasing too. The core stands still so long. */
void flash_operation_begin(struct board *b, struct flash_operation *o, uint64_t ns);
void flash_operation_end(struct board *b, struct flash_operation *o);
/* A reset ends it early, if one is under way; erase_ns: of a whole erase. */
void flash_operation_reset(struct board *b, struct flash_operation *o, uint64_t erase_ns);

#endif

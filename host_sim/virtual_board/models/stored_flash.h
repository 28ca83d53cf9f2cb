/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_VIRTUAL_BOARD_STORED_FLASH_H
#define REFLUX_VIRTUAL_BOARD_STORED_FLASH_H

#include "models.h"

/* at: from the beginning of what is stored. */
void stored_flash_program(struct board *b, uint32_t at, unsigned bytes, uint32_t word);
void stored_flash_erase(struct board *b, uint32_t at, uint32_t bytes);

#endif

/* Writes the settings of blocks: gives block n a kind and room for its settings in the configuration's pool, which the other
 * blocks' settings move for. Main loop. */
#ifndef REFLUX_SETTINGS_BLOCK_POOL_H
#define REFLUX_SETTINGS_BLOCK_POOL_H

#include "exchange/block_settings.h"

/* The same, to be written; the block must have one, and record_to_write() must have been asked. */
void *record_place(struct config *config, uint8_t n);
/* Before the settings of block n are written: a table that others refer to is copied. ERR_FULL: no place for the copy. */
MUST_CHECK enum err record_to_write(struct config *config, uint8_t n);
/* Block n gets that kind, with the kind's defaults; nothing changes where it has it already. "": none, and no names.
 * ERR_UNKNOWN; ERR_FULL: *needed bytes, more than *free, or of a table no place (*needed 0); nothing has changed then. */
MUST_CHECK enum err record_make(struct config *config, uint8_t n, const char *kind,
                                uint32_t *needed, uint32_t *free);
/* As stored: a kind that is unknown, or finds no room, stays as a name without a record. False then. */
bool record_restore(struct config *config, uint8_t n, const char *kind);

#endif

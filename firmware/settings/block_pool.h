/* Writes the settings of blocks: gives block n a kind, and room for its settings in the pool of the configuration. The settings of
 * the other blocks move. Main loop. */
#ifndef REFLUX_SETTINGS_BLOCK_POOL_H
#define REFLUX_SETTINGS_BLOCK_POOL_H

#include "exchange/block_settings.h"

/* Returns the record of block n, to be written. The block must have one, and record_to_write() must have returned ERR_OK. */
void *record_place(struct config *config, uint8_t n);
/* Prepares the settings of block n for writing: copies a table that others refer to. ERR_FULL: there is no place for the copy. */
MUST_CHECK enum err record_to_write(struct config *config, uint8_t n);
/* Gives block n that kind, with the kind's defaults. Nothing changes where it has the kind already. "": no kind, and no names.
 * On an error nothing has changed. ERR_UNKNOWN. ERR_FULL: the record needs *needed bytes, more than *free, or there is no place
 * for its table (*needed 0). */
MUST_CHECK enum err record_make(struct config *config, uint8_t n, const char *kind,
                                uint32_t *needed, uint32_t *free);
/* Gives block n a stored kind. Returns false where the kind is unknown or finds no room; it then stays as a name without a record. */
bool record_restore(struct config *config, uint8_t n, const char *kind);

#endif

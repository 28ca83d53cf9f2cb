/* Tables: settings that are too large to stand in every configuration (struct block_kind, `table`). They have a few
 * places of their own, and a configuration says in which of them a block's table is. Copies of a configuration
 * share the table.
 *
 * Rules
 *  1. A place is free when no watched configuration refers to it. All live configurations are watched: both plans, and the
 *     one that automatic start-up may go back to.
 *  2. Nobody writes a table that another configuration refers to: table_to_write() copies it before. So a table in
 *     force does not change, and the tick reads it while the main loop fills another.
 *  3. Only the main loop calls these functions; table_at() is for the tick too.
 */
#ifndef REFLUX_EXCHANGE_TABLES_H
#define REFLUX_EXCHANGE_TABLES_H

#include "base/error.h"
#include "exchange/config.h"

/* Text that says why there is no place, and how to get one. */
#define TABLES_TAKEN                                                                               \
    "no place for another table beside those in force (and start-up's way back, during a trial): " \
    "set the kind of a block that has one to -, apply, then paste"

#if CONFIG_BLOCKS

enum tables_watcher { TABLES_OF_PLAN, TABLES_OF_OTHER_PLAN, TABLES_TO_GO_BACK_TO, TABLES_WATCHERS };

/* Frees all places, and watches no configuration. */
void tables_begin(void);
/* Watches *config under `who`; NULL if there is none. */
void tables_watch(enum tables_watcher who, const struct config *config);

/* Returns the table of block n, which must have one. */
void *table_at(const struct config *config, uint8_t n);
/* Returns the places that *config may take if it gives up those it has now. */
unsigned tables_free_for(const struct config *config);
/* Gives block n a place for a table of its own, all 0. Returns false if there is none; then nothing has changed. */
bool table_take(struct config *config, uint8_t n);
/* Prepares the table of block n for writing: if another block or configuration refers to it too, the block gets a
 * copy. ERR_FULL: there is no place for a copy. */
MUST_CHECK enum err table_to_write(struct config *config, uint8_t n);
/* Returns the checksum crc, continued over the tables of *config. */
uint32_t tables_identity(const struct config *config, uint32_t crc);
/* Makes *config refer to the place of *other for every table that is equal to one of *other. */
void tables_share(struct config *config, const struct config *other);

#else
#define tables_begin()               ((void)0)
#define tables_watch(who, config)    ((void)0)
#define tables_identity(config, crc) ((void)(config), (crc))
#define tables_share(config, other)  ((void)(config), (void)(other))
#define tables_free_for(config)      ((void)(config), 0u)
#endif

#endif

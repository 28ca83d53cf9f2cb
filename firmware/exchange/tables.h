/* Tables: settings too large to stand in every configuration (struct block_kind, `table`). They have few places of their own,
 * and a configuration says which of them a block's table is in; copies of a configuration share it.
 *
 * Rules
 *  1. A place is free when no configuration that is watched refers to it. Watched are all that live: both plans, and what
 *     automatic start-up may go back to.
 *  2. A table that another configuration refers to is never written: it is copied before (table_to_write()). So a table in
 *     force does not change, and the tick reads it while the main loop fills another.
 *  3. Main loop only, but for table_at().
 */
#ifndef REFLUX_EXCHANGE_TABLES_H
#define REFLUX_EXCHANGE_TABLES_H

#include "base/error.h"
#include "exchange/config.h"

/* Why there is no place, in words, and how to get one. */
#define TABLES_TAKEN                                                                               \
    "no place for another table beside those in force (and start-up's way back, during a trial): " \
    "set the kind of a block that has one to -, apply, then paste"

#if CONFIG_BLOCKS

enum tables_watcher { TABLES_OF_PLAN, TABLES_OF_OTHER_PLAN, TABLES_TO_GO_BACK_TO, TABLES_WATCHERS };

/* All places are free, nobody is watched. */
void tables_begin(void);
/* NULL: there is none. */
void tables_watch(enum tables_watcher who, const struct config *config);

/* Table of block n, which must have one. */
void *table_at(const struct config *config, uint8_t n);
/* Places that *config may still take, if what it has now is given up. */
unsigned tables_free_for(const struct config *config);
/* Block n gets a place for a table of its own, all 0. False: there is none; nothing has changed. */
bool table_take(struct config *config, uint8_t n);
/* Block n is about to be written: if another refers to its table too it gets a copy. ERR_FULL: there is no place for one. */
MUST_CHECK enum err table_to_write(struct config *config, uint8_t n);
/* A checksum that goes on over what is in the tables of *config. */
uint32_t tables_identity(const struct config *config, uint32_t crc);
/* Tables of *config that are equal to one of *other are the same place from now on. */
void tables_share(struct config *config, const struct config *other);

#else
#define tables_begin()               ((void)0)
#define tables_watch(who, config)    ((void)0)
#define tables_identity(config, crc) ((void)(config), (crc))
#define tables_share(config, other)  ((void)(config), (void)(other))
#define tables_free_for(config)      ((void)(config), 0u)
#endif

#endif

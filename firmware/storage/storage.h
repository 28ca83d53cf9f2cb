/* Parameter storage: sets of keyed records in flash. Format and life of a save: docs/inside/storage.md.
 *
 * There are two slots, each a half of the area that hal/nvm.h describes. A save appends a whole set to a slot that was
 * erased before, and confirms it. The newest whole set counts, and storage never overwrites what it needs to find that
 * set. A power cut can leave words that read differently each time. A start therefore writes its decision on such words
 * down before it does anything else.
 *
 * Rules
 *  1. Storage works in the main loop only, in small pieces: storage_poll() does at most one flash operation.
 *  2. An erase stalls the processor. It happens only while all loops are in manual: after a start, before the
 *     stored set comes into force, when the slot in use has no room for another set; or in a save.
 *  3. Storage touches the flash only after the first command has gone out, or after STORAGE_WAIT_MS without a plant, or
 *     when an operator asks.
 *  4. One bad value never costs the other stored settings. The next save carries unknown ids over (except those of a
 *     block that has got another kind). Values out of range are clipped and reported one by one.
 *  5. Storage writes nothing while there is something in a format of newer firmware, unless storage_save() has
 *     `replace`.
 */
#ifndef REFLUX_STORAGE_STORAGE_H
#define REFLUX_STORAGE_STORAGE_H

#include "storage/storage_state.h"

void storage_init(struct storage *st, struct service *service);

/* Does one piece of work. Returns whether there was any. */
bool storage_poll(struct storage *st);

/* Returns whether the flash has been read, so that load and save can work. The call also ends the wait after a start. */
bool storage_ready(struct storage *st);

/* Begins to store service_plan(). The caller keeps service_staged() free until storage_saving() is false; then
 * storage_result() has the result. `replace`: store also where that erases settings of newer firmware. On an error nothing
 * has begun. ERR_UNSUPPORTED. ERR_VERSION: newer firmware has stored something. ERR_STATE: a transaction is open, a loop
 * acts and an erase is needed, or the defaults that run would replace a stored set that was refused. ERR_BUSY: storage is
 * not ready. ERR_FULL. ERR_IO: the last write failed and an erase is needed. */
MUST_CHECK enum err storage_save(struct storage *st, bool replace, const char **reason);
bool storage_saving(const struct storage *st);
MUST_CHECK enum err storage_result(const struct storage *st, const char **reason);

/* Loads the stored set over the defaults, and reports changed values as events. On an error *config is unchanged.
 * ERR_UNSUPPORTED. ERR_EMPTY. ERR_VERSION: there are only settings of newer firmware. ERR_CRC: the flash holds something
 * but no whole set. ERR_FULL: the set has a table for which there is no place beside those in force. */
MUST_CHECK enum err storage_load(struct storage *st, struct config *config, const char **reason);

#if CONFIG_PEOPLE
/* Returns whether storage_differs() has a stored set to compare with. ERR_BUSY: storage reads or writes. ERR_EMPTY. */
MUST_CHECK enum err storage_may_compare(struct storage *st, const char **reason);
/* Returns whether a parameter differs from the newest stored set, and writes the stored value. A value that older firmware has stored as
 * another type differs. So does one whose default follows a parameter that differs, because setting that parameter may move it. */
bool storage_differs(const struct storage *st, const struct parameter *p,
                     const struct config *config, struct text *stored);
#endif

/* Returns the state: "none", "unread", "ok", "blocked" (newer firmware has stored something) or "failed" (the flash refused the
 * last write). */
const char *storage_word(const struct storage *st);
/* Writes the state in words: "ok, set 12 bytes 1304 room 14000 erases 1" */
void storage_text(const struct storage *st, struct text *line);

#endif

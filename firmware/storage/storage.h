/* Parameter storage: sets of keyed records in flash. Format and life of a save: docs/storage.md.
 *
 * Two slots, each a half of the area hal/nvm.h describes. A save appends a whole set to a slot that was erased before,
 * and confirms it; the newest whole set counts, and nothing that is needed to find it is ever written again. A cut of
 * the power can leave words behind that read now so, now so: what a start decides on them it writes down, before
 * anything else is done.
 *
 * Rules
 *  1. Main loop only, in small pieces: storage_poll() does at most one flash operation.
 *  2. An erase stalls the processor. It happens only while all loops are in manual: after a start, before the
 *     stored set is put into force, when the slot in use has no room for another set; or in a save.
 *  3. Nothing is touched before the first command has gone out, or until no plant has come for STORAGE_WAIT_MS.
 *  4. What is stored is never given up because of one value: unknown ids are carried over by the next save (but those
 *     of a block that has got another kind), values out of range are clipped and told one by one.
 *  5. Nothing is written while there is something in a format of newer firmware, until storage_save() is told to
 *     replace it.
 */
#ifndef REFLUX_STORAGE_STORAGE_H
#define REFLUX_STORAGE_STORAGE_H

#include "storage/storage_state.h"

void storage_init(struct storage *st, struct service *service);

/* One piece of work. Returns whether there was any. */
bool storage_poll(struct storage *st);

/* Has the flash been read, so that load and save can do their work? Asking ends the wait after a start. */
bool storage_ready(struct storage *st);

/* Begins to store service_plan(). The caller keeps service_staged() free until storage_saving() is false; then
 * storage_result() tells. `replace`: also where that erases what newer firmware has stored. ERR_UNSUPPORTED, ERR_VERSION
 * (newer firmware has stored something), ERR_STATE (needs an erase while a loop acts; would replace a set that was
 * refused by the defaults that run instead), ERR_FULL: nothing begun. */
MUST_CHECK enum err storage_save(struct storage *st, bool replace, const char **reason);
bool storage_saving(const struct storage *st);
MUST_CHECK enum err storage_result(const struct storage *st, const char **reason);

/* The stored set over the defaults; what had to be changed is told by events. ERR_UNSUPPORTED, ERR_EMPTY, ERR_VERSION
 * where there is only something of newer firmware, ERR_CRC where there is something but no whole set: *config is
 * unchanged. ERR_FULL: it has a table for which there is no place beside those in force. */
MUST_CHECK enum err storage_load(struct storage *st, struct config *config, const char **reason);

/* "none", "unread", "ok", "blocked": newer firmware has stored something, or "failed": the last write was not taken. */
const char *storage_word(const struct storage *st);
/* "ok, set 12 bytes 1304 room 14000 erases 1" */
void storage_text(const struct storage *st, struct text *line);

#endif

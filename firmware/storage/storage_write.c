/* Storage, writing: prepares a slot, and appends a set to it. */
#include <string.h>

#include "base/assertion.h"
#include "base/crc32.h"
#include "hal/nvm.h"
#include "io/board_io.h"
#include "service/early_resets.h"
#include "storage/storage.h"
#include "storage/storage_parts.h"

#define NOT_TAKEN "the flash does not take the write (emulated, worn or protected)"

#define TRIES_MOST 4u

static void saved(struct storage *st, enum err err, const char *reason)
{
    st->result = err;
    st->reason = reason;
    st->saving = false;
    st->failed = err != ERR_OK;
    st->state = READY;
}

void storage_verified(struct storage *st, bool whole)
{
    if (whole)
        st->state = CONFIRMING;
    else
        saved(st, ERR_IO, NOT_TAKEN);
}

/* ---- erasing ---- */

static bool may_erase(const struct storage *st)
{
    const struct service *s = st->service;
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++)
        if (service_mode(s, i) != LOOP_MANUAL)
            return false;
    return s->supervisor->ticks > 0 || s->io.state(s->io.context) != IO_READY;
}

static bool has_room(const struct storage *st, uint8_t slot, uint32_t bytes)
{
    return st->prepared[slot] && st->slot_size - st->used[slot] >= bytes;
}

/* Chooses the slot to append a set of that size to: the one in use as long as it has room. Returns false where neither has. */
static bool find_room(struct storage *st, uint32_t bytes)
{
    bytes += SAVE_ROOM;
    st->slot = slot_in_use(st);
    if (has_room(st, st->slot, bytes))
        return true;
    st->slot = (uint8_t)!st->slot;
    return has_room(st, st->slot, bytes);
}

static void begin_erase(struct storage *st)
{
    /* Never the slot with the newest whole set. */
    st->slot = st->newest.sequence ? (uint8_t)!slot_in_use(st) : 0;
    st->prepared[st->slot] = false;
    st->used[st->slot] = st->slot_size;
    st->read_address = 0;
    st->state = UNMARKING;
}

static void not_taken(struct storage *st, enum err err)
{
    st->failed = true;
    if (st->saving)
        saved(st, ERR_IO,
              err == ERR_STATE ? "the supply is too low to write the flash" : NOT_TAKEN);
    else
        st->state = TAKING;
}

/* Checks again before each step of an erase, because somebody may have put a loop into auto meanwhile. */
static bool still_may_erase(struct storage *st)
{
    if (may_erase(st))
        return true;
    if (st->saving)
        saved(st, ERR_STATE, "an erase is needed, and a loop acts by now");
    else
        st->state = TAKING;
    return false;
}

/* Zeroes the mark before an erase. A mark means that the slot was erased to the end, and it could survive an erase that a power
 * cut ends. */
static void unmark(struct storage *st)
{
    static const uint8_t zeros[STORAGE_GRAIN];
    if (!still_may_erase(st))
        return;
    enum err err = hal_nvm_program(slot_address(st, st->slot), zeros, sizeof zeros);
    if (err == ERR_OK)
        st->state = ERASING;
    else
        not_taken(st, err);
}

static void erase(struct storage *st)
{
    if (!still_may_erase(st))
        return;
    board_io_stand_by(true);
    enum err err = hal_nvm_erase(st->slot * st->slot_sectors + st->read_address);
    board_io_stand_by(false);
    if (err != ERR_OK) {
        not_taken(st, err);
        return;
    }
    st->read_address++;
    if (st->read_address < st->slot_sectors)
        return;
    st->newer[st->slot] = 0;
    st->sure[st->slot] = false;
    st->state = MARKING;
}

/* Returns the room for the largest set that this build can make, or for one like the newest, so that the next save needs no
 * erase. The largest set does not count tables of blocks, because they would fill a small slot. */
static uint32_t largest_set(const struct storage *st)
{
    uint32_t bytes = 0;
    for (unsigned g = 0; g < parameter_group_count; g++) {
        struct parameter p = {.group = &parameter_groups[g]};
        for (unsigned f = 0; f < p.group->n_fields; f++) {
            p.field = &p.group->fields[f];
            bool wide = CONFIG_BLOCKS && parameter_id(&p) > UINT16_MAX;
            uint32_t head = RECORD_HEAD + (wide ? RECORD_WIDE : 0u);
            bytes += p.group->count * (head + (uint32_t)parameter_size(&p));
        }
    }
    if (CONFIG_BLOCKS && st->newest.sequence && st->newest.length > bytes)
        bytes = st->newest.length;
    bytes = set_size(bytes);
    uint32_t most = st->slot_size - STORAGE_GRAIN - SAVE_ROOM;
    return bytes < most ? bytes : most;
}

/* Returns whether storage may erase the other slot without a request. It may not while that slot could still be needed:
 * no whole set was found but a later start may read one, or the next start may not read the newest set. */
static bool other_is_spare(const struct storage *st)
{
    if (!st->newest.sequence)
        return !st->remains;
    return st->newest.closed == CLOSED_CONFIRMED || !st->sure[!slot_in_use(st)];
}

/* Makes room for the next save after a start, or goes on with the stored set. */
static void prepare(struct storage *st)
{
    if (find_room(st, largest_set(st)) || !other_is_spare(st) || !may_erase(st))
        st->state = TAKING;
    else
        begin_erase(st);
}

/* ---- a set ---- */

/* Begins the set of a save, or first the renewal or the erase that it needs. */
static void begin_set(struct storage *st)
{
    if (!storage_blocked(st) && storage_unsettled(st) && storage_can_renew(st))
        st->state = RENEWING;
    else if (!storage_blocked(st) && find_room(st, set_size(st->candidate.length)))
        st->state = WRITING_HEAD;
    else if (!st->newest.sequence || storage_blocked(st) || other_is_spare(st))
        begin_erase(st);
    else
        not_taken(st, ERR_FULL);
}

/* Finds the blocks that keep the kind that the newest set gives them. Under another kind the same ids mean something else. */
static void find_kept_blocks(struct storage *st)
{
    const struct config *config = service_staged(st->service);
    uint32_t address = st->newest.address + STORAGE_GRAIN;
    uint32_t left = st->newest.sequence ? st->newest.length : 0;
    struct stored_record r;
    uint8_t block;
    st->kept_blocks = 0;
    while (CONFIG_BLOCKS && record_at(address, left, &r)) {
        uint32_t size = RECORD_HEAD + r.size;
        if (record_of_block(&r, &block) && record_is_kind(&r, block, config))
            st->kept_blocks |= (uint8_t)(1u << block);
        address += size;
        left -= size;
    }
}

static bool is_kept(const struct storage *st, const struct stored_record *r)
{
    uint8_t block;
    return !CONFIG_BLOCKS || !record_of_block(r, &block) || (st->kept_blocks >> block & 1u) != 0;
}

static void rewind_records(struct storage *st)
{
    st->parameter = 0;
    st->record_n = st->record_at = 0;
    st->copy_left = 0;
    st->old = st->newest.address + STORAGE_GRAIN;
    st->old_left = st->newest.sequence ? st->newest.length : 0;
}

/* Takes the next record: those of the parameters, then those of the newest set that this build does not know. It puts the
 * record into `record`, or notes where to copy it from. Returns its size; 0 after the last one. */
static uint32_t next_record(struct storage *st)
{
    struct config *config = service_staged(st->service);
    struct parameter p;
    struct stored_record r;
    bool renamed;
    while (parameter_of(config, st->parameter, &p)) {
        st->parameter++;
        if (!record_wanted(&p, config))
            continue;
        st->record_n = record_encode(&p, config, st->record);
        st->record_at = 0;
        return st->record_n;
    }
    while (record_at(st->old, st->old_left, &r)) {
        uint32_t size = RECORD_HEAD + r.size;
        if (!record_parameter(&r, config, &p, &renamed) && is_kept(st, &r)) {
            st->copy_left = size;
            return size;
        }
        st->old += size;
        st->old_left -= size;
    }
    return 0;
}

static uint32_t count_records(struct storage *st)
{
    uint32_t all = 0, size;
    find_kept_blocks(st);
    rewind_records(st);
    while ((size = next_record(st)) != 0) {
        all += size;
        if (st->copy_left) {
            st->old += size;
            st->old_left -= size;
            st->copy_left = 0;
        }
    }
    rewind_records(st);
    return all;
}

/* Gets the next byte of the records. Returns false after the last one. */
static bool next_byte(struct storage *st, uint8_t *byte)
{
    if (st->record_at == st->record_n && !st->copy_left && next_record(st) == 0)
        return false;
    if (st->copy_left) {
        if (storage_read(st->old, byte, 1) != ERR_OK)
            return false;
        st->old++;
        st->old_left--;
        st->copy_left--;
        return true;
    }
    *byte = st->record[st->record_at++];
    return true;
}

/* Programs the piece at the end of the slot. Where the flash refuses it, the next turn tries behind that place, up to `tries`
 * times, because words that a power cut has left may look erased for a while. */
static bool program(struct storage *st, unsigned tries)
{
    uint32_t at = st->used[st->slot];
    enum err err = ERR_FULL;
    if (st->slot_size - at >= st->piece_n) {
        st->used[st->slot] += st->piece_n; /* never programmed again, even after a failure */
        err = hal_nvm_program(slot_address(st, st->slot) + at, st->piece, st->piece_n);
        st->tries = err == ERR_OK ? 0 : (uint8_t)(st->tries + 1u);
        if (err == ERR_OK || st->tries < tries)
            return err == ERR_OK;
    }
    st->tries = 0;
    not_taken(st, err);
    return false;
}

static void write_mark(struct storage *st)
{
    st->used[st->slot] = 0;
    (void)storage_grain(st->piece, MARK_MAGIC, st->erases[st->slot] + 1u, FORMAT, 0);
    st->piece_n = STORAGE_GRAIN;
    if (!program(st, 1))
        return;
    st->erases[st->slot]++;
    st->prepared[st->slot] = true;
    if (!st->saving)
        st->state = TAKING;
    else if (st->candidate.sequence)
        saved(st, ERR_OK, NULL);
    else
        st->state = WRITING_HEAD;
}

/* Writes the decision of a start down: the newest set gets another tail, whose words no power cut has left. It has the latest
 * sequence, so that no unconfirmed set comes after it. */
static void renew(struct storage *st)
{
    struct storage_set set = st->newest;
    st->slot = slot_in_use(st);
    set.tail = slot_address(st, st->slot) + st->used[st->slot];
    set.sequence = st->sequence;
    set.closed = CLOSED_AGAIN;
    (void)storage_renewal(&set, st->piece, st->newest_crc);
    st->piece_n = STORAGE_GRAIN;
    if (!program(st, TRIES_MOST))
        return;
    st->newest = set;
    st->state = CONFIRMING;
}

/* Goes on after a start or a save has confirmed the newest set. */
static void confirmed(struct storage *st)
{
    st->newest.closed = CLOSED_CONFIRMED;
    st->sequence = st->sure_sequence = st->newest.sequence;
    st->sure[st->slot] = true;
    if (!st->saving)
        st->state = PREPARING;
    else if (!st->candidate.sequence)
        begin_set(st);
    else if (st->newer[!st->slot])
        begin_erase(st); /* the save replaces the settings of newer firmware */
    else
        saved(st, ERR_OK, NULL);
}

/* Writes the confirmation: the tail before it was written to its end. Where the flash refuses it, both are written again. */
static void confirm(struct storage *st)
{
    (void)storage_grain(st->piece, HEAD_MAGIC, st->newest.sequence,
                        st->newest.length | CONFIRMATION << 16, 0);
    st->piece_n = STORAGE_GRAIN;
    if (program(st, TRIES_MOST))
        confirmed(st);
    else if (st->state == CONFIRMING && storage_can_renew(st))
        st->state = RENEWING;
    else if (st->state == CONFIRMING)
        not_taken(st, ERR_IO);
}

static void write_head(struct storage *st)
{
    struct storage_set *set = &st->candidate;
    uint32_t sequence = next_sequence(st->sequence);
    set->address = slot_address(st, st->slot) + st->used[st->slot];
    set->tail = set->address + set_size(set->length) - STORAGE_GRAIN;
    (void)storage_grain(st->piece, HEAD_MAGIC, sequence,
                        set->length | FORMAT << 16 | (uint32_t)CONFIG_SCHEMA << 24, 0);
    st->crc = crc32_update(0, st->piece, STORAGE_GRAIN);
    st->piece_n = STORAGE_GRAIN;
    st->body_left = whole_grains(set->length);
    if (!program(st, TRIES_MOST))
        return;
    if (!st->origin)
        st->origin = sequence;
    set->sequence = st->sequence = sequence;
    st->state = st->body_left ? WRITING_BODY : WRITING_TAIL;
}

static void write_body(struct storage *st)
{
    st->piece_n = st->body_left < STORAGE_PIECE ? st->body_left : STORAGE_PIECE;
    for (uint32_t i = 0; i < st->piece_n; i++)
        if (!next_byte(st, &st->piece[i]))
            st->piece[i] = 0;
    st->crc = crc32_update(st->crc, st->piece, st->piece_n);
    st->body_left -= st->piece_n;
    if (program(st, 1) && !st->body_left)
        st->state = WRITING_TAIL;
}

static void write_tail(struct storage *st)
{
    (void)storage_grain(st->piece, TAIL_MAGIC, st->candidate.length, st->candidate.sequence,
                        st->crc);
    st->piece_n = STORAGE_GRAIN;
    if (program(st, 1))
        storage_begin_check(st);
}

void storage_write(struct storage *st)
{
    switch ((enum storage_state)st->state) {
    case PREPARING:
        prepare(st);
        break;
    case UNMARKING:
        unmark(st);
        break;
    case ERASING:
        erase(st);
        break;
    case MARKING:
        write_mark(st);
        break;
    case RENEWING:
        renew(st);
        break;
    case CONFIRMING:
        confirm(st);
        break;
    case WRITING_HEAD:
        write_head(st);
        break;
    case WRITING_BODY:
        write_body(st);
        break;
    case WRITING_TAIL:
        write_tail(st);
        break;
    default:
        REFLUX_ASSERT(false); /* a state in which nothing is written */
        break;
    }
}

/* ---- a save ---- */

enum err storage_save(struct storage *st, bool replace, const char **reason)
{
    struct service *s = st->service;
    if (st->state == NO_STORAGE) {
        *reason = "this board has no storage";
        return ERR_UNSUPPORTED;
    }
    if (st->state != READY || s->staging) {
        *reason = s->staging ? "a transaction is open: apply or abandon it first" : NULL;
        return s->staging ? ERR_STATE : ERR_BUSY;
    }
    if (st->refused && !s->serial) {
        *reason =
            s->early_resets >= EARLY_RESETS_MOST
                ? "it would replace settings left out after resets in a row: `load` takes "
                  "them; or `defaults` first"
                : "it would replace settings that were refused by defaults: `load` says why; or "
                  "`defaults` first";
        return ERR_STATE;
    }
    if (storage_blocked(st) && !replace) {
        *reason = OF_NEWER;
        return ERR_VERSION;
    }
    (void)service_stage(s);
    uint32_t length = count_records(st), bytes = set_size(length);
    if (length > UINT16_MAX || bytes > st->slot_size - STORAGE_GRAIN - SAVE_ROOM) {
        *reason = "more than this board's flash for storage holds";
        return ERR_FULL;
    }
    if ((storage_blocked(st) || !find_room(st, bytes)) && !may_erase(st)) {
        *reason = st->failed
                      ? NOT_TAKEN
                      : "the flash must be erased first: put all loops into manual, or reboot";
        return st->failed ? ERR_IO : ERR_STATE;
    }
    st->candidate = (struct storage_set){.length = (uint16_t)length};
    st->saving = true;
    begin_set(st);
    return ERR_OK;
}

bool storage_saving(const struct storage *st)
{
    return st->saving;
}

enum err storage_result(const struct storage *st, const char **reason)
{
    *reason = st->reason;
    return st->result;
}

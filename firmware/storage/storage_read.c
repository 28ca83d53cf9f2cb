/* Storage, reading: finds the newest whole set, and loads its values. */
#include <string.h>

#include "base/crc32.h"
#include "exchange/tables.h"
#include "hal/nvm.h"
#include "storage/storage.h"
#include "storage/storage_parts.h"

/* ---- finding sets ---- */

static bool checked_grain(const uint8_t *grain, uint32_t magic)
{
    return get32(grain) == magic && get32(grain + 12) == crc32_update(0, grain, 12);
}

/* Returns whether all bytes of the grain equal `byte`. */
static bool all_are(const uint8_t *grain, uint8_t byte)
{
    return grain[0] == byte && memcmp(grain, grain + 1, STORAGE_GRAIN - 1u) == 0;
}

static bool blank(const struct storage *st, const uint8_t *grain)
{
    for (unsigned i = 0; i < STORAGE_GRAIN; i++)
        if (grain[i] != st->erased && grain[i] != 0)
            return false;
    return true;
}

/* Notes what a grain tells about the slot. Bytes that are erased or zero tell nothing: they are memory that was never
 * written, a model of such memory, or a removed mark. */
static void look_at(struct storage *st, const uint8_t *grain)
{
    bool mark = st->read_address == 0 && checked_grain(grain, MARK_MAGIC);
    if (!all_are(grain, st->erased) && st->used[st->slot] < st->read_address + STORAGE_GRAIN)
        st->used[st->slot] = st->read_address + STORAGE_GRAIN;
    if (mark && grain[8] == FORMAT) {
        st->prepared[st->slot] = true;
        st->erases[st->slot] = get32(grain + 4);
    } else if (mark && grain[8] > FORMAT) {
        st->newer[st->slot] = grain[8];
    } else if (!blank(st, grain)) {
        st->remains = true;
    }
}

void storage_tell(struct storage *st, enum event_code code, const char *subject, float value)
{
    service_record(st->service, code, subject, value, 0);
}

void storage_begin_check(struct storage *st)
{
    st->read_address = st->candidate.address;
    st->crc = 0;
    st->state = CHECKING;
}

void storage_begin_scan(struct storage *st)
{
    st->candidate = (struct storage_set){0};
    st->slot = 0;
    st->read_address = 0;
    st->again = false;
    st->state = SCANNING;
}

static bool before(const struct storage *st, const struct storage_set *a,
                   const struct storage_set *b)
{
    if (a->sequence != b->sequence)
        return later(st, b->sequence, a->sequence);
    return a->closed != b->closed ? a->closed < b->closed : a->tail < b->tail;
}

/* Makes the set the candidate if it lies within its slot, is before the limit, and is the newest so far. */
static void consider(struct storage *st, const struct storage_set *set)
{
    uint32_t begin = slot_address(st, st->slot), end = begin + st->slot_size;
    if (set->sequence != 0 && set->address >= begin && set->address < end &&
        set_size(set->length) <= end - set->address &&
        (st->limit.sequence == 0 || before(st, set, &st->limit)) && before(st, &st->candidate, set))
        st->candidate = *set;
}

static void see_sequence(struct storage *st, uint32_t sequence)
{
    if (st->origin == 0)
        st->origin = sequence;
    if (later(st, sequence, st->sequence))
        st->sequence = sequence;
}

/* Reads the set that a renewal or a tail closes. Returns whether the grain is one of them. */
static bool look_for_close(const struct storage *st, const uint8_t *grain, uint32_t address,
                           struct storage_set *set)
{
    set->tail = address;
    if (get32(grain) == RENEWAL_MAGIC) {
        set->sequence = get32(grain + 4);
        set->length = get16(grain + 8);
        set->address = get16(grain + 10) * STORAGE_GRAIN;
        set->closed = CLOSED_AGAIN;
        return true;
    }
    set->sequence = get32(grain + 8);
    set->length = get16(grain + 4);
    set->address = address - (set_size(set->length) - STORAGE_GRAIN);
    set->closed = CLOSED_BY_TAIL;
    return get32(grain) == TAIL_MAGIC &&
           address >= slot_address(st, st->slot) + set_size(set->length);
}

/* Looks for a head, a renewal or a confirmation. Each may lead to the newest set. */
static void look_for_set(struct storage *st, const uint8_t *grain)
{
    uint32_t address = slot_address(st, st->slot) + st->read_address, sequence = get32(grain + 4);
    uint8_t close[STORAGE_GRAIN];
    struct storage_set set;
    if (look_for_close(st, grain, address, &set) && set.closed == CLOSED_AGAIN)
        consider(st, &set);
    if (!checked_grain(grain, HEAD_MAGIC) || st->read_address == 0)
        return;
    if (grain[10] > FORMAT) {
        st->newer[st->slot] = grain[10];
        return;
    }
    see_sequence(st, sequence);
    if (grain[10] == FORMAT) {
        set = (struct storage_set){.sequence = sequence,
                                   .address = address,
                                   .length = get16(grain + 8),
                                   .closed = CLOSED_BY_TAIL};
        set.tail = address + set_size(set.length) - STORAGE_GRAIN;
        uint32_t end = st->read_address + set_size(set.length) + STORAGE_GRAIN;
        if (end > st->used[st->slot])
            st->used[st->slot] = end < st->slot_size ? end : st->slot_size;
        consider(st, &set);
        return;
    }
    st->sure[st->slot] = true;
    if (later(st, sequence, st->sure_sequence))
        st->sure_sequence = sequence;
    if (storage_read(address - STORAGE_GRAIN, close, sizeof close) == ERR_OK &&
        look_for_close(st, close, address - STORAGE_GRAIN, &set) && set.sequence == sequence) {
        set.closed = CLOSED_CONFIRMED;
        consider(st, &set);
    }
}

bool storage_blocked(const struct storage *st)
{
    return st->newer[0] || st->newer[1];
}

bool storage_unsettled(const struct storage *st)
{
    uint32_t newest = st->newest.sequence;
    /* A later set that was confirmed is damaged, but a later start may be able to read it. So the newest set is not closed again
     * under a later sequence. */
    return newest != 0 && !later(st, st->sure_sequence, newest) &&
           (st->newest.closed != CLOSED_CONFIRMED || later(st, st->sequence, newest));
}

bool storage_can_renew(const struct storage *st)
{
    uint8_t slot = slot_in_use(st);
    return st->prepared[slot] && st->slot_size - st->used[slot] >= RENEWAL_SIZE;
}

/* Returns whether there is a broken head at that address, where a set would begin. Remains of the newest set's
 * confirmation do not count: they have its sequence or its format, or an erased sequence. */
static bool broken_head(const struct storage *st, uint32_t address)
{
    uint8_t grain[STORAGE_GRAIN];
    if (!st->prepared[address >= st->slot_size] ||
        storage_read(address, grain, sizeof grain) != ERR_OK || all_are(grain, st->erased) ||
        checked_grain(grain, HEAD_MAGIC))
        return false;
    uint32_t sequence = get32(grain + 4);
    return address != st->newest.tail + STORAGE_GRAIN ||
           (sequence != st->newest.sequence && sequence != UINT32_MAX && grain[10] != CONFIRMATION);
}

/* Returns whether there is a newer set that is not whole. Its head tells a later sequence, or a broken head stands after
 * the newest whole set or first in the other slot. */
static bool newer_broken(const struct storage *st)
{
    uint8_t slot = slot_in_use(st), other = (uint8_t)!slot;
    uint32_t end = st->newest.tail + STORAGE_GRAIN;
    if (st->newest.closed == CLOSED_CONFIRMED)
        end += STORAGE_GRAIN;
    return later(st, st->sequence, st->newest.sequence) ||
           (end < slot_address(st, slot) + st->slot_size && broken_head(st, end)) ||
           broken_head(st, slot_address(st, other) + STORAGE_GRAIN);
}

/* Ends the search: `newest` is the newest whole set, or there is none. */
static void found(struct storage *st)
{
    uint8_t other = (uint8_t)!slot_in_use(st);
    st->state = storage_blocked(st) ? TAKING : PREPARING;
    if (!st->newest.sequence)
        return;
    if (st->older || newer_broken(st))
        st->older = st->newest.sequence;
    if (storage_blocked(st) || !storage_unsettled(st))
        return;
    if (storage_can_renew(st)) {
        st->state = RENEWING;
    } else if (st->newest.closed != CLOSED_CONFIRMED && st->sure[other]) {
        /* The next start may not read this set, and it cannot be closed again. The other slot holds a confirmed set. */
        st->limit = st->newest;
        st->newest.sequence = 0;
        storage_begin_scan(st);
    }
}

void storage_scan(struct storage *st)
{
    uint8_t grain[STORAGE_GRAIN];
    for (unsigned n = 0; n < STORAGE_TURN && st->read_address < st->slot_size; n++) {
        if (storage_read(slot_address(st, st->slot) + st->read_address, grain, sizeof grain) !=
            ERR_OK) {
            st->state = NO_STORAGE;
            return;
        }
        look_at(st, grain);
        look_for_set(st, grain);
        st->read_address += STORAGE_GRAIN;
    }
    if (st->read_address < st->slot_size)
        return;
    st->read_address = 0;
    st->slot++;
    if (st->slot < 2)
        return;
    if (st->candidate.sequence)
        storage_begin_check(st);
    else
        found(st);
}

static enum storage_verdict check_is_over(struct storage *st, bool whole)
{
    if (whole) {
        st->newest = st->candidate;
        see_sequence(st, st->newest.sequence);
    }
    if (st->saving)
        return whole ? STORAGE_WHOLE : STORAGE_NOT_WHOLE;
    if (whole) {
        found(st);
    } else if (!st->again) {
        st->again = true;
        storage_begin_check(st);
    } else {
        st->limit = st->candidate; /* search for an older set */
        storage_begin_scan(st);
    }
    return STORAGE_GOES_ON;
}

/* Returns whether the first grain of a set is its head. */
static bool is_its_head(const struct storage_set *set, const uint8_t *grain)
{
    return checked_grain(grain, HEAD_MAGIC) && grain[10] == FORMAT &&
           get16(grain + 8) == set->length && (!own_tail(set) || get32(grain + 4) == set->sequence);
}

/* Returns whether the grain is the tail or renewal of the set. crc: checksum of head and records. */
static bool closes(const struct storage_set *set, const uint8_t *grain, uint32_t crc)
{
    uint8_t wanted[STORAGE_GRAIN];
    if (own_tail(set))
        (void)storage_grain(wanted, TAIL_MAGIC, set->length, set->sequence, crc);
    else
        (void)storage_renewal(set, wanted, crc);
    return memcmp(grain, wanted, STORAGE_GRAIN) == 0;
}

enum storage_verdict storage_check(struct storage *st)
{
    const struct storage_set *set = &st->candidate;
    uint32_t end = set->address + set_size(set->length) - STORAGE_GRAIN;
    uint8_t grain[STORAGE_GRAIN];
    for (unsigned n = 0; n < STORAGE_TURN; n++) {
        bool last = st->read_address == end;
        if (storage_read(last ? set->tail : st->read_address, grain, sizeof grain) != ERR_OK ||
            (st->read_address == set->address && !is_its_head(set, grain))) {
            return check_is_over(st, false);
        }
        if (last) {
            st->newest_crc = st->crc;
            return check_is_over(st, closes(set, grain, st->crc));
        }
        st->crc = crc32_update(st->crc, grain, sizeof grain);
        st->read_address += STORAGE_GRAIN;
    }
    return STORAGE_GOES_ON;
}

/* ---- values ---- */

static void tell_changed(struct storage *st, const struct parameter *p, struct config *config)
{
    char name[CHANNEL_NAME_SIZE];
    struct text t = text_on(name, sizeof name);
    const void *at = parameter_place(p, config);
    if (CONFIG_BLOCKS && p->field->type == PARAMETER_KIND && block_is_unknown(config, p->index)) {
        storage_tell(st, EVENT_BLOCK_UNKNOWN, config->block[p->index].kind, (float)(p->index + 1u));
        return;
    }
    float value = 0.0f;
    uint32_t u32 = 0;
    uint16_t u16 = 0;
    parameter_name(p, &t);
    switch (p->field->type) {
    case PARAMETER_FLOAT:
        memcpy(&value, at, sizeof value);
        break;
    case PARAMETER_U32:
        memcpy(&u32, at, sizeof u32);
        value = (float)u32;
        break;
    case PARAMETER_U16:
        memcpy(&u16, at, sizeof u16);
        value = (float)u16;
        break;
    case PARAMETER_WORD:
        value = (float)*(const uint8_t *)at;
        break;
    default:
        break;
    }
    storage_tell(st, EVENT_STORAGE_CLIPPED, name, value);
}

/* Returns whether the newest set has more tables than there are free places, because settings in force take some. When all
 * CONFIG_TABLES are free, it returns false, because there will never be more: a surplus table then stays as a name. */
static bool lacks_places(const struct storage *st, const struct config *config)
{
    uint32_t address = st->newest.address + STORAGE_GRAIN, left = st->newest.length;
    unsigned tables = 0, room = tables_free_for(config);
    struct stored_record r;
    while (room < CONFIG_TABLES && record_at(address, left, &r)) {
        tables += record_is_table(&r);
        address += RECORD_HEAD + r.size;
        left -= RECORD_HEAD + r.size;
    }
    return tables > room;
}

enum err storage_load(struct storage *st, struct config *config, const char **reason)
{
    struct parameter p;
    struct stored_record r;
    bool renamed;
    if (st->state == NO_STORAGE) {
        *reason = "this board has no storage";
        return ERR_UNSUPPORTED;
    }
    if (!st->newest.sequence && storage_blocked(st)) {
        *reason = OF_NEWER;
        return ERR_VERSION;
    }
    if (!st->newest.sequence) {
        *reason = st->remains ? "there is something in the flash, but no whole set"
                              : "nothing is stored yet; `save` does it";
        return st->remains ? ERR_CRC : ERR_EMPTY;
    }
    if (CONFIG_BLOCKS && lacks_places(st, config)) {
        *reason = TABLES_TAKEN;
        return ERR_FULL;
    }
    parameters_defaults(config);
    /* The first pass takes renamed records, because a record under the new id is the newer one. It also takes the kinds of
     * blocks, because the other records of a block have no meaning without its kind. */
    for (unsigned pass = 0; pass < 2; pass++) {
        uint32_t address = st->newest.address + STORAGE_GRAIN, left = st->newest.length;
        while (record_at(address, left, &r)) { /* `left` falls by RECORD_HEAD or more */
            address += RECORD_HEAD + r.size;
            left -= RECORD_HEAD + r.size;
            if (record_parameter(&r, config, &p, &renamed) &&
                (renamed || p.field->type == PARAMETER_KIND) == (pass == 0) &&
                p.field->type != PARAMETER_FIXED && !record_take(&r, &p, config))
                tell_changed(st, &p, config);
        }
    }
    return ERR_OK;
}

/* Storage, reading: which set is the newest whole one, and its values. */
#include <string.h>

#include "base/crc32.h"
#include "hal/nvm.h"
#include "service/storage_parts.h"

/* ---- finding what is there ---- */

static bool checked_grain(const uint8_t *grain, uint32_t magic)
{
    return get32(grain) == magic && get32(grain + 12) == crc32_update(0, grain, 12);
}

/* All its bytes are that one. */
static bool all_are(const uint8_t *grain, uint8_t byte)
{
    return grain[0] == byte && memcmp(grain, grain + 1, STORAGE_GRAIN - 1u) == 0;
}

/* What a grain says about the slot. All bytes erased, or all zero: memory that was never written, or a model of one. */
static void look_at(struct storage *st, const uint8_t *grain)
{
    bool erased = all_are(grain, st->erased), zero = all_are(grain, 0);
    if (!erased)
        st->used[st->slot] = st->at + STORAGE_GRAIN;
    if (st->at == 0 && checked_grain(grain, MARK_MAGIC) && grain[8] == FORMAT) {
        st->prepared[st->slot] = true;
        st->erases[st->slot] = get32(grain + 4);
    } else if (!erased && !zero) {
        st->remains = true;
    }
}

void storage_begin_check(struct storage *st)
{
    st->at = st->candidate.address;
    st->crc = 0;
    st->state = CHECKING;
}

void storage_begin_scan(struct storage *st)
{
    st->candidate = (struct storage_set){0, 0, 0};
    st->used[0] = st->used[1] = 0;
    st->slot = 0;
    st->at = 0;
    st->state = SCANNING;
}

/* The newest head so far of those not found wanting yet. */
static void look_for_head(struct storage *st, const uint8_t *grain)
{
    struct storage_set set = {slot_address(st, st->slot) + st->at, get32(grain + 4),
                              get16(grain + 8)};
    if (!checked_grain(grain, HEAD_MAGIC) || grain[10] != FORMAT)
        return;
    if (set.sequence > st->sequence)
        st->sequence = set.sequence;
    if (set.sequence > st->candidate.sequence && set.sequence < st->below &&
        set_size(set.length) <= st->slot_size - st->at)
        st->candidate = set;
}

void storage_scan(struct storage *st)
{
    uint8_t grain[STORAGE_GRAIN];
    for (unsigned n = 0; n < STORAGE_TURN && st->at < st->slot_size; n++) {
        if (hal_nvm_read(slot_address(st, st->slot) + st->at, grain, sizeof grain) != ERR_OK) {
            st->state = NO_STORAGE;
            return;
        }
        look_at(st, grain);
        look_for_head(st, grain);
        st->at += STORAGE_GRAIN;
    }
    if (st->at < st->slot_size)
        return;
    st->at = 0;
    st->slot++;
    if (st->slot < 2)
        return;
    if (st->candidate.sequence)
        storage_begin_check(st);
    else
        st->state = PREPARING;
}

static void check_is_over(struct storage *st, bool whole)
{
    if (whole)
        st->newest = st->candidate;
    if (st->saving) {
        storage_verified(st, whole);
    } else if (whole) {
        st->state = PREPARING;
    } else {
        st->below = st->candidate.sequence; /* an older one, perhaps */
        storage_begin_scan(st);
    }
}

void storage_check(struct storage *st)
{
    const struct storage_set *set = &st->candidate;
    uint32_t tail = set->address + set_size(set->length) - STORAGE_GRAIN;
    uint8_t grain[STORAGE_GRAIN];
    for (unsigned n = 0; n < STORAGE_TURN; n++) {
        if (hal_nvm_read(st->at, grain, sizeof grain) != ERR_OK) {
            check_is_over(st, false);
            return;
        }
        if (st->at == tail) {
            st->crc = crc32_update(st->crc, grain, 12);
            check_is_over(st, get32(grain) == TAIL_MAGIC && get32(grain + 4) == set->length &&
                                  get32(grain + 8) == set->sequence &&
                                  get32(grain + 12) == st->crc);
            return;
        }
        st->crc = crc32_update(st->crc, grain, sizeof grain);
        st->at += STORAGE_GRAIN;
    }
}

/* At that offset of a slot, where a set would begin, there is something that is no head. */
static bool broken_head(const struct storage *st, uint8_t slot, uint32_t at)
{
    uint8_t grain[STORAGE_GRAIN];
    return st->prepared[slot] && at < st->slot_size &&
           hal_nvm_read(slot_address(st, slot) + at, grain, sizeof grain) == ERR_OK &&
           !all_are(grain, st->erased) && !checked_grain(grain, HEAD_MAGIC);
}

bool storage_newer_broken(const struct storage *st)
{
    uint8_t slot = slot_in_use(st);
    uint32_t end = st->newest.address - slot_address(st, slot) + set_size(st->newest.length);
    return st->sequence != st->newest.sequence || broken_head(st, slot, end) ||
           broken_head(st, (uint8_t)!slot, STORAGE_GRAIN);
}

/* ---- values ---- */

static void tell_changed(struct storage *st, const struct parameter *p, struct config *config)
{
    char name[CHANNEL_NAME_SIZE];
    struct text t = text_on(name, sizeof name);
    const void *at = parameter_place(p, config);
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

enum err storage_load(struct storage *st, struct config *config, const char **why)
{
    struct parameter p;
    struct stored_record r;
    bool renamed;
    if (st->state == NO_STORAGE) {
        *why = "this board has no storage";
        return ERR_UNSUPPORTED;
    }
    if (!st->newest.sequence) {
        *why = st->remains ? "there is something in the flash, but no whole set"
                           : "nothing is stored yet; `save` does it";
        return st->remains ? ERR_CRC : ERR_EMPTY;
    }
    parameters_defaults(config);
    /* Those that have moved first: a record under the new id is the newer one. */
    for (unsigned pass = 0; pass < 2; pass++) {
        uint32_t address = st->newest.address + STORAGE_GRAIN, left = st->newest.length;
        while (record_at(address, left, &r)) { /* at least RECORD_HEAD less each time */
            address += RECORD_HEAD + r.size;
            left -= RECORD_HEAD + r.size;
            if (record_parameter(&r, &p, &renamed) && renamed == (pass == 0) &&
                p.field->type != PARAMETER_FIXED && !record_take(&r, &p, config))
                tell_changed(st, &p, config);
        }
    }
    return ERR_OK;
}

#include "service/storage.h"

#include <string.h>

#include "base/crc32.h"
#include "hal/clock.h"
#include "hal/nvm.h"
#include "service/storage_record.h"

/* Slot: mark, then sets. Set: head, records, zeros up to the next grain, tail. */
#define MARK_MAGIC 0x4D535852u /* "RXSM" */
#define HEAD_MAGIC 0x48535852u /* "RXSH" */
#define TAIL_MAGIC 0x54535852u /* "RXST" */
#define FORMAT     1u

#define NOT_TAKEN "the flash does not take the write (emulated, worn or protected)"

_Static_assert(STORAGE_PIECE % STORAGE_GRAIN == 0, "pieces are whole grains");

enum state {
    NO_STORAGE, /* there is none */
    WAITING,    /* for the first command, or no plant */
    SCANNING,
    CHECKING, /* `candidate`: while scanning, and what has just been saved */
    PREPARING,
    ERASING,
    MARKING,
    TAKING, /* what is stored into force */
    READY,
    WRITING_HEAD,
    WRITING_BODY,
    WRITING_TAIL
};

static uint32_t whole_grains(uint32_t n)
{
    return (n + STORAGE_GRAIN - 1u) / STORAGE_GRAIN * STORAGE_GRAIN;
}

/* A set with that many bytes of records takes so many of flash. */
static uint32_t set_size(uint32_t length)
{
    return STORAGE_GRAIN + whole_grains(length) + STORAGE_GRAIN;
}

void storage_init(struct storage *st, struct service *service)
{
    struct hal_nvm_geometry g;
    memset(st, 0, sizeof *st);
    st->service = service;
    service->storage = st;
    hal_nvm_get_geometry(&g);
    if (g.sectors < 2 || g.program_size == 0 || STORAGE_GRAIN % g.program_size != 0 ||
        g.sector_size < 4u * STORAGE_GRAIN || g.sector_size % STORAGE_GRAIN != 0)
        return;
    st->state = WAITING;
    st->slot_sectors = g.sectors / 2u;
    st->sector_size = g.sector_size;
    st->slot_size = st->slot_sectors * g.sector_size;
    st->erased = g.erased;
}

static uint32_t slot_address(const struct storage *st, uint8_t slot)
{
    return slot * st->slot_size;
}

static void tell(struct storage *st, enum event_code code, const char *subject, float value)
{
    struct service *s = st->service;
    event_put(&s->main_events, service_time_ms(s), code, subject, value, 0);
    service_keep_events(s); /* a load may have more to tell than the queue holds */
}

/* ---- finding what is there ---- */

static bool checked_grain(const uint8_t *grain, uint32_t magic)
{
    return get32(grain) == magic && get32(grain + 12) == crc32_update(0, grain, 12);
}

/* What a grain says about the slot. All bytes erased, or all zero: memory that was never written, or a model of one. */
static void look_at(struct storage *st, const uint8_t *grain)
{
    bool uniform = memcmp(grain, grain + 1, STORAGE_GRAIN - 1u) == 0; /* each byte as the next */
    bool erased = uniform && grain[0] == st->erased, zero = uniform && grain[0] == 0;
    if (!erased)
        st->used[st->slot] = st->at + STORAGE_GRAIN;
    if (st->at == 0 && checked_grain(grain, MARK_MAGIC) && grain[8] == FORMAT) {
        st->prepared[st->slot] = true;
        st->erases[st->slot] = get32(grain + 4);
    } else if (!erased && !zero) {
        st->remains = true;
    }
}

static void begin_check(struct storage *st)
{
    st->at = st->candidate.address;
    st->crc = 0;
    st->state = CHECKING;
}

static void begin_scan(struct storage *st)
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

static void scan(struct storage *st)
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
        begin_check(st);
    else
        st->state = PREPARING;
}

static void saved(struct storage *st, enum err err, const char *why)
{
    st->result = err;
    st->why = why;
    st->saving = false;
    st->failed = err != ERR_OK;
    st->state = READY;
}

static void check_is_over(struct storage *st, bool whole)
{
    if (whole)
        st->newest = st->candidate;
    if (st->saving) {
        saved(st, whole ? ERR_OK : ERR_IO, whole ? NULL : NOT_TAKEN);
    } else if (whole) {
        st->state = PREPARING;
    } else {
        st->below = st->candidate.sequence; /* an older one, perhaps */
        begin_scan(st);
    }
}

static void check(struct storage *st)
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

/* ---- reading ---- */

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
    tell(st, EVENT_STORAGE_CLIPPED, name, value);
}

enum err storage_load(struct storage *st, struct config *config, const char **why)
{
    struct parameter p;
    struct record r;
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

/* ---- into force, after a start ---- */

static void take_stored(struct storage *st)
{
    struct service *s = st->service;
    struct config_fault fault;
    struct config *staged;
    const char *why;
    char subject[CHANNEL_NAME_SIZE];
    struct text t = text_on(subject, sizeof subject);
    st->state = READY;
    if (!st->newest.sequence) {
        if (st->remains)
            tell(st, EVENT_STORAGE_DAMAGED, NULL, 0.0f);
        return;
    }
    if (st->sequence != st->newest.sequence)
        tell(st, EVENT_STORAGE_OLDER, NULL, (float)st->newest.sequence);
    if (s->staging || s->serial) { /* somebody was faster, and is not overruled */
        tell(st, EVENT_STORAGE_REFUSED, "configured", 0.0f);
        return;
    }
    staged = service_stage(s); /* nothing has been applied: it is there */
    if (!staged || storage_load(st, staged, &why) != ERR_OK)
        return;
    enum err err = service_apply(s, staged, &fault);
    if (err == ERR_BUSY) {
        st->state = TAKING; /* again in the next turn */
    } else if (err) {
        text_str(&t, fault.group);
        if (fault.index)
            text_u32(&t, fault.index);
        text_char(&t, '.');
        text_str(&t, fault.field);
        tell(st, EVENT_STORAGE_REFUSED, subject, (float)st->newest.sequence);
    } else {
        tell(st, EVENT_STORAGE_LOADED, NULL, (float)st->newest.sequence);
    }
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

static uint8_t slot_in_use(const struct storage *st)
{
    return st->newest.sequence && st->newest.address >= st->slot_size ? 1 : 0;
}

/* The slot to append to: the one in use as long as it has room. False: neither has. */
static bool find_room(struct storage *st, uint32_t bytes)
{
    st->slot = slot_in_use(st);
    if (has_room(st, st->slot, bytes))
        return true;
    st->slot = (uint8_t)!st->slot;
    return has_room(st, st->slot, bytes);
}

static void begin_erase(struct storage *st)
{
    /* Never the one that holds what counts. */
    st->slot = st->newest.sequence ? (uint8_t)!slot_in_use(st) : 0;
    st->prepared[st->slot] = false;
    st->used[st->slot] = st->slot_size;
    st->at = 0;
    st->state = ERASING;
}

static void not_taken(struct storage *st)
{
    st->failed = true;
    if (st->saving)
        saved(st, ERR_IO, NOT_TAKEN);
    else
        st->state = TAKING;
}

static void erase(struct storage *st)
{
    uint32_t sector = st->slot * st->slot_sectors + st->at;
    /* Somebody may have put a loop into auto since. */
    if (!may_erase(st)) {
        if (st->saving)
            saved(st, ERR_STATE, "an erase is needed, and a loop acts by now");
        else
            st->state = TAKING;
        return;
    }
    if (hal_nvm_erase(sector) != ERR_OK) {
        not_taken(st);
        return;
    }
    st->at++;
    if (st->at == st->slot_sectors)
        st->state = MARKING;
}

/* Room for the largest set this build can make, so that the next save needs no erase. */
static uint32_t largest_set(const struct storage *st)
{
    uint32_t bytes = 0;
    for (unsigned g = 0; g < parameter_group_count; g++) {
        struct parameter p = {&parameter_groups[g], NULL, 0};
        for (unsigned f = 0; f < p.group->n_fields; f++) {
            p.field = &p.group->fields[f];
            bytes += p.group->count * (RECORD_HEAD + (uint32_t)parameter_size(&p));
        }
    }
    bytes = set_size(bytes);
    return bytes < st->slot_size - STORAGE_GRAIN ? bytes : st->slot_size - STORAGE_GRAIN;
}

/* ---- writing ---- */

static void rewind_records(struct storage *st)
{
    st->parameter = 0;
    st->record_n = st->record_at = 0;
    st->copy_left = 0;
    st->old = st->newest.address + STORAGE_GRAIN;
    st->old_left = st->newest.sequence ? st->newest.length : 0;
}

/* The next record: of a parameter, then those of the newest set nobody here knows. Either into `record`, or where to
 * copy it from. Returns its size, 0 = that was all. */
static uint32_t next_record(struct storage *st)
{
    struct config *config = service_staged(st->service);
    struct parameter p;
    struct record r;
    bool renamed;
    while (parameter_at(st->parameter, &p)) {
        st->parameter++;
        if (!record_wanted(&p, config))
            continue;
        st->record_n = record_encode(&p, config, st->record);
        st->record_at = 0;
        return st->record_n;
    }
    while (record_at(st->old, st->old_left, &r)) {
        uint32_t size = RECORD_HEAD + r.size;
        if (!record_parameter(&r, &p, &renamed)) {
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

/* Whether there was a byte; else the records are over. */
static bool next_byte(struct storage *st, uint8_t *byte)
{
    if (st->record_at == st->record_n && !st->copy_left && next_record(st) == 0)
        return false;
    if (st->copy_left) {
        if (hal_nvm_read(st->old, byte, 1) != ERR_OK)
            return false;
        st->old++;
        st->old_left--;
        st->copy_left--;
        return true;
    }
    *byte = st->record[st->record_at++];
    return true;
}

/* Programs the piece at the end of the slot; false = not taken. */
static bool program(struct storage *st)
{
    uint32_t address = slot_address(st, st->slot) + st->used[st->slot];
    st->used[st->slot] += st->piece_n; /* not again, whatever comes of it */
    if (hal_nvm_program(address, st->piece, st->piece_n) == ERR_OK)
        return true;
    not_taken(st);
    return false;
}

static void write_mark(struct storage *st)
{
    st->used[st->slot] = 0;
    memset(st->piece, 0, STORAGE_GRAIN);
    put32(st->piece, MARK_MAGIC);
    put32(st->piece + 4, st->erases[st->slot] + 1u);
    st->piece[8] = FORMAT;
    put32(st->piece + 12, crc32_update(0, st->piece, 12));
    st->piece_n = STORAGE_GRAIN;
    if (!program(st))
        return;
    st->erases[st->slot]++;
    st->prepared[st->slot] = true;
    st->state = st->saving ? WRITING_HEAD : TAKING;
}

static void write_head(struct storage *st)
{
    struct storage_set *set = &st->candidate;
    set->address = slot_address(st, st->slot) + st->used[st->slot];
    set->sequence = ++st->sequence;
    memset(st->piece, 0, STORAGE_GRAIN);
    put32(st->piece, HEAD_MAGIC);
    put32(st->piece + 4, set->sequence);
    put16(st->piece + 8, (uint16_t)set->length);
    st->piece[10] = FORMAT;
    st->piece[11] = CONFIG_SCHEMA;
    put32(st->piece + 12, crc32_update(0, st->piece, 12));
    st->crc = crc32_update(0, st->piece, STORAGE_GRAIN);
    st->piece_n = STORAGE_GRAIN;
    st->body_left = whole_grains(set->length);
    if (program(st))
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
    if (program(st) && !st->body_left)
        st->state = WRITING_TAIL;
}

static void write_tail(struct storage *st)
{
    put32(st->piece, TAIL_MAGIC);
    put32(st->piece + 4, st->candidate.length);
    put32(st->piece + 8, st->candidate.sequence);
    put32(st->piece + 12, crc32_update(st->crc, st->piece, 12));
    st->piece_n = STORAGE_GRAIN;
    if (program(st))
        begin_check(st);
}

enum err storage_save(struct storage *st, const char **why)
{
    struct service *s = st->service;
    if (st->state == NO_STORAGE) {
        *why = "this board has no storage";
        return ERR_UNSUPPORTED;
    }
    if (st->state != READY || s->staging) {
        *why = s->staging ? "a transaction is open: apply or abandon it first" : NULL;
        return s->staging ? ERR_STATE : ERR_BUSY;
    }
    if (!service_stage(s)) {
        *why = "a plan still waits for its tick";
        return ERR_BUSY;
    }
    uint32_t length = count_records(st), bytes = set_size(length);
    if (length > UINT16_MAX || bytes > st->slot_size - STORAGE_GRAIN) {
        *why = "more than this board's flash for storage holds";
        return ERR_FULL;
    }
    bool room = find_room(st, bytes);
    if (!room && !may_erase(st)) {
        *why = st->failed ? NOT_TAKEN
                          : "the flash must be erased first: put all loops into manual, or reboot";
        return st->failed ? ERR_IO : ERR_STATE;
    }
    st->candidate = (struct storage_set){0, 0, length};
    st->saving = true;
    if (room)
        st->state = WRITING_HEAD;
    else
        begin_erase(st);
    return ERR_OK;
}

bool storage_saving(const struct storage *st)
{
    return st->saving;
}

enum err storage_result(const struct storage *st, const char **why)
{
    *why = st->why;
    return st->result;
}

/* ---- in turns ---- */

/* The first command has gone out, or there is nobody to send one to. */
static bool may_touch(struct storage *st)
{
    const struct service *s = st->service;
    uint64_t now = hal_clock_ms();
    if (!st->clocked)
        st->born_ms = now;
    st->clocked = true;
    return st->hurry || s->supervisor->ticks > 0 ||
           (s->io.state(s->io.context) != IO_READY && now - st->born_ms >= STORAGE_WAIT_MS);
}

bool storage_ready(struct storage *st)
{
    st->hurry = true;
    return st->state == NO_STORAGE || st->state == READY;
}

bool storage_poll(struct storage *st)
{
    switch ((enum state)st->state) {
    case NO_STORAGE:
    case READY:
        return false;
    case WAITING:
        if (!may_touch(st))
            return false;
        st->below = UINT32_MAX;
        begin_scan(st);
        break;
    case SCANNING:
        scan(st);
        break;
    case CHECKING:
        check(st);
        break;
    case PREPARING:
        if (find_room(st, largest_set(st)) || !may_erase(st))
            st->state = TAKING;
        else
            begin_erase(st);
        break;
    case ERASING:
        erase(st);
        break;
    case MARKING:
        write_mark(st);
        break;
    case TAKING:
        take_stored(st);
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
    }
    return true;
}

const char *storage_word(const struct storage *st)
{
    if (st->state == NO_STORAGE)
        return "none";
    if (st->state < PREPARING && !st->saving)
        return "unread";
    return st->failed ? "failed" : "ok";
}

void storage_text(const struct storage *st, struct text *line)
{
    uint8_t slot = slot_in_use(st);
    text_str(line, storage_word(st));
    if (st->state == NO_STORAGE)
        return;
    text_str(line, ", ");
    if (!st->newest.sequence) {
        text_str(line, st->remains ? "no whole set" : "nothing stored");
    } else {
        text_str(line, "set ");
        text_u32(line, st->newest.sequence);
        text_str(line, " bytes ");
        text_u32(line, set_size(st->newest.length));
    }
    text_str(line, " room ");
    text_u32(line, (st->prepared[slot] ? st->slot_size - st->used[slot] : 0) +
                       (st->prepared[!slot] ? st->slot_size - st->used[!slot] : 0));
    text_str(line, " erases ");
    text_u32(line, st->erases[0] + st->erases[1]);
}

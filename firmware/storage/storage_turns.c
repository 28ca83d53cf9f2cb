#include "storage/storage.h"

#include <string.h>

#include "hal/clock.h"
#include "hal/nvm.h"
#include "service/early_resets.h"
#include "storage/storage_parts.h"

_Static_assert(STORAGE_PIECE % STORAGE_GRAIN == 0, "pieces are whole grains");

void storage_init(struct storage *st, struct service *service)
{
    struct hal_nvm_geometry g;
    memset(st, 0, sizeof *st);
    st->service = service;
    service->storage = st;
    hal_nvm_get_geometry(&g);
    if (g.sectors < 2 || g.program_size == 0 || STORAGE_GRAIN % g.program_size != 0 ||
        g.sector_size < 2u * SAVE_ROOM || g.sector_size % STORAGE_GRAIN != 0 ||
        g.sectors * g.sector_size > 0x10000u * STORAGE_GRAIN)
        return;
    st->state = WAITING;
    st->slot_sectors = g.sectors / 2u;
    st->slot_size = st->slot_sectors * g.sector_size;
    st->erased = g.erased;
    st->used[0] = st->used[1] = STORAGE_GRAIN; /* the place of the mark always counts */
}

/* ---- stored settings into force, after a start ---- */

static void take_stored(struct storage *st)
{
    struct service *s = st->service;
    struct config_fault fault;
    struct config *staged;
    const char *reason;
    char subject[CHANNEL_NAME_SIZE];
    struct text t = text_on(subject, sizeof subject);
    st->state = READY;
    if (storage_blocked(st))
        storage_tell(st, EVENT_STORAGE_NEWER, NULL,
                     (float)(st->newer[0] ? st->newer[0] : st->newer[1]));
    if (!st->newest.sequence) {
        if (st->remains && !storage_blocked(st))
            storage_tell(st, EVENT_STORAGE_DAMAGED, NULL, 0.0f);
        return;
    }
    if (st->older)
        storage_tell(st, EVENT_STORAGE_OLDER, NULL, (float)st->older);
    st->refused = true; /* until it is in force */
    if (s->early_resets >= EARLY_RESETS_MOST) {
        storage_tell(st, EVENT_STORAGE_LEFT_OUT, NULL, (float)s->early_resets);
        return;
    }
    if (s->staging || s->serial) { /* somebody has set something already, which stays */
        storage_tell(st, EVENT_STORAGE_REFUSED, "configured", 0.0f);
        return;
    }
    staged = service_stage(s);
    if (storage_load(st, staged, &reason) != ERR_OK)
        return;
    enum err err = service_apply(s, staged, &fault);
    if (err == ERR_BUSY) {
        st->state = TAKING; /* try again in the next turn */
    } else if (err) {
        service_fault_name(&fault, &t);
        storage_tell(st, EVENT_STORAGE_REFUSED, subject, (float)st->newest.sequence);
        st->later = true;
        st->tried_ms = s->io.tick_ms(s->io.context);
    } else {
        st->refused = false;
        storage_tell(st, EVENT_STORAGE_LOADED, NULL, (float)st->newest.sequence);
    }
}

/* Returns whether to try a refused set again. It may fit the tick of the plant that has come. A configuration that somebody
 * applied meanwhile ends the tries. */
static bool comes_later(struct storage *st)
{
    const struct service *s = st->service;
    if (!st->later || s->io.state(s->io.context) != IO_READY ||
        s->io.tick_ms(s->io.context) == st->tried_ms)
        return false;
    st->later = false;
    if (s->serial)
        return false;
    st->state = TAKING;
    return true;
}

/* ---- turns ---- */

/* Returns whether storage may touch the flash: the first command has gone out, nobody is there to send one to, or an operator asked. */
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

static void take_verdict(struct storage *st, enum storage_verdict verdict)
{
    if (verdict != STORAGE_GOES_ON)
        storage_verified(st, verdict == STORAGE_WHOLE);
}

bool storage_poll(struct storage *st)
{
    switch ((enum storage_state)st->state) {
    case NO_STORAGE:
        return false;
    case READY:
        return comes_later(st);
    case WAITING:
        if (!may_touch(st))
            return false;
        storage_begin_scan(st);
        break;
    case SCANNING:
        storage_scan(st);
        break;
    case CHECKING:
        take_verdict(st, storage_check(st));
        break;
    case TAKING:
        take_stored(st);
        break;
    case PREPARING:
    case UNMARKING:
    case ERASING:
    case MARKING:
    case RENEWING:
    case CONFIRMING:
    case WRITING_HEAD:
    case WRITING_BODY:
    case WRITING_TAIL:
        storage_write(st);
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
    if (storage_blocked(st))
        return "blocked";
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

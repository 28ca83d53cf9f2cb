#include "supervise/restart.h"

#include <stddef.h>
#include <string.h>

#include "base/crc32.h"
#include "base/elapsed.h"
#include "supervise/by_board.h"
#include "supervise/restart_sequence.h"

/* Identifies the format of the record, and of num_t. */
#define MAGIC ((NUM_IS_FIXED ? 0x52535134u : 0x52534634u) + CONFIG_LOOP_GUARD)

/* Bits of record.mode: the loop's mode, and above it enum by_board_cause. */
#define MODE_BITS 4
#define MODE_MASK (CONFIG_LOOP_GUARD ? (1u << MODE_BITS) - 1u : 0xFFu)

static uint32_t checksum(const struct restart_record *record)
{
    size_t from = offsetof(struct restart_record, identity);
    return crc32_update(0, (const uint8_t *)record + from, sizeof *record - from);
}

void restart_init(struct restart *r, void *memory, bool warm)
{
    memset(r, 0, sizeof *r);
    r->record = memory;
    if (!memory)
        return;
    bool known = r->record->magic == MAGIC, sound = r->record->crc == checksum(r->record);
    bool whole = known && sound;
    r->damaged = warm && known != sound;
    r->pending = warm && whole &&
                 (r->record->acting || restart_in_sequence(&r->record->sequence) ||
                  restart_with_offsets(&r->record->sequence));
    r->was_testing = warm && whole && r->record->testing;
    r->attempts = r->pending ? r->record->attempts : 0;
}

static void refuse_restart(struct restart *r, struct supervisor *s, const char *reason)
{
    r->pending = r->damaged = false;
    r->attempts = 0;
    event_put(s->events, s->time_ms, EVENT_RESTART_REFUSED, reason, 0.0f, 0);
}

static void outputs_back(struct supervisor *s, const struct restart_record *record)
{
    for (uint8_t j = 0; j < s->placed[PLACED_MVS]; j++) {
        struct mv_state *o = &s->mv[j];
        if (!s->plan->config.mv[j].name[0] || !o->bound)
            continue;
        o->manual = o->commanded = o->constrained = o->applied = record->mv[j];
        o->beyond = true; /* if it was outside its limits, an interlock had left it there */
    }
    restart_offsets_back(s, &record->sequence);
    s->state = SUPERVISOR_RUN;
}

static void interlocks_back(struct supervisor *s, const struct restart_record *record)
{
    for (uint8_t k = 0; k < s->placed[PLACED_INTERLOCKS]; k++) {
        struct interlock_state *state = &s->interlock[k];
        if (state->active || !(record->interlocks & 1u << k))
            continue;
        state->active = state->pending = true;
        event_put(s->events, s->time_ms, EVENT_INTERLOCK_ON, s->plan->config.interlock[k].mv,
                  s->measurement[s->plan->interlock[k].measurement].raw, k);
    }
}

static void loop_back(struct supervisor *s, const struct restart_record *record, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    struct request mode = {.kind = REQUEST_MODE,
                           .loop = i,
                           .output = PLAN_NONE,
                           .mode = record->mode[i] & MODE_MASK,
                           .plan = s->plan->serial};
    if (mode.mode == LOOP_MANUAL)
        return;
    supervisor_request(s, &mode);
    if (l->mode == LOOP_MANUAL)
        return;
    l->target = record->target[i];
    l->setpoint = record->setpoint[i];
    ramp_reset(&l->ramp, l->setpoint);
    lag_reset(&l->filter, l->setpoint);
}

void restart_try(struct restart *r, struct supervisor *s)
{
    const struct restart_record *record = r->record;
    r->ticks += r->ticks < RESTART_LASTED;
    if (r->damaged)
        refuse_restart(r, s, "record");
    if (!r->pending || r->ticks < 2) /* the first command is the safe one */
        return;
    if (r->ticks == 2)
        restart_tell_interrupted(s, &record->sequence);
    enum restart_policy policy = (enum restart_policy)s->plan->config.restart_policy;
    float limit_ms = s->plan->config.restart_limit_s * 1000.0f;
    bool in_time =
        s->time_ms >= record->time_ms && elapsed_ms(s->time_ms, record->time_ms) <= limit_ms;
    bool same = s->plan->identity == record->identity;
    /* Somebody acts already, or there is nothing to restore. */
    if (s->state == SUPERVISOR_RUN || !record->acting || (same && policy == RESTART_SAFE))
        r->pending = false;
    else if (!in_time)
        refuse_restart(r, s, same ? "time" : "configuration");
    else if (restart_in_sequence(&record->sequence))
        refuse_restart(r, s, "sequence");
    else if (same && r->attempts >= RESTART_ATTEMPTS)
        refuse_restart(r, s, "attempts");
    if (!r->pending)
        restart_offsets_gone(s, &record->sequence, same);
    if (!r->pending || !same)
        return; /* the configuration may still be on its way from storage */
    r->pending = false;
    r->attempts++;
    r->ticks = 2;
    outputs_back(s, record);
    interlocks_back(s, record);
    uint8_t end = plan_stage_end(s->plan, STAGE_CONTROL);
    for (uint8_t k = 0; policy == RESTART_RESUME && k < end; k++)
        if (s->plan->listed[k] < CONFIG_LOOPS) /* a loop's own controller */
            loop_back(s, record, s->plan->listed[k]);
    /* A restored cascade has found another value. */
    for (uint8_t i = 0; policy == RESTART_RESUME && i < s->placed[PLACED_LOOPS]; i++)
        s->loop[i].v = record->v[i];
    for (uint8_t i = 0; CONFIG_LOOP_GUARD && i < s->placed[PLACED_LOOPS]; i++)
        by_board_restore(s, i, record->mode[i] >> MODE_BITS,
                         (record->mode[i] & MODE_MASK) != LOOP_MANUAL);
    event_put(s->events, s->time_ms, EVENT_RESTART_DONE, NULL, (float)policy, (uint8_t)policy);
}

void restart_keep(struct restart *r, const struct supervisor *s)
{
    struct restart_record *record = r->record;
    if (!record || r->pending)
        return;
    /* A reset half-way leaves a wrong checksum. */
    record->identity = s->plan->identity;
    record->acting = s->state == SUPERVISOR_RUN;
    record->testing = s->testing || s->proposal_waits;
    record->attempts = (r->ticks < RESTART_LASTED ? r->attempts : 0) & 3u;
    record->interlocks = 0;
    for (uint8_t k = 0; k < s->placed[PLACED_INTERLOCKS]; k++)
        if (s->interlock[k].active)
            record->interlocks = (uint8_t)(record->interlocks | 1u << k);
    record->time_ms = s->time_ms;
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++) {
        record->mode[i] =
            (uint8_t)((unsigned)s->loop[i].mode | (unsigned)by_board_cause(s, i) << MODE_BITS);
        record->target[i] = s->loop[i].target;
        record->setpoint[i] = loop_own_setpoint(&s->loop[i]);
        record->v[i] = s->loop[i].v;
    }
    for (uint8_t j = 0; j < s->placed[PLACED_MVS]; j++)
        /* A test signal is not restored. */
        record->mv[j] =
            num_eq(s->mv[j].excitation, num_zero()) ? s->mv[j].constrained : s->mv[j].manual;
    restart_keep_sequence(&record->sequence, s);
    record->crc = checksum(record);
    record->magic = MAGIC;
}

#include "supervise/compensate_blocks.h"

#include "exchange/block_settings.h"
#include "supervise/blocks.h"
#include "supervise/constrain.h"
#include "supervise/raised.h"
#include "supervise/served_io.h"
#include "supervise/test_signal.h"

_Static_assert(CONFIG_LOOPS <= 32, "a bit for each loop");

static bool is_compensator(const struct supervisor *s, uint8_t slot)
{
    return served_is(s, slot, STAGE_COMPENSATE);
}

/* Returns true if the block is a compensator that runs in this tick. */
static bool compensates(const struct supervisor *s, uint8_t slot)
{
    return is_compensator(s, slot) && !s->block[slot].off && s->block[slot].acting;
}

/* For each member: the last input, as far as it took effect, and the last output. They stand behind the state of
 * the kind. */
struct passed {
    num_t in, out;
};
_Static_assert(sizeof(struct passed) == ARENA_GRAIN, "a grain of the arena for each member");

static struct passed *passed_by(const struct supervisor *s, uint8_t slot)
{
    uint8_t members = served_record(s, slot)->members;
    const struct block_state *b = &s->block[slot];
    struct passed *end = (struct passed *)s->arena + b->grain + b->grains;
    return end - members;
}

/* Gathers the signals of its members, by loop, as inputs. The input of a member that does not take part is its
 * present output, or 0 for differences. */
static void gather_signals(const struct supervisor *s, uint8_t slot, const num_t *signal,
                           bool differences, struct served_io *g)
{
    const struct record_plan *r = served_record(s, slot);
    served_gather(s, slot, g);
    g->io.members.acting = s->block[slot].acting;
    g->io.members.going_on = s->block[slot].going_on;
    for (uint8_t k = 0; k < r->members; k++) {
        if (g->io.members.acting & (1u << k))
            g->in[k] = signal[r->member[k]];
        else
            g->in[k] = differences ? num_zero() : s->loop[r->member[k]].v;
        g->out[k] = g->in[k];
    }
}

/* Checks the outputs of the members that take part. The block gives up if one is not a number, or if it says so
 * itself. */
static bool gave_signals(struct supervisor *s, uint8_t slot, const struct served_io *g)
{
    const char *reason = g->io.requests.gives_up;
    for (uint8_t k = 0; k < served_record(s, slot)->members; k++)
        if ((g->io.members.acting & (1u << k)) && !served_is_number(g->out[k]) && !reason)
            reason = SERVED_NO_NUMBER;
    if (reason)
        served_give_up(s, slot, reason);
    return !reason;
}

/* ---- bumpless transfer ---- */

static uint32_t compensated_loops(const struct supervisor *s, uint8_t slot, uint8_t members)
{
    const struct record_plan *r = served_record(s, slot);
    uint32_t loops = 0;
    for (uint8_t k = 0; k < r->members; k++)
        if (members & (1u << k))
            loops |= 1u << r->member[k];
    return loops;
}

static uint8_t driving_members(const struct supervisor *s, uint8_t slot)
{
    const struct record_plan *r = served_record(s, slot);
    uint8_t acting = 0;
    for (uint8_t k = 0; k < r->members; k++)
        if (loop_drives(s, r->member[k]))
            acting = (uint8_t)(acting | (1u << k));
    return acting;
}

/* Returns the members that begin in this tick, also those that left and came back between two ticks. */
static uint8_t joining_members(const struct supervisor *s, uint8_t slot)
{
    const struct record_plan *r = served_record(s, slot);
    uint8_t joining = 0;
    for (uint8_t k = 0; k < r->members; k++)
        if (s->loop[r->member[k]].transfer_pending)
            joining = (uint8_t)(joining | (1u << k));
    return joining;
}

static uint32_t loops_in_transfer(const struct supervisor *s)
{
    uint32_t loops = 0;
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++)
        if (s->loop[i].transfer_pending || s->loop[i].moved)
            loops |= 1u << i;
    return loops;
}

uint32_t compensators_regroup(struct supervisor *s)
{
    uint32_t transfer = 0, moves = s->plan->records ? loops_in_transfer(s) : 0;
    for (uint8_t slot = served_end(s); slot-- > SLOT_RECORDS;) {
        struct block_state *b = &s->block[slot];
        if (!is_compensator(s, slot))
            continue;
        uint8_t acting = driving_members(s, slot);
        uint32_t loops = compensated_loops(s, slot, acting);
        bool changed = b->must_follow || (loops & (moves | transfer)) != 0;
        b->going_on = acting & b->acting & (uint8_t)~joining_members(s, slot);
        if (b->off) {
            b->acting = 0;
            b->must_follow = false;
        } else {
            changed = changed || acting != b->acting;
            b->acting = acting;
            b->must_follow = changed;
        }
        if (changed)
            transfer |= loops;
        if (!acting)
            raised_forget(s, slot);
    }
    return transfer;
}

static void find_inputs(struct supervisor *s, uint8_t slot, num_t *v)
{
    const struct record_plan *r = served_record(s, slot);
    const struct block_kind *kind = served_kind(s, slot);
    struct passed *passed = passed_by(s, slot);
    struct served_io g;
    gather_signals(s, slot, v, false, &g);
    if (kind->select)
        (void)kind->select(supervisor_block(s, slot),
                           config_record(&s->plan->config, (uint8_t)(slot - SLOT_RECORDS)),
                           g.io.members.acting);
    (kind->follow ? kind->follow : kind->back_calculate)(supervisor_block(s, slot), &g.io);
    s->block[slot].must_follow = false;
    if (!gave_signals(s, slot, &g)) {
        s->block[slot].must_follow = false; /* v stays, because inputs pass through unchanged */
        return;
    }
    for (uint8_t k = 0; k < r->members; k++) {
        if (!(g.io.members.acting & (1u << k)))
            continue;
        passed[k] = (struct passed){.in = g.out[k], .out = g.in[k]};
        v[r->member[k]] = g.out[k];
    }
}

void compensators_transfer(struct supervisor *s, num_t *v)
{
    for (uint8_t slot = served_end(s); slot-- > SLOT_RECORDS;) {
        if (!compensates(s, slot))
            continue;
        if (s->block[slot].must_follow) {
            find_inputs(s, slot, v);
            continue;
        }
        /* The compensator continues: those before it must give the inputs that it had. */
        const struct record_plan *r = served_record(s, slot);
        for (uint8_t k = 0; k < r->members; k++)
            if (s->block[slot].acting & (1u << k))
                v[r->member[k]] = passed_by(s, slot)[k].in;
    }
}

/* ---- forwards and backwards ---- */

static void step_compensator(struct supervisor *s, uint8_t slot, num_t *u)
{
    const struct record_plan *r = served_record(s, slot);
    struct passed *passed = passed_by(s, slot);
    struct served_io g;
    gather_signals(s, slot, u, false, &g);
    served_step(s, slot, &g);
    bool gave = gave_signals(s, slot, &g);
    if (gave) {
        served_grant(s, slot, &g);
    }
    for (uint8_t k = 0; k < r->members; k++) {
        if (!(g.io.members.acting & (1u << k)))
            continue;
        if (gave)
            passed[k] = (struct passed){.in = g.in[k], .out = g.out[k]};
        u[r->member[k]] = passed[k].out;
    }
}

void compensators_step(struct supervisor *s, num_t *u)
{
    for (uint8_t slot = SLOT_RECORDS; slot < served_end(s); slot++)
        if (compensates(s, slot))
            step_compensator(s, slot, u);
}

/* Returns true if it asks for more than num_t holds. Then the command does not say by how much the output falls
 * short of it. */
static bool beyond_numbers(const struct supervisor *s, uint8_t slot)
{
    for (uint8_t k = 0; k < served_record(s, slot)->members; k++)
        if ((s->block[slot].acting & (1u << k)) &&
            num_lt(num_from_float(COMMAND_MAX), num_abs(passed_by(s, slot)[k].out)))
            return true;
    return false;
}

/* Takes whole[loop], the part of its output that took effect, and less[loop], the difference from its output.
 * Returns the same of its inputs in both arrays. */
static void back_compensator(struct supervisor *s, uint8_t slot, num_t *whole, num_t *less)
{
    const struct record_plan *r = served_record(s, slot);
    const struct block_kind *kind = served_kind(s, slot);
    struct passed *passed = passed_by(s, slot);
    bool by_whole = beyond_numbers(s, slot);
    struct served_io g;
    gather_signals(s, slot, by_whole ? whole : less, !by_whole, &g);
    g.io.members.going_on = g.io.members.acting;
    (by_whole && kind->follow ? kind->follow : kind->back_calculate)(supervisor_block(s, slot),
                                                                     &g.io);
    bool gave = gave_signals(s, slot, &g);
    for (uint8_t k = 0; k < r->members; k++) {
        uint8_t i = r->member[k];
        if (!(g.io.members.acting & (1u << k)))
            continue;
        less[i] = !gave ? num_zero() : by_whole ? num_sub(g.out[k], passed[k].in) : g.out[k];
        whole[i] = gave && by_whole ? g.out[k] : num_add(passed[k].in, less[i]);
        passed[k].in = whole[i];
    }
}

void compensators_back_calculate(struct supervisor *s, num_t *told)
{
    num_t whole[CONFIG_LOOPS], less[CONFIG_LOOPS];
    uint32_t loops = 0;
    for (uint8_t slot = SLOT_RECORDS; slot < served_end(s); slot++)
        if (compensates(s, slot))
            loops |= compensated_loops(s, slot, s->block[slot].acting);
    for (uint8_t i = 0; loops && i < s->placed[PLACED_LOOPS]; i++) {
        if (!(loops & (1u << i)))
            continue;
        const struct mv_state *o = &s->mv[s->plan->loop[i].mv];
        less[i] = mv_shortfall(o);
        whole[i] = num_sub(mv_without_signal(o, o->applied), s->loop[i].feedforward);
    }
    for (uint8_t slot = served_end(s); slot-- > SLOT_RECORDS;)
        if (compensates(s, slot))
            back_compensator(s, slot, whole, less);
    for (uint8_t i = 0; loops && i < s->placed[PLACED_LOOPS]; i++)
        if (loops & (1u << i))
            told[i] = whole[i];
}

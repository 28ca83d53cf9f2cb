#include "supervise/compensate.h"

#include "exchange/block_settings.h"
#include "supervise/blocks.h"
#include "supervise/constrain.h"
#include "supervise/numbered.h"
#include "supervise/raised.h"
#include "supervise/test_signal.h"

_Static_assert(CONFIG_LOOPS <= 32, "a bit for each loop");

static uint8_t list_begin(const struct supervisor *s)
{
    return plan_stage_begin(s->plan, STAGE_COMPENSATE);
}

static uint8_t list_end(const struct supervisor *s)
{
    return plan_stage_end(s->plan, STAGE_COMPENSATE);
}

/* Returns true if the compensator runs in this tick. */
static bool compensates(const struct supervisor *s, uint8_t block)
{
    return !s->block[block].off && s->block[block].acting;
}

/* For each member: the last input, as far as it took effect, and the last output. They stand behind the state of
 * the kind. */
struct passed {
    num_t in, out;
};
_Static_assert(sizeof(struct passed) == ARENA_GRAIN, "a grain of the arena for each member");

static struct passed *passed_by(const struct supervisor *s, uint8_t block)
{
    const struct block_state *b = &s->block[block];
    struct passed *end = (struct passed *)s->arena + b->grain + b->grains;
    return end - plan_grains_behind(s->plan, block);
}

/* Gathers the signals of its members, by loop, as inputs. The input of a member that does not take part is its
 * present output, or 0 for differences. */
static void gather_signals(const struct supervisor *s, uint8_t block, const num_t *signal,
                           bool differences, struct gathered *g)
{
    gather_all(s, block, g);
    g->io.members.acting = s->block[block].acting;
    g->io.members.going_on = s->block[block].going_on;
    for (uint8_t k = 0; k < g->links.members; k++) {
        uint8_t i = g->links.member[k];
        if (g->io.members.acting & (1u << k))
            g->in[k] = signal[i];
        else
            g->in[k] = differences ? num_zero() : s->loop[i].v;
        g->out[k] = g->in[k];
    }
}

/* Checks the outputs of the members that take part. */
static bool gave_signals(struct supervisor *s, uint8_t block, const struct gathered *g)
{
    return numbered_goes_on(s, block, g, g->out, g->io.members.acting);
}

/* ---- bumpless transfer ---- */

/* Members that drive their MVs now, and those of them that begin to act, even if they stopped and began again between two ticks. */
struct taking_part {
    uint8_t acting, joining;
    uint32_t loops; /* the acting ones, by loop */
};

static void find_taking_part(const struct supervisor *s, uint8_t block, struct taking_part *p)
{
    struct block_links links;
    plan_links(s->plan, block, &links);
    *p = (struct taking_part){0};
    for (uint8_t k = 0; k < links.members && links.member[k] < s->placed[PLACED_LOOPS]; k++) {
        uint8_t i = links.member[k];
        if (!loop_drives(s, i) || !plan_takes_part(s->plan, block, i))
            continue;
        p->acting = (uint8_t)(p->acting | (1u << k));
        p->loops |= 1u << i;
        if (s->loop[i].transfer_pending)
            p->joining = (uint8_t)(p->joining | (1u << k));
    }
}

/* Only the acting members take part from now on. Returns whether that is a change. */
static bool select_members(struct supervisor *s, uint8_t block, uint8_t acting)
{
    const struct block_kind *kind = block_kind_at(s, block);
    const struct block_state *b = &s->block[block];
    const struct matrix_settings matrix = {s->plan->config.decoupler};
    if (acting == b->acting && !b->must_follow)
        return false;
    return !kind->select || kind->select(supervisor_block(s, block), &matrix, acting);
}

/* Returns whether the members that act need a bumpless transfer. */
static bool regroup(struct supervisor *s, uint8_t block, uint32_t moves,
                    const struct taking_part *p)
{
    struct block_state *b = &s->block[block];
    bool changed = (p->loops & moves) != 0;
    b->going_on = p->acting & b->acting & (uint8_t)~p->joining;
    if (b->off) {
        changed = changed || b->must_follow;
        b->acting = 0;
        b->must_follow = false;
        return changed;
    }
    changed = select_members(s, block, p->acting) || changed;
    b->acting = p->acting;
    b->must_follow = changed;
    return changed;
}

uint32_t compensators_regroup(struct supervisor *s, uint32_t moves)
{
    uint32_t transfer = 0;
    for (uint8_t k = list_end(s); k-- > list_begin(s);) {
        uint8_t block = s->plan->listed[k];
        struct taking_part p;
        find_taking_part(s, block, &p);
        if (regroup(s, block, moves | transfer, &p))
            transfer |= p.loops;
        if (!p.acting)
            raised_forget(s, block);
    }
    return transfer;
}

static void find_inputs(struct supervisor *s, uint8_t block, num_t *v)
{
    const struct block_kind *kind = block_kind_at(s, block);
    struct passed *passed = passed_by(s, block);
    struct gathered g;
    gather_signals(s, block, v, false, &g);
    (kind->follow ? kind->follow : kind->back_calculate)(supervisor_block(s, block), &g.io);
    bool gave = gave_signals(s, block, &g);
    s->block[block].must_follow = false;
    for (uint8_t k = 0; gave && k < g.links.members;
         k++) { /* else its inputs pass through unchanged */
        if (!(g.io.members.acting & (1u << k)))
            continue;
        passed[k] = (struct passed){.in = g.out[k], .out = g.in[k]};
        v[g.links.member[k]] = g.out[k];
    }
}

/* It goes on: the compensators before it have to give what it was given. */
static void ask_last_inputs(const struct supervisor *s, uint8_t block, num_t *v)
{
    struct block_links links;
    plan_links(s->plan, block, &links);
    for (uint8_t k = 0; k < links.members; k++)
        if (s->block[block].acting & (1u << k))
            v[links.member[k]] = passed_by(s, block)[k].in;
}

void compensators_transfer(struct supervisor *s, num_t *v)
{
    for (uint8_t k = list_end(s); k-- > list_begin(s);) {
        uint8_t block = s->plan->listed[k];
        if (!compensates(s, block))
            continue;
        if (s->block[block].must_follow)
            find_inputs(s, block, v);
        else
            ask_last_inputs(s, block, v);
    }
}

/* ---- forwards and backwards ---- */

static void step_compensator(struct supervisor *s, uint8_t block, num_t *u)
{
    struct passed *passed = passed_by(s, block);
    struct gathered g;
    gather_signals(s, block, u, false, &g);
    step_gathered(s, block, &g);
    bool gave = gave_signals(s, block, &g);
    if (gave)
        numbered_grant(s, block, &g);
    for (uint8_t k = 0; k < g.links.members; k++) {
        if (!(g.io.members.acting & (1u << k)))
            continue;
        if (gave)
            passed[k] = (struct passed){.in = g.in[k], .out = g.out[k]};
        u[g.links.member[k]] = passed[k].out;
    }
}

void compensators_step(struct supervisor *s, num_t *u)
{
    for (uint8_t k = list_begin(s); k < list_end(s); k++)
        if (compensates(s, s->plan->listed[k]))
            step_compensator(s, s->plan->listed[k], u);
}

/* Returns true if it asks for more than num_t holds. Then the command does not say by how much the output falls
 * short of it. */
static bool beyond_numbers(const struct passed *passed, uint8_t acting)
{
    for (uint8_t k = 0; acting >> k; k++)
        if ((acting & (1u << k)) && num_lt(num_from_float(COMMAND_MAX), num_abs(passed[k].out)))
            return true;
    return false;
}

/* whole[loop]: what took effect of what it gave; less[loop]: by how much that differs from it. Replaces both by the same
 * of what went in. */
static void back_compensator(struct supervisor *s, uint8_t block, num_t *whole, num_t *less)
{
    const struct block_kind *kind = block_kind_at(s, block);
    struct passed *passed = passed_by(s, block);
    bool by_whole = beyond_numbers(passed, s->block[block].acting);
    struct gathered g;
    gather_signals(s, block, by_whole ? whole : less, !by_whole, &g);
    g.io.members.going_on = g.io.members.acting;
    (by_whole && kind->follow ? kind->follow : kind->back_calculate)(supervisor_block(s, block),
                                                                     &g.io);
    bool gave = gave_signals(s, block, &g);
    for (uint8_t k = 0; k < g.links.members; k++) {
        uint8_t i = g.links.member[k];
        if (!(g.io.members.acting & (1u << k)))
            continue;
        less[i] = !gave ? num_zero() : by_whole ? num_sub(g.out[k], passed[k].in) : g.out[k];
        whole[i] = gave && by_whole ? g.out[k] : num_add(passed[k].in, less[i]);
        passed[k].in = whole[i];
    }
}

/* Returns the loops that compensators act on. */
static uint32_t compensated_loops(const struct supervisor *s)
{
    uint32_t loops = 0;
    for (uint8_t k = list_begin(s); k < list_end(s); k++) {
        struct block_links links;
        uint8_t block = s->plan->listed[k];
        if (!compensates(s, block))
            continue;
        plan_links(s->plan, block, &links);
        for (uint8_t m = 0; m < links.members; m++)
            if (s->block[block].acting & (1u << m))
                loops |= 1u << links.member[m];
    }
    return loops;
}

void compensators_back_calculate(struct supervisor *s, num_t *told)
{
    num_t whole[CONFIG_LOOPS], less[CONFIG_LOOPS];
    uint32_t loops = compensated_loops(s);
    for (uint8_t i = 0; loops && i < s->placed[PLACED_LOOPS]; i++) {
        if (!(loops & (1u << i)))
            continue;
        const struct mv_state *o = &s->mv[s->plan->loop[i].mv];
        less[i] = mv_shortfall(o);
        whole[i] = num_sub(mv_without_signal(o, o->applied), s->loop[i].feedforward);
    }
    for (uint8_t k = list_end(s); k-- > list_begin(s);)
        if (compensates(s, s->plan->listed[k]))
            back_compensator(s, s->plan->listed[k], whole, less);
    for (uint8_t i = 0; loops && i < s->placed[PLACED_LOOPS]; i++)
        if (loops & (1u << i))
            told[i] = whole[i];
}

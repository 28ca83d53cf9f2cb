#include "supervise/blocks.h"
#include "exchange/block_setup.h"
#include "supervise/raise_gain.h"

void loop_to_manual(struct supervisor *s, uint8_t i)
{
    if (!loop_acts(s, i))
        return;
    s->loop[i].mode = LOOP_MANUAL;
    s->loop[i].drives = false;
    event_put(s->events, s->time_ms, EVENT_MODE, s->plan->config.loop[i].name, (float)LOOP_MANUAL,
              LOOP_MANUAL);
}

bool loop_acts_on(const struct supervisor *s, uint8_t measurement)
{
    for (uint8_t k = 0; k < s->placed[PLACED_LOOPS]; k++)
        if (s->plan->loop[k].pv == measurement && loop_acts(s, k))
            return true;
    return false;
}

static const struct block_kind *kind_of(const struct supervisor *s, uint8_t block)
{
    return block_kinds[s->block[block].kind];
}

/* ---- settings ---- */

/* The plan's check covered the settings: only an interval that the block cannot keep remains to be reported. */
void block_give_settings(struct supervisor *s, uint8_t block, bool retune)
{
    struct block_instance b;
    plan_block_setup(s->plan, block, &b);
    raised_gain_take(s, block, &b);
    if (kind_of(s, block)->configure(supervisor_block(s, block), &b.setup, retune) != ERR_OK)
        event_put(s->events, s->time_ms, EVENT_CONFIG_REFUSED, kind_of(s, block)->name,
                  b.setup.interval_s, 0);
}

void block_begin(struct supervisor *s, uint8_t i)
{
    block_give_settings(s, i, false);
}

/* Gives the block the settings that have waited. */
static void give_new_settings(struct supervisor *s, uint8_t i)
{
    if (s->block[i].retune)
        block_give_settings(s, i, true);
    s->block[i].retune = false;
}

bool block_same_settings(const struct supervisor *s, const struct plan *old, uint8_t block)
{
    const struct block_kind *kind = kind_of(s, block);
    struct block_instance before, now;
    /* `old` may be the same plan with another tick */
    if (!kind->same || s->plan->tick_s != s->tick_s)
        return false;
    plan_block_setup(old, block, &before);
    plan_block_setup(s->plan, block, &now);
    return before.setup.interval_s == now.setup.interval_s && kind->same(&before.setup, &now.setup);
}

void block_configure(struct supervisor *s, const struct plan *old, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    struct block_state *b = &s->block[i];
    b->retune = b->retune || !block_same_settings(s, old, i);
    if (l->mode == LOOP_MANUAL || l->transfer_pending || loop_server(s, i) != PLAN_NONE ||
        kind_of(s, i)->retunes_at_once)
        give_new_settings(s, i);
}

/* ---- step, follow and back-calculation ---- */

/* Fills in all that a loop's own controller looks at. The other fields are for blocks with a number (blockN). */
static void fill_io(struct supervisor *s, uint8_t i, struct block_io *io)
{
    struct loop_state *l = &s->loop[i];
    io->members.acting = 1;
    io->members.setpoint = &l->setpoint;
    io->members.in = &s->measurement[s->plan->loop[i].pv].value;
    io->members.out = &l->v;
    io->members.clamp = &l->clamp;
    io->members.limited = &l->limited;
}

void block_step(struct supervisor *s, uint8_t i)
{
    struct block_io io;
    fill_io(s, i, &io);
    kind_of(s, i)->step(supervisor_block(s, i), &io);
    s->block[i].stepped = true;
    give_new_settings(s, i);
}

/* This function is not inlined, so that its frame does not add to the frame of new settings. */
NOT_INLINE static void follow_output(struct supervisor *s, uint8_t i, num_t *v, uint8_t *limited)
{
    struct block_io io;
    fill_io(s, i, &io);
    io.members.out = v;
    io.members.limited = limited;
    s->block[i].stepped = false;
    kind_of(s, i)->follow(supervisor_block(s, i), &io);
}

void block_follow(struct supervisor *s, uint8_t i)
{
    give_new_settings(s, i);
    follow_output(s, i, &s->loop[i].v, &s->loop[i].limited);
}

void block_follow_at(struct supervisor *s, uint8_t i, num_t v)
{
    uint8_t limited; /* unused: the limits of the block that acts count */
    give_new_settings(s, i);
    follow_output(s, i, &v, &limited);
}

void block_shift(struct supervisor *s, uint8_t i, num_t v)
{
    struct block_io io;
    fill_io(s, i, &io);
    s->loop[i].v = v;
    kind_of(s, i)->shift(supervisor_block(s, i), &io);
}

void block_back_calculate(struct supervisor *s, uint8_t i, num_t applied, uint8_t clamp)
{
    struct block_io io;
    fill_io(s, i, &io);
    io.members.out = &applied;
    io.members.clamp = &clamp;
    s->block[i].stepped = false;
    kind_of(s, i)->back_calculate(supervisor_block(s, i), &io);
}

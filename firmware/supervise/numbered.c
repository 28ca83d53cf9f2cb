#include "supervise/numbered.h"

#include "base/elapsed.h"
#include "exchange/block_setup.h"
#include "exchange/numbered_setup.h"
#include "exchange/sampling.h"
#include "supervise/block_excitation.h"
#include "supervise/blocks.h"
#include "supervise/histories.h"
#include "supervise/proposals.h"
#include "supervise/raised.h"
#include "supervise/switch_offs.h"

uint8_t first_bad_input(const struct supervisor *s, uint8_t block)
{
    const struct numbered_plan *n = numbered_at(s, block);
    for (uint8_t k = 0; k < n->inputs; k++)
        if (!quality_usable((enum quality)input_quality(s, n->input[k], false)))
            return k;
    return PLAN_NONE;
}

/* Returns the time since the last valid reading was sampled. */
static float input_age_s(const struct supervisor *s, uint8_t input)
{
    return input & INPUT_IS_MV ? 0.0f : elapsed_ms(s->time_ms, sampling_at_ms(s, input)) / 1000.0f;
}

static void gather_members(const struct supervisor *s, struct gathered *g)
{
    struct numbered_io *n = &g->numbered;
    for (uint8_t k = 0; k < g->links.members; k++) {
        uint8_t i = g->links.member[k];
        REFLUX_ASSERT(i < s->placed[PLACED_LOOPS]);
        const struct loop_state *l = &s->loop[i];
        n->setpoint[k] = l->setpoint;
        g->in[k] = s->measurement[s->plan->loop[i].pv].value;
        g->out[k] = l->v;
        n->clamp[k] = l->clamp;
        n->limited[k] = INTEGRAL_FREE;
        n->member_applied[k] = history_of(s, s->plan->loop[i].mv);
        if (loop_drives(s, i))
            g->io.members.acting = (uint8_t)(g->io.members.acting | (1u << k));
    }
}

static void gather_numbered(const struct supervisor *s, uint8_t block, struct gathered *g)
{
    struct numbered_io *n = &g->numbered;
    bool estimates = block_is(s, block, STAGE_ESTIMATE);
    REFLUX_ASSERT(g->links.members <= BLOCK_MEMBERS_MAX && g->links.inputs <= BLOCK_INPUTS_MAX &&
                  g->links.points <= BLOCK_POINTS_MAX);
    g->io = (struct block_io){.members.setpoint = n->setpoint,
                              .members.in = g->in,
                              .members.out = g->out,
                              .members.clamp = n->clamp,
                              .members.limited = n->limited,
                              .inputs.value = g->input,
                              .inputs.quality = n->quality,
                              .inputs.age_s = n->age_s,
                              .inputs.time_ms = s->time_ms,
                              .points.value = g->point,
                              .points.quality = n->point_quality,
                              .requests.event_value = n->event_value,
                              .members.applied = n->member_applied,
                              .inputs.applied = n->input_applied,
                              .members.divisor =
                                  plan_divisor(s->plan, (uint8_t)(block - BLOCK_NUMBERED))};
    gather_members(s, g);
    for (uint8_t k = 0; k < BLOCK_EVENTS_MAX; k++)
        n->event_value[k] = 0.0f;
    for (uint8_t k = 0; k < g->links.inputs; k++) {
        uint8_t input = g->links.input[k];
        n->quality[k] = input_quality(s, input, estimates);
        n->input_applied[k] =
            input & INPUT_IS_MV ? history_of(s, input & (uint8_t)~INPUT_IS_MV) : NULL;
        n->age_s[k] = input_age_s(s, input);
    }
    for (uint8_t k = 0; k < g->links.points; k++) {
        g->point[k] = num_zero();
        n->point_quality[k] = QUALITY_MISSING;
    }
}

void gather_all(const struct supervisor *s, uint8_t block, struct gathered *g)
{
    gather(s, block, g);
    if (block >= BLOCK_NUMBERED)
        gather_numbered(s, block, g);
}

static void take_work(struct supervisor *s, uint8_t block, struct block_io *io)
{
    struct job *work = &s->work[block - BLOCK_NUMBERED];
    if (!job_is_asked(work)) {
        /* The work was given up in the midst of a piece. */
        io->requests.work_wanted = job_is_working(work);
        return;
    }
    io->requests.work_done = job_take(work, s->events, s->time_ms);
    io->requests.work_wanted = !io->requests.work_done;
}

static void ask_work(struct supervisor *s, uint8_t block, const struct block_io *io)
{
    struct job *work = &s->work[block - BLOCK_NUMBERED];
    if (io->requests.ask_work && block_kind_at(s, block)->work && !job_is_asked(work) &&
        !job_is_working(work))
        job_ask(work, io->requests.ask_work);
}

void block_give_up(struct supervisor *s, uint8_t block, const char *reason)
{
    struct block_state *b = &s->block[block];
    b->off = true;
    b->stepped = false;
    b->must_follow = block_is(s, block, STAGE_COMPENSATE) || b->must_follow;
    s->numbered[block - BLOCK_NUMBERED].gave_up = reason;
    job_give_up(&s->work[block - BLOCK_NUMBERED]);
    event_put(s->events, s->time_ms, EVENT_BLOCK_GAVE_UP, reason,
              (float)(block - BLOCK_NUMBERED + 1), 0);
    excitation_end_of(s, block, EXCITE_GAVE_UP);
    proposal_withdraw(s, block);
}

static const char *input_name(const struct supervisor *s, uint8_t input)
{
    const struct config *c = &s->plan->config;
    return input & INPUT_IS_MV ? c->mv[input & ~INPUT_IS_MV].name : c->measurement[input].name;
}

void block_give_up_without(struct supervisor *s, uint8_t block, uint8_t k)
{
    block_give_up(s, block, input_name(s, numbered_at(s, block)->input[k]));
    /* The index is kept and not the name, because the plan with the name is overwritten later. */
    s->numbered[block - BLOCK_NUMBERED].gave_up = NULL;
    s->numbered[block - BLOCK_NUMBERED].input = k;
    raised_forget(s, block);
}

void numbered_step(struct supervisor *s, uint8_t block, struct gathered *g)
{
    take_work(s, block, &g->io);
    excitation_tell(s, block, &g->io, g->numbered.excite);
    g->io.requests.proposal = proposal_room(s);
    g->io.requests.switch_off = switch_off_room(s, block);
    block_kind_at(s, block)->step(supervisor_block(s, block), &g->io);
    raised_tell(s, block, &g->io);
}

bool numbered_goes_on(struct supervisor *s, uint8_t block, const struct gathered *g,
                      const num_t *value, uint8_t which)
{
    if (block < BLOCK_NUMBERED) /* settings that its kind has accepted give numbers */
        return true;
    const char *reason = g->io.requests.gives_up;
    for (uint8_t k = 0; which >> k; k++)
        if ((which & (1u << k)) && !is_a_number(value[k]) && !reason)
            reason = NOT_A_NUMBER;
    if (reason)
        block_give_up(s, block, reason);
    return !reason;
}

void numbered_grant(struct supervisor *s, uint8_t block, struct gathered *g)
{
    if (block < BLOCK_NUMBERED) /* it asks for nothing */
        return;
    ask_work(s, block, &g->io);
    excitation_take(s, block, &g->io);
    if (g->io.requests.withdraws)
        proposal_withdraw(s, block);
    proposal_hand_over(s, block, &g->io);
    switch_off_hand_over(s, block, &g->io);
}

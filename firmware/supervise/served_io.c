#include "supervise/served_io.h"

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

uint8_t served_input_quality(const struct supervisor *s, uint8_t input, bool measured)
{
    if (input & INPUT_IS_MV)
        return s->mv[input & ~INPUT_IS_MV].bound ? QUALITY_GOOD : QUALITY_MISSING;
    const struct measurement_state *m = &s->measurement[input];
    if (!m->bound || !m->seen)
        return QUALITY_MISSING;
    /* A value that stands in for a reading tells an estimator nothing. */
    return measured && m->fault != MEASUREMENT_FINE ? QUALITY_BAD : (uint8_t)m->quality;
}

uint8_t served_bad_input(const struct supervisor *s, uint8_t slot)
{
    const struct record_plan *r = served_record(s, slot);
    for (uint8_t k = 0; k < r->inputs; k++)
        if (!quality_usable((enum quality)served_input_quality(s, r->input[k], false)))
            return k;
    return PLAN_NONE;
}

/* Returns the time since the last valid reading was sampled. */
static float input_age_s(const struct supervisor *s, uint8_t input)
{
    return input & INPUT_IS_MV ? 0.0f : elapsed_ms(s->time_ms, sampling_at_ms(s, input)) / 1000.0f;
}

static void gather_inputs(const struct supervisor *s, uint8_t slot, struct served_io *g)
{
    const struct record_plan *r = served_record(s, slot);
    bool estimates = served_is(s, slot, STAGE_ESTIMATE);
    for (uint8_t k = 0; k < r->inputs; k++) {
        uint8_t at = r->input[k];
        g->input[k] =
            at & INPUT_IS_MV ? s->mv[at & ~INPUT_IS_MV].applied : s->measurement[at].value;
        g->quality[k] = served_input_quality(s, at, estimates);
        g->input_applied[k] = at & INPUT_IS_MV ? history_of(s, at & (uint8_t)~INPUT_IS_MV) : NULL;
        g->age_s[k] = input_age_s(s, at);
    }
    for (uint8_t k = 0; k < r->points; k++) {
        g->point[k] = num_zero();
        g->point_quality[k] = QUALITY_MISSING;
    }
}

void served_gather(const struct supervisor *s, uint8_t slot, struct served_io *g)
{
    const struct record_plan *r = served_record(s, slot);
    g->io = (struct block_io){.members.setpoint = g->setpoint,
                              .members.in = g->in,
                              .members.out = g->out,
                              .members.clamp = g->clamp,
                              .members.limited = g->limited,
                              .inputs.value = g->input,
                              .inputs.quality = g->quality,
                              .inputs.age_s = g->age_s,
                              .points.value = g->point,
                              .points.quality = g->point_quality,
                              .requests.event_value = g->event_value,
                              .members.applied = g->member_applied,
                              .inputs.applied = g->input_applied,
                              .members.divisor =
                                  plan_record_divisor(s->plan, (uint8_t)(slot - SLOT_RECORDS))};
    REFLUX_ASSERT(r->members <= BLOCK_MEMBERS_MAX && r->inputs <= BLOCK_INPUTS_MAX &&
                  r->points <= BLOCK_POINTS_MAX);
    for (uint8_t k = 0; k < r->members; k++) {
        uint8_t i = r->member[k];
        REFLUX_ASSERT(i < s->placed[PLACED_LOOPS]);
        const struct loop_state *l = &s->loop[i];
        g->setpoint[k] = l->setpoint;
        g->in[k] = s->measurement[s->plan->loop[i].pv].value;
        g->out[k] = l->v;
        g->clamp[k] = l->clamp;
        g->limited[k] = INTEGRAL_FREE;
        g->member_applied[k] = history_of(s, s->plan->loop[i].mv);
        if (loop_drives(s, i))
            g->io.members.acting = (uint8_t)(g->io.members.acting | (1u << k));
    }
    for (uint8_t k = 0; k < BLOCK_EVENTS_MAX; k++)
        g->event_value[k] = 0.0f;
    gather_inputs(s, slot, g);
}

static void take_work(struct supervisor *s, uint8_t slot, struct block_io *io)
{
    struct job *work = &s->work[slot - SLOT_RECORDS];
    if (!job_is_asked(work)) {
        /* The work was given up in the midst of a piece. */
        io->requests.work_wanted = job_is_working(work);
        return;
    }
    io->requests.work_done = job_take(work, s->events, s->time_ms);
    io->requests.work_wanted = !io->requests.work_done;
}

static void ask_work(struct supervisor *s, uint8_t slot, const struct block_io *io)
{
    struct job *work = &s->work[slot - SLOT_RECORDS];
    if (io->requests.ask_work && served_kind(s, slot)->work && !job_is_asked(work) &&
        !job_is_working(work))
        job_ask(work, io->requests.ask_work);
}

void served_give_up(struct supervisor *s, uint8_t slot, const char *reason)
{
    struct block_state *b = &s->block[slot];
    b->off = true;
    b->stepped = false;
    b->must_follow = served_is(s, slot, STAGE_COMPENSATE) || b->must_follow;
    s->served[slot - SLOT_RECORDS].gave_up = reason;
    job_give_up(&s->work[slot - SLOT_RECORDS]);
    event_put(s->events, s->time_ms, EVENT_BLOCK_GAVE_UP, reason, (float)(slot - SLOT_RECORDS + 1),
              0);
    excitation_end_of(s, slot, EXCITE_GAVE_UP);
    proposal_withdraw(s, slot);
}

static const char *input_name(const struct supervisor *s, uint8_t input)
{
    const struct config *c = &s->plan->config;
    return input & INPUT_IS_MV ? c->mv[input & ~INPUT_IS_MV].name : c->measurement[input].name;
}

void served_give_up_without(struct supervisor *s, uint8_t slot, uint8_t k)
{
    served_give_up(s, slot, input_name(s, served_record(s, slot)->input[k]));
    /* The index is kept and not the name, because the plan with the name is overwritten later. */
    s->served[slot - SLOT_RECORDS].gave_up = NULL;
    s->served[slot - SLOT_RECORDS].input = k;
    raised_forget(s, slot);
}

void served_step(struct supervisor *s, uint8_t slot, struct served_io *g)
{
    take_work(s, slot, &g->io);
    excitation_tell(s, slot, &g->io, g->excite);
    g->io.requests.proposal = proposal_room(s);
    g->io.requests.switch_off = switch_off_room(s, slot);
    served_kind(s, slot)->step(supervisor_block(s, slot), &g->io);
    raised_tell(s, slot, &g->io);
}

void served_grant(struct supervisor *s, uint8_t slot, struct served_io *g)
{
    ask_work(s, slot, &g->io);
    excitation_take(s, slot, &g->io);
    if (g->io.requests.withdraws)
        proposal_withdraw(s, slot);
    proposal_hand_over(s, slot, &g->io);
    switch_off_hand_over(s, slot, &g->io);
}

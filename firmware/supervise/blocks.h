/* The controller of a loop, whatever its kind: when it runs, its new settings, and what it is told. Within supervise only;
 * i is the index of a loop of the plan in force. */
#ifndef REFLUX_SUPERVISE_BLOCKS_H
#define REFLUX_SUPERVISE_BLOCKS_H

#include "exchange/state.h"

/* Its turn is in this tick (counted as s->ticks). */
static inline bool loop_due(const struct supervisor *s, uint8_t i, uint32_t tick)
{
    const struct loop_config *c = &s->plan->config.loop[i];
    return tick % c->divisor == c->phase;
}
/* In auto or cascade. */
static inline bool loop_acts(const struct supervisor *s, uint8_t i)
{
    return s->plan->loop[i].used && s->loop[i].mode != LOOP_MANUAL;
}
/* An interlock held its output at the end of the last tick. */
static inline bool loop_interlocked(const struct supervisor *s, uint8_t i)
{
    uint8_t j = s->plan->loop[i].mv;
    return j != PLAN_NONE && s->mv[j].interlocked;
}
/* The block runs. While an interlock holds its output a loop keeps its mode and setpoint but waits as in manual, so that it
 * begins again, without a bump, at the output the interlock leaves. */
static inline bool loop_drives(const struct supervisor *s, uint8_t i)
{
    return s->loop[i].drives;
}
/* Whether it does: to be found out anew whenever its mode or an interlock has changed in a tick. */
static inline void loop_find_driving(struct supervisor *s, uint8_t i)
{
    s->loop[i].drives = loop_acts(s, i) && !loop_interlocked(s, i);
}

/* Loop i goes to manual, if it acts, and an event says so: not because somebody asked for it. */
void loop_to_manual(struct supervisor *s, uint8_t i);
/* Whether a loop acts that has this measurement as its PV. */
bool loop_acts_on(const struct supervisor *s, uint8_t measurement);

/* A block with the settings of the plan, without a past. */
void block_begin(struct supervisor *s, uint8_t i);
/* The settings of the plan for a loop that `old` had too. Those of one that acts wait until the old ones have made the next
 * step: only then is the next output, whatever moves meanwhile, what they would have given. The same settings touch
 * nothing. */
void block_configure(struct supervisor *s, const struct plan *old, uint8_t i);

/* The block in a slot gets the settings of the plan in force. retune: new ones, without a bump. */
void block_give_settings(struct supervisor *s, uint8_t slot, bool retune);
/* Whether they come to the same as those of `old`. */
bool block_same_settings(const struct supervisor *s, const struct plan *old, uint8_t slot);

/* Its output, before decoupler and feedforward: l->v, fraction of span. */
void block_step(struct supervisor *s, uint8_t i);
/* It does not act: its output is l->v. */
void block_follow(struct supervisor *s, uint8_t i);
/* Another block acts for it, with the output v. */
void block_follow_at(struct supervisor *s, uint8_t i, num_t v);
/* It acts, and its output is v from now on; what it has under way goes on. */
void block_shift(struct supervisor *s, uint8_t i, num_t v);
/* What became of its last step: once for each. clamp: enum integral_clamp. */
void block_back_calculate(struct supervisor *s, uint8_t i, num_t applied, uint8_t clamp);
/* Now is the time for that: its next turn is in the next tick. */
static inline bool block_closes(const struct supervisor *s, uint8_t i)
{
    return s->block[i].stepped && loop_due(s, i, s->ticks + 1u);
}
/* Where a new plan has moved its turn nobody has told it yet: then as if nothing had been in the way. */
static inline void block_close(struct supervisor *s, uint8_t i)
{
    if (s->block[i].stepped)
        block_back_calculate(s, i, s->loop[i].v, s->loop[i].clamp);
}

#endif

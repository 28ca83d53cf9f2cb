/* The controller of a loop, whatever its kind: its turns, its new settings and its steps. Within supervise only; i
 * is the index of a loop of the plan in force. */
#ifndef REFLUX_SUPERVISE_BLOCKS_H
#define REFLUX_SUPERVISE_BLOCKS_H

#include "exchange/state.h"

/* Returns true if the loop has its turn in this tick (counted as s->ticks). */
static inline bool loop_due(const struct supervisor *s, uint8_t i, uint32_t tick)
{
    const struct loop_config *c = &s->plan->config.loop[i];
    return tick % c->divisor == c->phase;
}
/* Returns true if the loop is in auto or cascade. */
static inline bool loop_acts(const struct supervisor *s, uint8_t i)
{
    return s->plan->loop[i].used && s->loop[i].mode != LOOP_MANUAL;
}
/* Returns true if an interlock held the loop's output at the end of the last tick. */
static inline bool loop_interlocked(const struct supervisor *s, uint8_t i)
{
    uint8_t j = s->plan->loop[i].mv;
    return j != PLAN_NONE && s->mv[j].interlocked;
}
/* Returns true if the loop's output comes from its block. While an interlock holds its output a loop keeps its mode
 * and setpoint but waits as in manual, so that it begins again, without a bump, at the output that the interlock
 * leaves. */
static inline bool loop_drives(const struct supervisor *s, uint8_t i)
{
    return s->loop[i].drives;
}
/* Finds out whether the loop drives. Call it whenever its mode or an interlock has changed in a tick. */
static inline void loop_find_driving(struct supervisor *s, uint8_t i)
{
    s->loop[i].drives = loop_acts(s, i) && !loop_interlocked(s, i);
}

/* Puts loop i into manual, if it acts, and reports it with an event. For board_to_manual() (by_board.h). */
void loop_to_manual(struct supervisor *s, uint8_t i);
/* Returns true if a loop acts that has this measurement as its PV. */
bool loop_acts_on(const struct supervisor *s, uint8_t measurement);

/* Gives a loop's own controller the settings of the plan, and starts it without a past. */
void block_begin(struct supervisor *s, uint8_t i);
/* Gives the settings of the plan to the own controller of a loop that `old` had too. If the loop acts, they wait
 * until the old settings have made the next step, because only then is the next output what the old settings would
 * have given, whatever moves meanwhile. Equal settings change nothing. */
void block_configure(struct supervisor *s, const struct plan *old, uint8_t i);

/* Gives a block the settings of the plan in force. retune: they are new settings, without a bump. */
void block_give_settings(struct supervisor *s, uint8_t block, bool retune);
/* Returns true if these settings have the same effect as those of `old`. */
bool block_same_settings(const struct supervisor *s, const struct plan *old, uint8_t block);

/* Makes a step: the output, before decoupler and feedforward, is l->v, fraction of span. */
void block_step(struct supervisor *s, uint8_t i);
/* Follows the output l->v, because the controller does not act. */
void block_follow(struct supervisor *s, uint8_t i);
/* Follows the output v of another block, which acts for the loop. */
void block_follow_at(struct supervisor *s, uint8_t i, num_t v);
/* Shifts the output of a controller that acts to v; transients continue. */
void block_shift(struct supervisor *s, uint8_t i, num_t v);
/* Tells the controller what took effect of its last step, once for each step. clamp: enum integral_clamp. */
void block_back_calculate(struct supervisor *s, uint8_t i, num_t applied, uint8_t clamp);
/* Returns true if the back-calculation is due now, because the next turn is in the next tick. */
static inline bool block_closes(const struct supervisor *s, uint8_t i)
{
    return s->block[i].stepped && loop_due(s, i, s->ticks + 1u);
}
/* Makes up for a back-calculation that a new plan has left out by moving the turn: as if nothing had limited the
 * output. */
static inline void block_close(struct supervisor *s, uint8_t i)
{
    if (s->block[i].stepped)
        block_back_calculate(s, i, s->loop[i].v, s->loop[i].clamp);
}

#endif

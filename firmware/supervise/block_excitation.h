/* Test signals that blocks ask for (block/excitation.h): which block has the plant, what it excites, and what ends
 * the excitation. Within supervise only.
 *
 * On an MV the signal is mv_state.excitation, as start-up's is. It is part of the command, but back-calculation
 * ignores it. On a setpoint it is loop_of_block.excited. It is part of the setpoint in force, but ramp, filter, the
 * outer loop and a restart ignore it. */
#ifndef REFLUX_SUPERVISE_BLOCK_EXCITATION_H
#define REFLUX_SUPERVISE_BLOCK_EXCITATION_H

#include "exchange/state.h"

#if CONFIG_BLOCKS

/* Before the step of a block: gives it the answer to its last request, and clears `ask` for the next
 * one. */
void excitation_tell(const struct supervisor *s, uint8_t block, struct block_io *io,
                     struct block_excitation *ask);
/* After the block's step: takes its request. */
void excitation_take(struct supervisor *s, uint8_t block, const struct block_io *io);

/* Ends the excitation of all targets; does nothing where nothing is excited. */
void excitation_end(struct supervisor *s, enum excite_reason reason);
/* Ends the excitation if it belongs to that block. */
void excitation_end_of(struct supervisor *s, uint8_t block, enum excite_reason reason);
/* Ends the excitation if MV j is excited, because somebody has moved the MV by hand. */
void excitation_end_by_hand(struct supervisor *s, uint8_t j);

/* Returns the loop under test, or the loop on the MV under test, or PLAN_NONE. */
uint8_t excited_loop(const struct supervisor *s, const struct excited *t);
/* Returns the MV under test, or the MV at the end of the chain of loops below the setpoint under test. */
uint8_t excited_mv(const struct supervisor *s, const struct excited *t);

/* In a tick, before any loop has its turn: checks modes, channels, interlocks and sequences. */
void excitation_watch(struct supervisor *s);
/* Adds the test signal to the setpoint of loop i, which is already within its limits. */
void excitation_add_asked(struct supervisor *s, uint8_t i);
static inline void excitation_add(struct supervisor *s, uint8_t i)
{
    s->loop[i].of_block.excited = num_zero();
    if (s->excitation.targets)
        excitation_add_asked(s, i);
}
/* After the commands and before the limits: ends the excitation if a command comes to a limit, or if its block has
 * had no turn. */
void excitation_check_commands(struct supervisor *s);

#else

#define excitation_end(s, reason)    ((void)(s))
#define excitation_end_by_hand(s, j) ((void)(j))
#define excitation_watch(s)          ((void)(s))
#define excitation_add(s, i)         ((void)(i))
#define excitation_check_commands(s) ((void)(s))

#endif

#endif

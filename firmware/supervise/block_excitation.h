/* Test signals that blocks ask for (block/excitation.h): who has the plant, what is excited, and what ends it. Within supervise
 * only.
 *
 * On an MV the signal is mv_state.excitation, as start-up's is: part of the command, of which back-calculation takes no
 * notice. On a setpoint it is loop_state.excited: part of the setpoint in force, of which ramp, filter, the outer loop and a
 * restart know nothing. */
#ifndef REFLUX_SUPERVISE_BLOCK_EXCITATION_H
#define REFLUX_SUPERVISE_BLOCK_EXCITATION_H

#include "exchange/state.h"

#if CONFIG_BLOCKS

/* Before the step of the block in a slot: what became of its last asking; `ask` is cleared for the next. */
void excitation_tell(const struct supervisor *s, uint8_t slot, struct block_io *io,
                     struct block_excitation *ask);
/* After its step: what it asks for now. */
void excitation_take(struct supervisor *s, uint8_t slot, const struct block_io *io);

/* Ends what there is, for all that is excited; does nothing where nothing is. */
void excitation_end(struct supervisor *s, enum excite_reason reason);
/* ... if it is the block's in that slot. */
void excitation_end_of(struct supervisor *s, uint8_t slot, enum excite_reason reason);
/* ... if MV j is excited: a hand has moved it. */
void excitation_end_by_hand(struct supervisor *s, uint8_t j);

/* The loop under test, or that acts on the MV under test, or PLAN_NONE. */
uint8_t excited_loop(const struct supervisor *s, const struct excited *t);
/* The MV under test, or the one at the end of the loops from that under test on. */
uint8_t excited_mv(const struct supervisor *s, const struct excited *t);

/* In a tick, before any loop has its turn: modes, channels, interlocks, sequences. */
void excitation_watch(struct supervisor *s);
/* Loop i has its setpoint, within its limits: adds to it what is asked for. */
void excitation_add_asked(struct supervisor *s, uint8_t i);
static inline void excitation_add(struct supervisor *s, uint8_t i)
{
    s->loop[i].served.excited = num_zero();
    if (s->excitation.targets)
        excitation_add_asked(s, i);
}
/* Commands are there, limits have not been applied yet: one that comes to a limit ends it, and so does a block that has had no
 * turn. */
void excitation_check_commands(struct supervisor *s);

#else

#define excitation_end(s, reason)    ((void)(s))
#define excitation_end_by_hand(s, j) ((void)(j))
#define excitation_watch(s)          ((void)(s))
#define excitation_add(s, i)         ((void)(i))
#define excitation_check_commands(s) ((void)(s))

#endif

#endif

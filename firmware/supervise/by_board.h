/* Loops that the board has put into manual. Such a loop has an alarm until somebody sets its mode, because nothing brings it back by itself. The
 * state is struct by_board in exchange/state.h, index i is that of the plan in force. Within supervise only. */
#ifndef REFLUX_SUPERVISE_BY_BOARD_H
#define REFLUX_SUPERVISE_BY_BOARD_H

#include "exchange/state.h"
#include "supervise/blocks.h"

#if CONFIG_LOOP_GUARD
/* Puts loop i into manual, if it acts, and reports it. This is for changes that nobody asked for. */
void board_to_manual(struct supervisor *s, uint8_t i, enum by_board_cause cause);
/* Raises the alarm of loop i, which acts no longer. */
void by_board_begin(struct supervisor *s, uint8_t i, enum by_board_cause cause);
/* Somebody sets the mode of loop i: ends its alarm, if it has one. */
void by_board_end(struct supervisor *s, uint8_t i);
/* The states of loop i of the plan before are gone. Its alarm stays where the new loop has the same name. acted: the loop was not in manual. */
void by_board_place(struct supervisor *s, const struct plan *old, uint8_t i, bool acted);
/* After a reset: the loop had this alarm, or acted and does not now. */
void by_board_restore(struct supervisor *s, uint8_t i, uint8_t cause, bool acted);
/* Returns the cause of the alarm of loop i, BY_BOARD_NOT if it has none. */
static inline uint8_t by_board_cause(const struct supervisor *s, uint8_t i)
{
    return s->by_board.cause[i];
}
#else
#define board_to_manual(s, i, cause)         ((void)(cause), loop_to_manual(s, i))
#define by_board_begin(s, i, cause)          ((void)0)
#define by_board_end(s, i)                   ((void)0)
#define by_board_place(s, old, i, acted)     ((void)0)
#define by_board_restore(s, i, cause, acted) ((void)0)
#define by_board_cause(s, i)                 0u
#endif

#endif

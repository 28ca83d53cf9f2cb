/* The last step forwards: limits, rates, interlocks and the safe state decide what is sent to the plant. Within supervise
 * only. */
#ifndef REFLUX_SUPERVISE_CONSTRAIN_H
#define REFLUX_SUPERVISE_CONSTRAIN_H

#include "exchange/state.h"

/* mv_state.commanded of every output becomes constrained, and applied. */
void constrain_mvs(struct supervisor *s);

/* Value `at` of an MV (constrained or applied, fraction of span) without the test signal. A rate limit lets only part of the signal
 * through, and part of an older value may still be in `at`. So the result is the command without the signal, where that is no
 * further from `at` than the signal is large, and otherwise the nearest value that is. */
#if CONFIG_BLOCKS
num_t mv_without_signal(const struct mv_state *o, num_t at);
#else /* start-up, which has a test signal too, is on no board without blocks */
#define mv_without_signal(o, at) ((void)(o), (at))
#endif

/* What was applied, less what was commanded, both without the test signal; 0 where no limit, rate, interlock or valve stands between. */
num_t mv_shortfall(const struct mv_state *o);

/* One will hold MV j from this tick on. Before constrain_mvs(). */
bool interlock_begins(const struct supervisor *s, uint8_t j);

#endif

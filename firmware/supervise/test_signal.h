/* An MV without the test signal on it. Within supervise only. */
#ifndef REFLUX_SUPERVISE_TEST_SIGNAL_H
#define REFLUX_SUPERVISE_TEST_SIGNAL_H

#include "exchange/state.h"

/* Returns the value `at` of an MV (constrained or applied, fraction of span) without the test signal. A rate limit
 * lets only part of the signal through, and part of an older value may still be in `at`. So the result is the
 * command without the signal if that is no further from `at` than the size of the signal; otherwise it is the
 * nearest value that is. */
#if CONFIG_BLOCKS
num_t mv_without_signal(const struct mv_state *o, num_t at);
#else /* start-up, which has a test signal too, is on no board without blocks */
#define mv_without_signal(o, at) ((void)(o), (at))
#endif

#endif

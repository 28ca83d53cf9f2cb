/* Verbs of blocks with a number (blockN), in the tick. Within supervise only. */
#ifndef REFLUX_SUPERVISE_VERBS_H
#define REFLUX_SUPERVISE_VERBS_H

#include "exchange/state.h"

/* Returns true if the block of a REQUEST_VERB exists, and its kind has the verb. */
bool verb_exists(const struct supervisor *s, const struct request *r);
/* Runs the verb. Events report that it ran, or why the block refused. */
bool verb_run(struct supervisor *s, const struct request *r);

#endif

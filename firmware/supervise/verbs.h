/* Verbs of blocks with a record, in the tick. Within supervise only. */
#ifndef REFLUX_SUPERVISE_VERBS_H
#define REFLUX_SUPERVISE_VERBS_H

#include "exchange/state.h"

/* The block of a REQUEST_VERB is there, and its kind has the verb. */
bool verb_exists(const struct supervisor *s, const struct request *r);
/* Has the block do it; events tell that it has, or why it has not. */
bool verb_run(struct supervisor *s, const struct request *r);

#endif

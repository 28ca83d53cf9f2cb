/* A lease of the shared workspace by a block of the kind `experiment`: between ticks it asks, in the tick it keeps the lease or ends it. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_LEASE_H
#define REFLUX_EXPERIMENT_EXPERIMENT_LEASE_H

#include <stdbool.h>
#include <stdint.h>

struct experiment_lease;

/* Between ticks. Returns the memory, which the tick does not see yet, or NULL. */
void *experiment_lease_ask(struct experiment_lease *l, uint32_t bytes);
/* The tick sees the memory from now on. */
void experiment_lease_hold(struct experiment_lease *l, void *memory);

/* NULL while there is none. */
void *experiment_leased(const struct experiment_lease *l);
/* In the tick. Returns false when somebody else has taken the workspace: the memory is gone. */
bool experiment_lease_renew(struct experiment_lease *l);
void experiment_lease_end(struct experiment_lease *l);

#endif

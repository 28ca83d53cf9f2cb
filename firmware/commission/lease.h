/* Start-up's lease of the workspace: from the beginning of the tests until the proposal is kept, rolled back or rejected. The
 * results stay readable until somebody else leases the workspace. Main loop; only lease_frees() and lease_begin() in the tick. */
#ifndef REFLUX_COMMISSION_LEASE_H
#define REFLUX_COMMISSION_LEASE_H

#include "base/workspace.h"

#define COMMISSION_HOLDER "start-up"

struct startup_lease;

/* Leases the workspace; *memory gets it. Errors as workspace_lease(). */
MUST_CHECK enum err lease_take(struct startup_lease *l, uint32_t bytes, void **memory);
/* The results in the memory are still those of start-up. */
bool lease_holds(const struct startup_lease *l);
/* The command that frees the workspace; NULL: nobody needs the results. */
void lease_frees(struct startup_lease *l, const char *command);

#endif

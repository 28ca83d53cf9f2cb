#include "commission/lease.h"

#include "commission/lease_state.h"

bool lease_holds(const struct startup_lease *l)
{
    return !l->lost && workspace_holds(l->workspace, COMMISSION_HOLDER);
}

enum err lease_take(struct startup_lease *l, uint32_t bytes, void **memory)
{
    bool held = lease_holds(l);
    enum err err =
        workspace_lease(l->workspace, COMMISSION_HOLDER, "commission abort", bytes, memory);
    if (!err)
        l->lost = !held;
    return err;
}

void lease_frees(struct startup_lease *l, const char *command)
{
    workspace_frees(l->workspace, COMMISSION_HOLDER, command);
}

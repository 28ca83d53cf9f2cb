#include "kinds/experiment/experiment_lease.h"

#include <stddef.h>

#include "base/workspace.h"
#include "kinds/experiment/experiment_lease_state.h"

#define HOLDER "experiment"
#define FREES  "block N stop"

void *experiment_lease_ask(struct experiment_lease *l, uint32_t bytes)
{
    struct workspace *w = workspace_shared();
    void *memory = NULL;
    if (!w || workspace_lease_for_now(w, HOLDER, FREES, bytes, &l->number, &memory) != ERR_OK)
        return NULL;
    return memory;
}

void experiment_lease_hold(struct experiment_lease *l, void *memory)
{
    l->memory = memory;
}

void *experiment_leased(const struct experiment_lease *l)
{
    return l->memory;
}

bool experiment_lease_renew(struct experiment_lease *l)
{
    if (!l->memory || workspace_renew(workspace_shared(), l->number))
        return true;
    l->memory = NULL;
    return false;
}

void experiment_lease_end(struct experiment_lease *l)
{
    if (l->memory)
        workspace_end(workspace_shared(), l->number);
    l->memory = NULL;
}

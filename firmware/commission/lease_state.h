/* The state of lease.c. */
#ifndef REFLUX_COMMISSION_LEASE_STATE_H
#define REFLUX_COMMISSION_LEASE_STATE_H

#include "base/workspace.h"

struct startup_lease {
    struct workspace *workspace;
    bool lost; /* another holder has had the memory since the results were written */
};

/* New results begin in the memory. */
static inline void lease_begin(struct startup_lease *l)
{
    l->lost = false;
}

/* w must live as long. */
static inline void lease_init(struct startup_lease *l, struct workspace *w)
{
    l->workspace = w;
    l->lost = false;
}

#endif

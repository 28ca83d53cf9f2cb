/* Workspace: one large region of memory that the board sets aside, leased whole and by name, for a while. Start-up's tests and
 * analysis, covariances and searches use it.
 *
 * The holder says which command frees the region, and changes that command as it goes on. A refusal names the holder and the
 * command. A lease without a command has ended: the last holder may still read and show the contents until the next lease.
 *
 * Only the main loop leases the region, so that nobody loses contents that he is printing. It holds hal_tick_lock, or leases with
 * workspace_lease_for_now(), where only the holder's own tick looks at the lease. The holder may change the command in the tick. */
#ifndef REFLUX_BASE_WORKSPACE_H
#define REFLUX_BASE_WORKSPACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "base/text.h"

#ifndef WORKSPACE_BYTES
#define WORKSPACE_BYTES 60000 /* 0: the board has none */
#endif

#if WORKSPACE_BYTES
struct workspace {
    void *memory; /* aligned for everything */
    uint32_t bytes;
    const char *holder;         /* present or last holder; NULL: there was none yet */
    const char *volatile frees; /* the command that frees it; NULL: the lease has ended */
    uint32_t lease;             /* counts leases */
    bool renewed;               /* the present lease ends unless the holder renews it */
    volatile uint8_t ticks;     /* ticks since the last renewal */
};

void workspace_init(struct workspace *w, void *memory, uint32_t bytes);

/* Publishes the region of this firmware, for the kinds of blocks, to which nobody hands it. workspace_shared() returns it; NULL:
 * there is none. */
void workspace_share(struct workspace *w);
struct workspace *workspace_shared(void);

/* Leases the region to a holder of that name and puts it into *memory. The text of the name must stay valid. A holder that has the
 * lease already keeps it. ERR_BUSY: somebody else has it (workspace_refusal() says who); ERR_MEMORY: it is smaller than `bytes`. */
MUST_CHECK enum err workspace_lease(struct workspace *w, const char *holder, const char *frees,
                                    uint32_t bytes, void **memory);
/* Sets the command that frees the region. NULL ends the lease: the next holder may overwrite the contents. The function does nothing
 * where another holds the region. */
void workspace_frees(struct workspace *w, const char *holder, const char *frees);
/* Returns whether the contents still belong to this holder. */
bool workspace_holds(const struct workspace *w, const char *holder);

/* Leases the region to a holder that may vanish without a word, as a block does with its settings. The lease ends if nobody renews it
 * for WORKSPACE_TICKS ticks. *lease is its number, by which two blocks of a kind see which of them has it. Errors as
 * workspace_lease(); ERR_BUSY also where the same name has it. */
#define WORKSPACE_TICKS 2
MUST_CHECK enum err workspace_lease_for_now(struct workspace *w, const char *holder,
                                            const char *frees, uint32_t bytes, uint32_t *lease,
                                            void **memory);
/* Renews a lease, in the tick of the holder. Returns whether that lease still stands. */
bool workspace_renew(struct workspace *w, uint32_t lease);
void workspace_end(struct workspace *w, uint32_t lease);
/* Ends a lease that was not renewed in time. Call once a tick, after all holders have had their turn. */
void workspace_tick(struct workspace *w);

/* Writes the reason of ERR_BUSY: "start-up has it; `commission abort` frees it". */
void workspace_refusal(const struct workspace *w, struct text *t);

/* Initialises and publishes the region at the start of the firmware. Returns w. */
static inline struct workspace *workspace_start(struct workspace *w, void *memory, uint32_t bytes)
{
    workspace_init(w, memory, bytes);
    workspace_share(w);
    return w;
}
#else
struct workspace {
};
/* Returns NULL: the board has none. Does not evaluate `memory`, because such a board has no hal_workspace(). */
#define workspace_start(w, memory, bytes) ((void)(w), (struct workspace *)NULL)
#define workspace_tick(w)                 ((void)(w))
#endif

#endif

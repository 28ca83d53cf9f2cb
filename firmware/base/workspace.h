/* Large memory for a while: one region that the board sets aside, leased whole and by name (start-up's tests and analysis,
 * covariances, searches).
 *
 * Whoever holds it says which command frees it, and changes that as it goes on; who asks meanwhile is told both. Without such a
 * command the lease has ended: what is in the region may still be read, and shown, by its last holder, until it is leased
 * for something else.
 *
 * Leased in the main loop alone, so that nobody loses what he is printing: under hal_tick_lock, or for now, where only the holder's own
 * tick looks at it; the holder may change the command in the tick, too. */
#ifndef REFLUX_BASE_WORKSPACE_H
#define REFLUX_BASE_WORKSPACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "base/text.h"

#ifndef WORKSPACE_BYTES
#define WORKSPACE_BYTES 58000 /* 0: the board has none */
#endif

#if WORKSPACE_BYTES
struct workspace {
    void *memory; /* aligned for everything */
    uint32_t bytes;
    const char *holder;         /* NULL: nobody has had it yet */
    const char *volatile frees; /* the command that frees it; NULL: the lease has ended */
    uint32_t lease;             /* counts leases */
    bool renewed;               /* the present one lasts as long as it is renewed */
    volatile uint8_t ticks;     /* since it was */
};

void workspace_init(struct workspace *w, void *memory, uint32_t bytes);

/* The region of this firmware, for those who are not handed it: the kinds of blocks. NULL: there is none. */
void workspace_share(struct workspace *w);
struct workspace *workspace_shared(void);

/* *memory gets the region, for a holder of that name, which goes on living. Who holds it already goes on with it. ERR_BUSY: somebody
 * else does (workspace_refusal() says who); ERR_MEMORY: it is smaller than `bytes`. */
MUST_CHECK enum err workspace_lease(struct workspace *w, const char *holder, const char *frees,
                                    uint32_t bytes, void **memory);
/* From now on that command frees it; NULL: the lease has ended, and what is there may be overwritten by the next. Nothing
 * where another holds it. */
void workspace_frees(struct workspace *w, const char *holder, const char *frees);
/* Is what is in it still this holder's? */
bool workspace_holds(const struct workspace *w, const char *holder);

/* For a holder that may vanish without a word, as a block does with its settings: the lease ends when it was not renewed for
 * WORKSPACE_TICKS ticks. *lease is its number, by which two blocks of a kind tell which of them has it. Errors as workspace_lease;
 * ERR_BUSY also where the same name has it. */
#define WORKSPACE_TICKS 2
MUST_CHECK enum err workspace_lease_for_now(struct workspace *w, const char *holder,
                                            const char *frees, uint32_t bytes, uint32_t *lease,
                                            void **memory);
/* The tick of the holder. Whether that lease still stands. */
bool workspace_renew(struct workspace *w, uint32_t lease);
void workspace_end(struct workspace *w, uint32_t lease);
/* Once a tick, after all who renew have had their turn. */
void workspace_tick(struct workspace *w);

/* After ERR_BUSY: "start-up has it; `commission abort` frees it". */
void workspace_refusal(const struct workspace *w, struct text *t);

/* At the start of the firmware: its region, for all. Returns w. */
static inline struct workspace *workspace_start(struct workspace *w, void *memory, uint32_t bytes)
{
    workspace_init(w, memory, bytes);
    workspace_share(w);
    return w;
}
#else
struct workspace {
};
/* NULL: the board has none. */
#define workspace_start(w, memory, bytes) ((void)(w), (void)(memory), (struct workspace *)NULL)
#define workspace_tick(w)                 ((void)(w))
#endif

#endif

#include "base/workspace.h"

#include <stddef.h>
#include <string.h>

void workspace_init(struct workspace *w, void *memory, uint32_t bytes)
{
    *w = (struct workspace){.memory = memory, .bytes = bytes};
}

static struct workspace *shared;

void workspace_share(struct workspace *w)
{
    shared = w;
}

struct workspace *workspace_shared(void)
{
    return shared;
}

bool workspace_holds(const struct workspace *w, const char *holder)
{
    return w->holder == holder || (w->holder && strcmp(w->holder, holder) == 0);
}

enum err workspace_lease(struct workspace *w, const char *holder, const char *frees, uint32_t bytes,
                         void **memory)
{
    if (bytes > w->bytes)
        return ERR_MEMORY;
    if (w->frees && !workspace_holds(w, holder))
        return ERR_BUSY;
    w->lease += w->frees ? 0 : 1u;
    w->holder = holder;
    w->renewed = false;
    w->frees = frees;
    *memory = w->memory;
    return ERR_OK;
}

enum err workspace_lease_for_now(struct workspace *w, const char *holder, const char *frees,
                                 uint32_t bytes, uint32_t *lease, void **memory)
{
    if (w->frees)
        return ERR_BUSY;
    enum err err = workspace_lease(w, holder, frees, bytes, memory);
    w->ticks = 0;
    w->renewed = !err;
    *lease = w->lease;
    return err;
}

static bool stands(const struct workspace *w, uint32_t lease)
{
    return w->frees && w->renewed && w->lease == lease;
}

bool workspace_renew(struct workspace *w, uint32_t lease)
{
    if (!stands(w, lease))
        return false;
    w->ticks = 0;
    return true;
}

void workspace_end(struct workspace *w, uint32_t lease)
{
    if (stands(w, lease))
        w->frees = NULL;
}

void workspace_tick(struct workspace *w)
{
    if (!w->frees || !w->renewed)
        return;
    if (w->ticks >= WORKSPACE_TICKS)
        w->frees = NULL;
    else
        w->ticks++;
}

void workspace_frees(struct workspace *w, const char *holder, const char *frees)
{
    if (workspace_holds(w, holder))
        w->frees = frees;
}

void workspace_refusal(const struct workspace *w, struct text *t)
{
    text_str(t, w->holder ? w->holder : "nobody");
    text_str(t, " has it; `");
    text_str(t, w->frees ? w->frees : "");
    text_str(t, "` frees it");
}

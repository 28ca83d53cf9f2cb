#include "base/workspace.h"

#include <stddef.h>
#include <string.h>

#if WORKSPACE_BYTES

void workspace_init(struct workspace *w, void *memory, uint32_t bytes)
{
    *w = (struct workspace){.memory = memory, .bytes = bytes};
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
    w->holder = holder;
    w->frees = frees;
    *memory = w->memory;
    return ERR_OK;
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

#endif

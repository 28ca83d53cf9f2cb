/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/line.h"

#include <stddef.h>

struct line_claim {
    const void *holder; /* NULL: free */
    uint32_t from_ms;
    uint16_t for_ms;
    uint8_t line, bus, unit;
};

/* There is one set of buses, so there is one table. */
static struct line_claim claims[LINE_CLAIMS_MAX];

static bool claim_holds(const struct line_claim *c, uint32_t now_ms)
{
    return c->holder != NULL && now_ms - c->from_ms < c->for_ms;
}

bool line_claim(uint8_t line, uint8_t bus, uint8_t unit, const void *holder, uint32_t now_ms,
                uint16_t for_ms)
{
    struct line_claim *place = NULL;
    for (unsigned k = 0; k < LINE_CLAIMS_MAX; k++) {
        struct line_claim *c = &claims[k];
        bool same = c->line == line && c->bus == bus && c->unit == unit;
        if (!claim_holds(c, now_ms)) {
            c->holder = NULL;
            place = place == NULL ? c : place;
        } else if (same && c->holder != holder) {
            return false;
        } else if (same) {
            c->holder = NULL; /* made anew below */
            place = c;
        }
    }
    if (place == NULL)
        return false;
    *place = (struct line_claim){holder, now_ms, for_ms, line, bus, unit};
    return true;
}

void line_release(const void *holder)
{
    for (unsigned k = 0; k < LINE_CLAIMS_MAX; k++)
        if (claims[k].holder == holder)
            claims[k].holder = NULL;
}

#include "service/heartbeat.h"

void heartbeat_init(struct heartbeat *h, uint32_t timeout_ms)
{
    *h = (struct heartbeat){.timeout_ms = timeout_ms};
}

void heartbeat_tick_begins(struct heartbeat *h, uint64_t now_ms)
{
    h->began_ms = now_ms;
}

void heartbeat_tick_ends(struct heartbeat *h, uint64_t now_ms, uint32_t deadline_ms)
{
    h->late = now_ms - h->began_ms > deadline_ms;
}

bool heartbeat_due(struct heartbeat *h, uint64_t now_ms, uint32_t turns)
{
    if (turns != h->turns) {
        h->turns = turns;
        h->turned_ms = now_ms;
    }
    if (h->late || now_ms - h->turned_ms >= h->timeout_ms / 2u)
        return false;
    if (h->fed && now_ms - h->fed_ms < h->timeout_ms / HEARTBEAT_RATE)
        return false;
    h->fed = true;
    h->fed_ms = now_ms;
    return true;
}

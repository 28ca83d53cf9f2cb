#include "service/heartbeat.h"

void heartbeat_init(struct heartbeat *h, uint32_t timeout_ms)
{
    *h = (struct heartbeat){.timeout_ms = timeout_ms};
}

void heartbeat_change(struct heartbeat *h, uint32_t timeout_ms)
{
    h->timeout_ms = timeout_ms;
    h->fed = false;
}

void heartbeat_tick_begins(struct heartbeat *h, uint64_t now_ms)
{
    h->tick_ms = now_ms;
}

void heartbeat_tick_ends(struct heartbeat *h, uint64_t now_ms, uint32_t deadline_ms)
{
    if (now_ms - h->tick_ms <= deadline_ms)
        h->late = 0;
    else if (h->late < HEARTBEAT_LATE)
        h->late++;
    h->tick_ms = now_ms;
}

bool heartbeat_due(struct heartbeat *h, uint64_t now_ms, uint32_t turns)
{
    if (turns != h->turns) {
        h->turns = turns;
        h->turned_ms = now_ms;
    }
    if (now_ms - h->tick_ms >= h->timeout_ms / 4u)
        h->late = 0; /* no tick has come since, so there is time again */
    if (h->late == HEARTBEAT_LATE || now_ms - h->turned_ms >= h->timeout_ms / 2u)
        return false;
    if (h->fed && now_ms - h->fed_ms < h->timeout_ms / HEARTBEAT_RATE)
        return false;
    h->fed = true;
    h->fed_ms = now_ms;
    return true;
}

#include "supervise/by_board.h"

#include <string.h>

#include "base/elapsed.h"

static void tell(struct supervisor *s, uint8_t i, enum event_code code)
{
    event_put(s->events, s->time_ms, code, s->plan->config.loop[i].name, 0.0f,
              s->by_board.cause[i]);
}

void by_board_begin(struct supervisor *s, uint8_t i, enum by_board_cause cause)
{
    s->by_board.cause[i] = (uint8_t)cause;
    s->by_board.since_s[i] = (uint32_t)(elapsed_ms(s->time_ms, 0) / 1000.0f);
    tell(s, i, EVENT_MANUAL_BY_BOARD);
}

void board_to_manual(struct supervisor *s, uint8_t i, enum by_board_cause cause)
{
    if (loop_acts(s, i))
        by_board_begin(s, i, cause);
    loop_to_manual(s, i);
}

void by_board_end(struct supervisor *s, uint8_t i)
{
    if (s->by_board.cause[i] == BY_BOARD_NOT)
        return;
    s->by_board.cause[i] = BY_BOARD_NOT;
    tell(s, i, EVENT_MANUAL_BY_BOARD_OVER);
}

void by_board_place(struct supervisor *s, const struct plan *old, uint8_t i, bool acted)
{
    const char *name = s->plan->config.loop[i].name;
    if (!old || !s->plan->loop[i].used || strcmp(name, old->config.loop[i].name) != 0)
        s->by_board.cause[i] = BY_BOARD_NOT;
    else if (acted)
        by_board_begin(s, i, BY_BOARD_PLAN);
}

void by_board_restore(struct supervisor *s, uint8_t i, uint8_t cause, bool acted)
{
    if (acted && !loop_acts(s, i))
        by_board_begin(s, i, BY_BOARD_RESTART);
    if (cause == BY_BOARD_NOT || acted)
        return;
    by_board_begin(s, i, (enum by_board_cause)cause);
    s->by_board.since_s[i] = BY_BOARD_EARLIER;
}

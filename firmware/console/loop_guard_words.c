/* Words on doubtful measurements, on loops far from their setpoints, and on loops that the board has put into manual. */
#include "console/loop_guard_words.h"

#include "base/assertion.h"
#include "console/phrases.h"

static void alarm_words(const char *code, const char *name, const char *words, struct text *line)
{
    text_str(line, code);
    put_word(line, name);
    put_word(line, words);
}

void doubtful_line(const struct service *s, unsigned n, struct text *line)
{
    const struct supervisor *sup = s->supervisor;
    if (n < sup->placed[PLACED_MEASUREMENTS] && sup->measurement[n].doubt.lasting.active)
        alarm_words("DOUBTFUL", service_in_force(s)->config.measurement[n].name,
                    "is uncertain and a loop acts on it", line);
}

/* Writes why the board has put a loop into manual. measurement: the loop's. */
static void put_cause(uint8_t cause, const char *measurement, struct text *line)
{
    static const char *const causes[BY_BOARD_CAUSES] = {
        [BY_BOARD_BAD] = " was bad",
        [BY_BOARD_DOUBTED] = " was uncertain for long",
        [BY_BOARD_UNBOUND] = "the plant lacked a channel",
        [BY_BOARD_BLOCK] = "bad input of a block",
        [BY_BOARD_SAFE] = "the safe state",
        [BY_BOARD_PLAN] = "new settings of its channels",
        [BY_BOARD_RESTART] = "a restart",
    };
    REFLUX_ASSERT(cause > BY_BOARD_NOT && cause < BY_BOARD_CAUSES);
    if (cause <= BY_BOARD_DOUBTED)
        text_str(line, measurement);
    text_str(line, causes[cause]);
}

/* Loop n is in manual, and nobody but the board has put it there. */
static void by_board_line(const struct service *s, unsigned n, struct text *line)
{
    const struct supervisor *sup = s->supervisor;
    uint8_t cause = n < sup->placed[PLACED_LOOPS] ? sup->by_board.cause[n] : BY_BOARD_NOT;
    if (cause == BY_BOARD_NOT)
        return;
    const struct plan *plan = service_in_force(s);
    uint32_t since_s = sup->by_board.since_s[n];
    alarm_words("MANUAL_BY_BOARD", plan->config.loop[n].name,
                "is in manual, put there by the board ", line);
    if (since_s == BY_BOARD_EARLIER) {
        text_str(line, "before the last restart");
    } else {
        text_str(line, "at ");
        text_u32(line, since_s);
        text_str(line, " s");
    }
    text_str(line, ": ");
    put_cause(cause, plan->config.measurement[plan->loop[n].pv].name, line);
}

void deviation_line(const struct service *s, unsigned n, struct text *line)
{
    const struct supervisor *sup = s->supervisor;
    if (n < sup->placed[PLACED_LOOPS] && sup->loop[n].deviation.lasting.active)
        alarm_words("DEVIATION", service_in_force(s)->config.loop[n].name,
                    "is far from its setpoint", line);
    else
        by_board_line(s, n, line);
}

void latched_words(const struct service *s, unsigned n, struct text *line)
{
    if (!s->supervisor->interlock[n].latch.alone)
        return;
    text_str(line, ", until `alarm release lock");
    text_u32(line, n + 1u);
    text_char(line, '`');
}

void guard_event_words(const struct event *e, struct text *line)
{
    if (e->code == EVENT_INTERLOCK_ON || e->code == EVENT_INTERLOCK_OFF) {
        text_str(line, ": lock");
        text_u32(line, e->detail + 1u);
    }
    if (e->code != EVENT_MANUAL_BY_BOARD || e->detail >= BY_BOARD_CAUSES)
        return;
    text_str(line, ": ");
    put_cause(e->detail, "its measurement", line);
}

void by_board_status(const struct service *s, struct text *line)
{
    const char *before = "in manual by the board's decision: ";
    for (unsigned i = 0; i < s->supervisor->placed[PLACED_LOOPS]; i++) {
        if (s->supervisor->by_board.cause[i] == BY_BOARD_NOT)
            continue;
        text_str(line, before);
        text_str(line, service_in_force(s)->config.loop[i].name);
        before = ", ";
    }
    if (line->n)
        text_str(line, " (`alarm` says why)");
}

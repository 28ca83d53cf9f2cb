/* `stats`: what ticks cost, and the counters of link, lines, console and memory. */
#include "console/command_table.h"
#include "console/startup_words.h"
#include "hal/clock.h"
#include "hal/memory_use.h"
#include "hal/uart.h"
#include "service/service.h"

static void uart_line(struct text *line, const char *name, enum hal_uart port)
{
    struct hal_uart_stats u;
    hal_uart_get_stats(port, &u);
    text_str(line, name);
    text_named_u32(line, "received", u.received);
    text_named_u32(line, "sent", u.sent);
    text_named_u32(line, "dropped", u.rx_dropped);
    text_named_u32(line, "line_errors", u.line_errors);
}

/* Division bit by bit: the mean of numbers of 32 bits has no more of them. */
static uint32_t mean(const struct tick_cost *cost)
{
    uint64_t left = cost->sum;
    uint32_t result = 0;
    for (unsigned bit = 32; cost->n && bit-- > 0;) {
        if (left >> bit < cost->n)
            continue;
        left -= (uint64_t)cost->n << bit;
        result |= 1u << bit;
    }
    return result;
}

/* Lines of the plant link, by their place. */
enum { LINK_COUNTS = 1, LINK_LOSSES = 2, LINK_UART = 4 };

/* Place of the n-th line of a board that has no link. */
static inline unsigned skip_link_lines(unsigned n)
{
    n += n >= LINK_COUNTS ? 2u : 0;
    return n >= LINK_UART ? n + 1u : n;
}

static bool stats_line(struct client *c, unsigned n, struct text *line)
{
    const struct service *s = c->service;
    const struct tick_cost *cost = &s->cost;
    const struct plant_link *link = s->link;
    if (!CONFIG_LINK)
        n = skip_link_lines(n);
    switch (n) {
    case 0:
        text_str(line, "tick");
        text_named_u32(line, "n", cost->n);
        text_named_u32(line, "min", cost->lowest);
        text_named_u32(line, "mean", mean(cost));
        text_named_u32(line, "max", cost->highest);
        text_named_u32(line, "last", cost->last);
        text_str(line, " unit ");
        text_str(line, hal_cycles_unit());
        return true;
    case LINK_COUNTS:
        if (!CONFIG_LINK)
            return false;
        text_str(line, "link");
        text_named_u32(line, "samples", link->stats.samples);
        text_named_u32(line, "commands", link->stats.commands);
        text_named_u32(line, "good", link->decoder.count.good);
        text_named_u32(line, "bad_crc", link->decoder.count.bad_crc);
        text_named_u32(line, "malformed", link->decoder.count.malformed);
        text_named_u32(line, "overlong", link->decoder.count.overlong);
        return true;
    case LINK_LOSSES:
        if (!CONFIG_LINK)
            return false;
        text_str(line, "link");
        text_named_u32(line, "lost_frames", link->stats.lost_frames);
        text_named_u32(line, "refused", link->stats.refused);
        text_named_u32(line, "congested", link->stats.congested);
        text_named_u32(line, "silences", link->stats.silences);
        return true;
    case 3:
        uart_line(line, "console_uart", HAL_UART_CONSOLE);
        return true;
    case LINK_UART:
        if (!CONFIG_LINK)
            return false;
        uart_line(line, "link_uart", HAL_UART_LINK);
        return true;
    case 5:
        text_str(line, "console");
        text_named_u32(line, "lines", reply_counts(c)->lines);
        text_named_u32(line, "errors", reply_counts(c)->errors);
        text_named_u32(line, "dropped", reply_counts(c)->dropped);
        text_named_u32(line, "telemetry_lost", s->telemetry.lost);
        text_named_u32(line, "events_lost", s->tick_events.lost);
        text_named_u32(line, "events_unannounced", s->unannounced);
        return true;
    case 6:
        text_str(line, "memory");
        text_named_u32(line, "stack_bytes", hal_stack_size());
        text_named_u32(line, "stack_unused", hal_stack_unused());
        return true;
    case 7:
        text_str(line, "board");
        text_named_u32(line, "up_ms", (uint32_t)hal_clock_ms());
        return true;
    case 8:
        return work_cost_line(s, line);
    default:
        return false;
    }
}

void command_stats(struct client *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    reply_list(c, stats_line, "");
}

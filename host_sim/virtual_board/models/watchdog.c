/* Independent watchdog: a down-counter on a slow clock of its own that nothing stops. Read in RM0090 Rev 21 (21.3 and 21.4) and RM0041 Rev 6
 * (18.3 and 18.4). A value of IWDG_PR or IWDG_RLR arrives after five periods of the slow clock, whether that runs or not (unverified). A new
 * divider is in force from the next feeding on (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "models.h"

enum { KR = 0x0, PR = 0x4, RLR = 0x8, SR = 0xC };

#define KEY_ACCESS 0x5555u
#define KEY_RELOAD 0xAAAAu
#define KEY_START  0xCCCCu
#define PVU        1u
#define RVU        2u
#define ARRIVES    5u /* periods of the slow clock that a value takes at most (21.4.4) */
#define NS_PER_S   UINT64_C(1000000000)

static const struct reg regs[] = {
    {"KR", KR, 0, 0xFFFFu, 0},
    {"PR", PR, 0, 0x7u, 0x7u},
    {"RLR", RLR, 0xFFFu, 0xFFFu, 0xFFFu},
    {"SR", SR, 0, 0x3u, 0},
};

struct watchdog {
    struct board_event bites, arrives;
    bool runs, open;
    uint32_t divider, reload; /* in force */
    uint32_t counter;         /* from which it starts */
};

static uint64_t count_ns(const struct part *p, uint64_t counts)
{
    const struct watchdog *w = p->state;
    return counts * (4u << w->divider) * NS_PER_S / p->board->around.slow_clock_hz;
}

static void count_down(struct part *p)
{
    struct watchdog *w = p->state;
    if (w->runs)
        board_schedule(p->board, &w->bites,
                       board_ns(p->board) + count_ns(p, (uint64_t)w->counter + 1u));
}

static void bites(void *context)
{
    board_ask_reset(((struct part *)context)->board, RESET_WATCHDOG);
}

static void arrives(void *context)
{
    struct part *p = context;
    struct watchdog *w = p->state;
    w->divider = part_get(p, PR) < 6u ? part_get(p, PR) : 6u;
    w->reload = part_get(p, RLR);
    part_set(p, SR, 0);
}

static void start(struct part *p)
{
    struct watchdog *w = p->state;
    w->bites = (struct board_event){.due = bites, .context = p};
    w->arrives = (struct board_event){.due = arrives, .context = p};
    board_add_event(p->board, &w->bites);
    board_add_event(p->board, &w->arrives);
}

static void reset(struct part *p, enum board_reset kind)
{
    struct watchdog *w = p->state;
    (void)kind;
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    w->open = false;
    w->runs = p->board->around.hardware_watchdog; /* 21.3.1 */
    w->divider = 0;
    w->reload = w->counter = 0xFFFu;
    count_down(p);
}

/* RM0090 21.4.2 and 21.4.3: what is read is good while nothing is on its way. */
static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    if ((offset == PR || offset == RLR) && (part_get(p, SR) & (offset == PR ? PVU : RVU)) != 0)
        board_verdict(p->board, "read of IWDG_%s while a value is on its way",
                      offset == PR ? "PR" : "RLR");
    return stored;
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    struct watchdog *w = p->state;
    if (offset == KR) {
        w->open = written == KEY_ACCESS;
        if (written == KEY_RELOAD)
            w->counter = w->reload;
        bool starts = written == KEY_START && !w->runs; /* 21.4.1: it starts once */
        w->runs = w->runs || starts;
        if (starts || written == KEY_RELOAD)
            count_down(p);
        return;
    }
    uint32_t busy = offset == PR ? PVU : RVU;
    if (!w->open) {
        part_set(p, offset, before); /* 21.3.2: protected */
        return;
    }
    if ((part_get(p, SR) & busy) != 0) {
        board_verdict(p->board, "write of IWDG_%s while an earlier value is on its way",
                      offset == PR ? "PR" : "RLR");
        return;
    }
    part_set(p, SR, part_get(p, SR) | busy);
    board_schedule(p->board, &w->arrives,
                   board_ns(p->board) + ARRIVES * NS_PER_S / p->board->around.slow_clock_hz);
}

const struct part_class watchdog_class = {.name = "IWDG",
                                          .regs = regs,
                                          .n_regs = 4,
                                          .state_bytes = sizeof(struct watchdog),
                                          .widths = WIDTH_HALF | WIDTH_WORD,
                                          .start = start,
                                          .reset = reset,
                                          .read = read,
                                          .write = write};

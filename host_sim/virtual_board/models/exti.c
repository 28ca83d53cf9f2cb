/* Interrupts of edges at pins: EXTI, and the part of SYSCFG that chooses a port for each line. From memory: the registers IMR, EMR, RTSR, FTSR, SWIER, PR
 * and SYSCFG_EXTICR1 to 4, PR that is cleared by ones, and that lines 5 to 9 and 10 to 15 share an interrupt (unverified). A port that is chosen
 * anew makes no edge here (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "pins.h"

enum { IMR = 0x00, EMR = 0x04, RTSR = 0x08, FTSR = 0x0C, SWIER = 0x10, PR = 0x14 };
enum { EXTICR1 = 0x08, EXTICR4 = 0x14 };

#define LINES   16u
#define OF_PINS 0xFFFFu

static const struct reg exti_regs[] = {
    {"IMR", IMR, 0, 0x007FFFFFu, 0x007FFFFFu},   {"EMR", EMR, 0, 0x007FFFFFu, 0x007FFFFFu},
    {"RTSR", RTSR, 0, 0x007FFFFFu, 0x007FFFFFu}, {"FTSR", FTSR, 0, 0x007FFFFFu, 0x007FFFFFu},
    {"SWIER", SWIER, 0, 0x007FFFFFu, 0},         {"PR", PR, 0, 0x007FFFFFu, 0},
};

static const struct reg syscfg_regs[] = {
    {"EXTICR1", EXTICR1, 0, 0xFFFFu, 0xFFFFu},
    {"EXTICR2", EXTICR1 + 4, 0, 0xFFFFu, 0xFFFFu},
    {"EXTICR3", EXTICR1 + 8, 0, 0xFFFFu, 0xFFFFu},
    {"EXTICR4", EXTICR4, 0, 0xFFFFu, 0xFFFFu},
};

struct exti {
    bool high[LINES];        /* as it was seen last */
    struct board_event edge; /* of the world */
};

static const struct {
    uint32_t lines;
    uint8_t irq;
} groups[] = {{1u << 0, 6},  {1u << 1, 7}, {1u << 2, 8}, {1u << 3, 9},
              {1u << 4, 10}, {0x3E0u, 23}, {0xFC00u, 40}};

static void update_irq(struct part *p)
{
    uint32_t asking = part_get(p, PR) & part_get(p, IMR);
    for (size_t i = 0; i < sizeof(groups) / sizeof(groups[0]); i++)
        interrupt_line(p->board, groups[i].irq, (asking & groups[i].lines) != 0);
}

/* The pin that is chosen for a line. */
static unsigned pin_of(struct board *b, unsigned line)
{
    uint32_t word = part_get(bus_part(b, "SYSCFG"), EXTICR1 + 4u * (line / 4u));
    return 16u * (word >> 4 * (line % 4u) & 15u) + line;
}

void exti_look(struct board *b, unsigned pin)
{
    struct part *p = bus_part(b, "EXTI");
    unsigned line = pin % LINES;
    if (p == NULL || pin_of(b, line) != pin)
        return;
    struct exti *e = p->state;
    bool high = pin_level(b, pin);
    uint32_t edge = part_get(p, high ? RTSR : FTSR) & UINT32_C(1) << line;
    if (high != e->high[line] && edge != 0) {
        part_set(p, PR, part_get(p, PR) | edge);
        update_irq(p);
    }
    e->high[line] = high;
}

void board_world_changed(struct board *b)
{
    struct part *p = bus_part(b, "EXTI");
    if (p == NULL)
        return;
    struct exti *e = p->state;
    uint64_t at_ns = BOARD_NEVER;
    for (unsigned line = 0; line < LINES; line++)
        exti_look(b, pin_of(b, line));
    if (b->world.next_edge != NULL)
        at_ns = b->world.next_edge(b->world.context, board_ns(b));
    board_schedule(b, &e->edge, at_ns);
}

static void edge_due(void *context)
{
    board_world_changed(context);
}

static void exti_start(struct part *p)
{
    struct exti *e = p->state;
    e->edge = (struct board_event){.due = edge_due, .context = p->board};
    board_add_event(p->board, &e->edge);
}

static void exti_reset(struct part *p, enum board_reset kind)
{
    (void)kind;
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    update_irq(p);
}

static void exti_write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    if (offset == PR)
        part_set(p, PR, before & ~written);
    else if (offset == SWIER || offset == EMR || (written & ~OF_PINS) != 0)
        board_verdict(p->board, "0x%x in register 0x%x of EXTI is not modelled", written, offset);
    update_irq(p);
}

/* The line sees another pin: its level is no edge. */
static void syscfg_write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    struct exti *e = bus_part(p->board, "EXTI")->state;
    (void)before;
    for (unsigned line = (offset - EXTICR1); line < offset - EXTICR1 + 4u; line++) {
        unsigned port = written >> 4 * (line % 4u) & 15u;
        if (port > 3u)
            board_verdict(p->board, "a pin of port %c for line %u of EXTI is not modelled",
                          (char)('A' + (int)port), line);
        else
            e->high[line] = pin_level(p->board, 16u * port + line);
    }
}

const struct part_class exti_class = {.name = "EXTI",
                                      .regs = exti_regs,
                                      .n_regs = sizeof(exti_regs) / sizeof(exti_regs[0]),
                                      .state_bytes = sizeof(struct exti),
                                      .widths = WIDTH_WORD,
                                      .start = exti_start,
                                      .reset = exti_reset,
                                      .write = exti_write};
const struct part_class syscfg_class = {.name = "SYSCFG",
                                        .regs = syscfg_regs,
                                        .n_regs = sizeof(syscfg_regs) / sizeof(syscfg_regs[0]),
                                        .widths = WIDTH_WORD,
                                        .write = syscfg_write};

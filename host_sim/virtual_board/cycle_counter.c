/* The cycle counter (DDI 0403 C1.8): it counts once the trace unit is on (DEMCR_TRCENA).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "system_control.h"

enum { DWT_CTRL = 0, DWT_CYCCNT = 4 };

static const struct reg trace_regs[] = {{"CTRL", DWT_CTRL, 0x40000000u, UINT32_MAX, 0x1u},
                                        {"CYCCNT", DWT_CYCCNT, 0, UINT32_MAX, UINT32_MAX}};

struct trace {
    uint64_t zero; /* cycles at which the counter was 0 */
};

static uint32_t trace_read(struct part *p, uint32_t offset, uint32_t stored)
{
    const struct trace *t = p->state;
    bool counts = (part_get(p, DWT_CTRL) & 1u) != 0;
    return offset == DWT_CYCCNT && counts ? (uint32_t)(p->board->cycles - t->zero) : stored;
}

static void trace_write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    struct trace *t = p->state;
    if ((control_word(processor_interrupts(p->board), DEMCR) >> 24 & 1u) == 0)
        board_verdict(p->board, "write of DWT while DEMCR_TRCENA is off");
    if (offset == DWT_CYCCNT)
        t->zero = p->board->cycles - written;
    else if ((written & ~before & 1u) != 0)
        t->zero = p->board->cycles - part_get(p, DWT_CYCCNT);
    else if ((before & ~written & 1u) != 0)
        part_set(p, DWT_CYCCNT, (uint32_t)(p->board->cycles - t->zero));
}

const struct part_class trace_class = {.name = "cycle counter",
                                       .regs = trace_regs,
                                       .n_regs = 2,
                                       .widths = WIDTH_WORD,
                                       .state_bytes = sizeof(struct trace),
                                       .read = trace_read,
                                       .write = trace_write};

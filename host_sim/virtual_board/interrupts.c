/* The interrupt controller chooses which exception runs and which comes next. Read in PM0214 Rev 10: 2.3.5, 2.3.7, 2.4.2, 2.4.4, 2.5.2. Exceptions of the Cortex-M3 have the same
 * order (unverified). Groups of priorities are not modelled.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdlib.h>
#include <string.h>

#include "system_control.h"

#define LOWEST      256
#define HFSR_FORCED (UINT32_C(1) << 30)
#define SHCSR_ENABLED(exception)                                                                   \
    (UINT32_C(1) << (12u + (exception))) /* MemManage 16, BusFault 17, UsageFault 18 */
#define CCR_DIVIDE (UINT32_C(1) << 4)
#define CCR_ALIGN  (UINT32_C(1) << 9)

struct interrupts *interrupts_new(struct board *b)
{
    struct interrupts *i = calloc(1, sizeof(*i));
    i->board = b;
    i->tick_next = BOARD_NEVER;
    return i;
}

void interrupts_free(struct interrupts *i)
{
    free(i);
}

void interrupts_reset(struct interrupts *i)
{
    (void)memset(i->pending, 0, sizeof(i->pending));
    (void)memset(i->line, 0, sizeof(i->line));
    (void)memset(i->asking, 0, sizeof(i->asking));
    (void)memset(i->enabled, 0, sizeof(i->enabled));
    (void)memset(i->region, 0, sizeof(i->region));
    i->depth = 0;
    i->tick_next = BOARD_NEVER;
    i->tick_cleared = false;
}

/* 2.3.5: of those that are equal, the lowest number comes first */
static int priority(const struct interrupts *i, unsigned exception)
{
    static const int fixed[] = {0, -3, -2, -1};
    if (exception < 4)
        return fixed[exception];
    uint32_t word = exception < EXCEPTION_IRQ0 ? control_word(i, SHPR1 + ((exception - 4u) & ~3u))
                                               : control_word(i, IPR + ((exception - 16u) & ~3u));
    return (int)(word >> 8u * (exception & 3u) & 0xFFu);
}

static int execution_priority(const struct interrupts *i, struct masks masks)
{
    int now = LOWEST;
    for (unsigned k = 0; k < i->depth; k++) {
        int p = priority(i, i->active[k]);
        now = p < now ? p : now;
    }
    if (masks.basepri != 0 && masks.basepri < now)
        now = masks.basepri;
    if (masks.primask && now > 0)
        now = 0;
    if (masks.faultmask && now > -1)
        now = -1;
    return now;
}

void interrupts_look_at(struct interrupts *i, unsigned n)
{
    uint64_t bit = UINT64_C(1) << (n & 63u);
    if ((i->pending[n] || i->line[n]) && (n < EXCEPTION_IRQ0 || i->enabled[n]))
        i->asking[n / 64u] |= bit;
    else
        i->asking[n / 64u] &= ~bit;
}

void interrupts_set_pending(struct interrupts *i, unsigned n, bool to)
{
    i->pending[n] = to;
    interrupts_look_at(i, n);
}

static bool is_active(const struct interrupts *i, unsigned n)
{
    for (unsigned k = 0; k < i->depth; k++)
        if (i->active[k] == n)
            return true;
    return false;
}

bool interrupts_in_hard_fault(const struct interrupts *i)
{
    return is_active(i, EXCEPTION_NMI) || is_active(i, EXCEPTION_HARD_FAULT);
}

bool interrupts_any(const struct interrupts *i)
{
    return (i->asking[0] | i->asking[1]) != 0;
}

unsigned interrupts_pick(const struct interrupts *i, struct masks masks, bool asleep)
{
    if (!interrupts_any(i))
        return 0;
    if (asleep)
        masks.primask = false;
    int best = execution_priority(i, masks);
    unsigned found = 0;
    for (unsigned word = 0; word < EXCEPTIONS / 64u; word++) {
        for (uint64_t left = i->asking[word]; left != 0; left &= left - 1u) {
            unsigned n = 64u * word + (unsigned)__builtin_ctzll(left);
            if (priority(i, n) < best && !is_active(i, n)) {
                best = priority(i, n);
                found = n;
            }
        }
    }
    return found;
}

void interrupts_enter(struct interrupts *i, unsigned exception)
{
    interrupts_set_pending(i, exception, false);
    if (i->depth == DEPTH)
        board_verdict(i->board, "exceptions are nested %u deep", DEPTH);
    else
        i->active[i->depth++] = exception;
    if (exception <= EXCEPTION_HARD_FAULT)
        processor_protection_changed(i->board);
}

bool interrupts_leave(struct interrupts *i, unsigned exception)
{
    if (i->depth == 0 || i->active[i->depth - 1u] != exception)
        return false;
    i->depth--;
    if (exception <= EXCEPTION_HARD_FAULT)
        processor_protection_changed(i->board);
    return true;
}

unsigned interrupts_active(const struct interrupts *i)
{
    return i->depth > 0 ? i->active[i->depth - 1u] : 0;
}

unsigned interrupts_depth(const struct interrupts *i)
{
    return i->depth;
}

/* 2.4.2 and 2.4.4: a fault that may not interrupt becomes a hard fault; one within a hard fault locks up. */
unsigned interrupts_fault(struct interrupts *i, struct masks masks, unsigned exception,
                          uint32_t status, uint32_t address)
{
    part_set(i->control, CFSR, control_word(i, CFSR) | status);
    if ((status & CFSR_MMARVALID) != 0)
        part_set(i->control, MMFAR, address);
    if ((status & CFSR_BFARVALID) != 0)
        part_set(i->control, BFAR, address);
    int now = execution_priority(i, masks);
    if ((control_word(i, SHCSR) & SHCSR_ENABLED(exception)) != 0 && priority(i, exception) < now)
        return exception;
    if (now <= -1)
        return 0;
    part_set(i->control, HFSR, control_word(i, HFSR) | HFSR_FORCED);
    return EXCEPTION_HARD_FAULT;
}

uint32_t interrupts_vectors(const struct interrupts *i)
{
    uint32_t at = control_word(i, VTOR);
    return at != 0 ? at : i->board->chip->memory[0].base; /* address 0 is the flash once more */
}

bool interrupts_align_stack(const struct interrupts *i)
{
    return (control_word(i, CCR) & CCR_ALIGN) != 0;
}

bool interrupts_divide_traps(const struct interrupts *i)
{
    return (control_word(i, CCR) & CCR_DIVIDE) != 0;
}

bool interrupts_fpu_on(const struct interrupts *i)
{
    return (control_word(i, CPACR) >> 20 & 0xFu) == 0xFu;
}

void interrupt_line(struct board *b, unsigned irq, bool high)
{
    struct interrupts *i = processor_interrupts(b);
    i->line[EXCEPTION_IRQ0 + irq] = high;
    interrupts_look_at(i, EXCEPTION_IRQ0 + irq);
    if (high)
        processor_attend(b);
}

void interrupt_nmi(struct board *b, bool high)
{
    struct interrupts *i = processor_interrupts(b);
    i->line[EXCEPTION_NMI] = high;
    interrupts_look_at(i, EXCEPTION_NMI);
    if (high)
        processor_attend(b);
}

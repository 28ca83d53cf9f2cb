/* SysTick: counts the core's cycles, or an eighth of them. Read in PM0214 Rev 10: 4.5.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "system_control.h"

static uint64_t tick_period(const struct interrupts *i)
{
    return ((uint64_t)control_word(i, SYST_RVR) + 1u) *
           ((control_word(i, SYST_CSR) & SYST_CORE) != 0 ? 1u : 8u);
}

uint64_t systick_next(const struct interrupts *i)
{
    return i->tick_next;
}

void systick_run(struct interrupts *i)
{
    while (i->tick_next <= i->board->cycles) {
        i->tick_next += tick_period(i);
        part_set(i->control, SYST_CSR, control_word(i, SYST_CSR) | SYST_COUNTED);
        if ((control_word(i, SYST_CSR) & SYST_INTERRUPT) != 0)
            interrupts_set_pending(i, EXCEPTION_SYSTICK, true);
    }
}

uint32_t systick_count(const struct interrupts *i)
{
    if (i->tick_next == BOARD_NEVER)
        return 0;
    uint64_t left = i->tick_next - i->board->cycles;
    return i->tick_next < i->board->cycles
               ? 0
               : (uint32_t)(left / ((control_word(i, SYST_CSR) & SYST_CORE) != 0 ? 1u : 8u));
}

/* A reset leaves the counter, so it is cleared before it starts, PM0214 4.5.5 (unverified). */
void systick_restart(struct interrupts *i)
{
    bool on = (control_word(i, SYST_CSR) & SYST_ENABLE) != 0 && control_word(i, SYST_RVR) != 0;
    if (on && !i->tick_cleared)
        board_verdict(i->board, "SysTick started without a write of SYST_CVR before");
    i->tick_next = on ? i->board->cycles + tick_period(i) : BOARD_NEVER;
    processor_break(i->board);
}

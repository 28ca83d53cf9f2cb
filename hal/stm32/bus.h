/* Interrupts of buses: all have the priority PRIORITY_BUS.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_STM32_BUS_H
#define REFLUX_STM32_BUS_H

#include "board.h"
#include "registers.h"

static inline void io_interrupt_on(uint32_t irq)
{
    NVIC_IPR(irq) = PRIORITY_BUS;
    NVIC_ISER(irq / 32u) = BIT(irq % 32u);
}

/* Holds the interrupts of buses off; io_release() with what this has returned. */
static inline uint32_t io_hold(void)
{
    return mask_raise(PRIORITY_BUS);
}

static inline void io_release(uint32_t before)
{
    mask_restore(before);
}

#endif

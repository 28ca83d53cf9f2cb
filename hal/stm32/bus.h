/* Interrupts and resets of buses. All their interrupts have the priority PRIORITY_BUS.
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

/* Resets a bus by its bit of a clock register. fast: that of APB2, else of APB1. What it was set to is gone. */
static inline void io_reset_bus(bool fast, uint32_t clock)
{
    volatile uint32_t *reset = fast ? &RCC_APB2RSTR : &RCC_APB1RSTR;
    *reset |= clock;
    *reset &= ~clock;
}

#endif

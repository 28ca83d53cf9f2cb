/* An image that does with the port's buses and pins what the mailbox asks for. The board clock runs in SysTick as in the firmware, above the tick
 * and below the interrupts of buses; the main loop sleeps.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdint.h>

#include "board.h"
#include "hal/clock.h"
#include "io_interrupts.h"
#include "registers.h"
#include "requests.h"

int main(void);
void nothing_asked(void);
void interrupt_systick(void);

extern uint32_t data_start[], data_end[], data_source[], bss_start[], bss_end[];

/* A fault, or an interrupt that nobody serves: the test sees that the board stands. */
void nothing_asked(void)
{
    for (;;) {
    }
}

/* The ranges of designated rows overlap on purpose. */
#pragma GCC diagnostic ignored "-Woverride-init"
__attribute__((section(".vectors"),
               used)) static const union vector vectors[16 + CHIP_INTERRUPTS] = {
    [0] = {.address = stack_top},
    [1] = {.handler = reset_entry},
    [2 ... 16 + CHIP_INTERRUPTS - 1] = {.handler = nothing_asked},
    [15] = {.handler = interrupt_systick},
    IO_VECTORS,
};

bool identity_crystal_failed(void)
{
    return false;
}

static volatile uint32_t now_ms;

uint64_t hal_clock_ms(void)
{
    return now_ms;
}

void interrupt_systick(void)
{
    now_ms = now_ms + 1u;
    analog_clock();
    pulse_clock();
    requests_clock();
}

int main(void)
{
    clock_start();
    requests_start();
    SCB_SHPR(15) = PRIORITY_CLOCK;
    SYST_RVR = hal_core_hz() / 1000u - 1u;
    SYST_CVR = 0;
    SYST_CSR = SYST_CSR_CLKSOURCE | SYST_CSR_TICKINT | SYST_CSR_ENABLE;
    for (;;) {
        __asm volatile("dsb\n\twfi" ::: "memory");
    }
}

void reset_entry(void)
{
    SCB_CPACR |= SCB_CPACR_FPU;
    __asm volatile("dsb\n\tisb" ::: "memory");
    SCB_VTOR = (uint32_t)(uintptr_t)vectors;
    __asm volatile("dsb\n\tisb" ::: "memory");
    const uint32_t *from = data_source;
    for (uint32_t *p = data_start; p < data_end; p++) {
        *p = *from++;
    }
    for (uint32_t *p = bss_start; p < bss_end; p++) {
        *p = 0;
    }
    main();
    for (;;) {
    }
}

/* Vector table and the way from reset to main(). */
#include <stdint.h>
#include <string.h>

#include "board.h"
#include "hal/memory_use.h"
#include "registers.h"
#include "vectors.h"

/* Written into the stack at start; what still holds it later was never used. */
#define STACK_PAINT 0x5AC35AC3u

extern uint32_t data_start[], data_end[], data_source[], bss_start[], bss_end[];

int main(void);
void STARTUP(void); /* after a reset, or after what a chip does before */
void interrupt_unexpected(void);
void interrupt_systick(void);
void interrupt_pendsv(void);
void interrupt_usart1(void);
void interrupt_usart2(void);

/* Survives the clearing of .bss: it is gathered before. */
__attribute__((section(".noinit"))) uint32_t startup_noise;

#define VECTOR_COUNT (16 + CHIP_INTERRUPTS)

__attribute__((section(".vectors"), used)) static const union vector vectors[VECTOR_COUNT] = {
    [0] = {.address = stack_top},
    [1] = {.handler = reset_entry},
    [2] = {.handler = fault_entry}, /* NMI: the clock security system */
    [3] = {.handler = fault_entry}, /* HardFault */
    [4] = {.handler = fault_entry}, /* MemManage */
    [5] = {.handler = fault_entry}, /* BusFault */
    [6] = {.handler = fault_entry}, /* UsageFault */
    [11] = {.handler = interrupt_unexpected},
    [12] = {.handler = interrupt_unexpected},
    [14] = {.handler = interrupt_pendsv},
    [15] = {.handler = interrupt_systick},
    PORT_VECTORS,
};

/* The stack pointer of a fault may be the very thing that is wrong (a stack that ran out of its area at the
 * bottom of the memory), so the handler goes on with a fresh one: it does not return anyway. */
__attribute__((naked)) void fault_entry(void)
{
    __asm volatile("mov r1, lr\n\t"
                   "mrs r0, msp\n\t"
                   "ldr r2, =stack_top\n\t"
                   "msr msp, r2\n\t"
                   "b identity_fault");
}

/* An interrupt nobody asked for is a fault like any other: recorded, then a fresh start. */
__attribute__((naked)) void interrupt_unexpected(void)
{
    __asm volatile("b fault_entry");
}

static void paint_stack(void)
{
    uint32_t *here, noise = STARTUP_NOISE;
    __asm volatile("mov %0, sp" : "=r"(here));
    /* At power-on the memory holds nearly random bits: they tell one start from another. */
    for (uint32_t *p = stack_bottom; p < here - 8; p++) {
        noise = (noise ^ *p) * 16777619u;
        *p = STACK_PAINT;
    }
    startup_noise = noise;
}

uint32_t hal_stack_size(void)
{
    return (uint32_t)((const char *)stack_top - (const char *)stack_bottom);
}

uint32_t hal_stack_unused(void)
{
    const volatile uint32_t *p = stack_bottom;
    while (p < stack_top && *p == STACK_PAINT) {
        p++;
    }
    return (uint32_t)((uintptr_t)p - (uintptr_t)stack_bottom);
}

void STARTUP(void)
{
#ifdef __ARM_FP
    SCB_CPACR |= SCB_CPACR_FPU; /* before the first floating-point instruction */
#endif
    /* The emulator starts a raw image at address 0, the chip's alias of the flash: use the real one. */
    SCB_VTOR = (uint32_t)(uintptr_t)vectors;
    SCB_SHCSR |= SCB_SHCSR_FAULTS;
    SCB_CCR |= SCB_CCR_DIV_0_TRP | SCB_CCR_STKALIGN;
    __asm volatile("dsb\n\tisb" ::: "memory");

    paint_stack();
    memcpy(data_start, data_source, (size_t)((char *)data_end - (char *)data_start));
    memset(bss_start, 0, (size_t)((char *)bss_end - (char *)bss_start));
    main();
    for (;;) {
    }
}

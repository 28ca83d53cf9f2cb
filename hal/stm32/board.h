/* Declarations that the files of an STM32 port share; those in hal/stm32/ are common to all of them. */
#ifndef REFLUX_STM32_BOARD_H
#define REFLUX_STM32_BOARD_H

#include <stdbool.h>
#include <stdint.h>

/* Interrupt priorities: the upper four bits count, a smaller number goes first. */
#define PRIORITY_UART  0x40u
#define PRIORITY_BUS   0x60u /* SPI, I2C, 1-wire, converter, pulses */
#define PRIORITY_CLOCK 0x80u
#define PRIORITY_TICK  0xF0u /* PendSV: below every interrupt, above the main loop */

/* startup.c */
extern uint32_t stack_bottom[], stack_top[]; /* from the linker script */
extern uint32_t startup_noise; /* what the uninitialised stack held at power-on, mixed */
union vector {
    void (*handler)(void);
    const void *address;
};
void reset_entry(void);
void fault_entry(void); /* any fault: recorded, then a fresh start */

/* clock.c, each port's own: once, first of all. */
void clock_start(void);
bool clock_is_model(void); /* runs in the emulator: recognised by RCC_CR reading 0 */
uint32_t clock_apb1_hz(void);
uint32_t clock_apb2_hz(void);

/* supply.c: the voltage detector; after clock_start(). A flash write below its level could be half a one. */
void supply_start(void);
bool supply_is_low(void);

/* guard.c: what reaches through a null pointer is a fault, not the vector table. */
void guard_start(void);

/* pins.c, each port's own: clocks and pins of the two serial ports; the watchdog stops with a halted core in a debug build,
 * and in no other. */
void pins_start(void);
void pins_freeze_watchdog(void);

/* tick.c */
void tick_start_timebase(void);
void tick_start(void);     /* from now on hal_tick_request() is obeyed */
void tick_work_seen(void); /* from interrupts: the main loop has something to look at */

/* uart.c */
void uart_start(void);

/* Code that runs from the SRAM, where an erase of the flash does not stop it. It may neither call what lies in the flash nor read there.
 * The name keeps functions apart, so that an image leaves out those that it does not call. */
#define RAM_CODE(name) __attribute__((section(".ram_code." name), noinline))

/* RAM code is farther from the flash than a branch reaches. */
#ifdef __arm__
#define CALLED_FROM_FLASH __attribute__((long_call))
#else
#define CALLED_FROM_FLASH
#endif

/* With interrupts held off, before and after an erase: only a byte from the plant link may wake the processor meanwhile. */
void uart_hold_interrupts(bool hold);
/* From RAM code with interrupts held off: takes a byte from the plant link's line, and gives it one: the next of those that wait,
 * or *more. Returns true if it took that one. more: NULL, or a byte in RAM. */
bool uart_serve_link(const uint8_t *more);

/* analog.c and pulse.c, where the board has them: once a millisecond, from the board clock. */
void analog_clock(void);
void pulse_clock(void);

/* identity.c: after clock_start(). */
void identity_start(void);
/* Before identity_start(): the crystal has failed since power-on (the clock security system saw it). */
bool identity_crystal_failed(void);
_Noreturn void identity_fault(const uint32_t *frame, uint32_t exc_return);

/* Raises BASEPRI to hold off everything of this priority and below; returns the mask to restore. */
static inline uint32_t mask_raise(uint32_t priority)
{
    uint32_t before;
    __asm volatile("mrs %0, basepri" : "=r"(before));
    __asm volatile("msr basepri_max, %0\n\tisb" : : "r"(priority) : "memory");
    return before;
}

static inline void mask_restore(uint32_t before)
{
    __asm volatile("msr basepri, %0\n\tisb" : : "r"(before) : "memory");
}

#endif

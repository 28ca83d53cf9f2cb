/* STM32F100xB. Read in RM0041 Rev 6: table 15 enables, 8.1 and table 50 interrupts, 6.2.2 and 6.2.5 oscillators, 25.6.3 core. Addresses: the
 * vendor's SVD file. The chip has 128 KiB of flash and 8 KiB of SRAM (unverified). CPUID of the Cortex-M3 r1p1 is 0x411FC231 (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <unicorn/unicorn.h>

#include "models/models.h"

#define APB2ENR 0x18
#define APB1ENR 0x1C
#define NO_IRQ  0xFF

static const struct chip_memory memory[] = {
    {MEMORY_FLASH, 0x08000000u, 0x20000u}, /* 128 KiB */
    {MEMORY_RAM, 0x20000000u, 0x2000u},    /* 8 KiB */
};

static const struct chip_part parts[] = {
    {"SCS", &system_control_class, 0xE000E000u, 0x1000, "core", 0, 0, NO_IRQ, 0},
    {"DWT", &trace_class, 0xE0001000u, 0x1000, "core", 0, 0, NO_IRQ, 0},
    {"RCC", &rcc_f1_class, 0x40021000u, 0x400, "ahb", 0, 0, NO_IRQ, 0},
    {"STORED", &stored_flash_class, 0, 0, "ahb", 0, 0, NO_IRQ, 0},
    {"FLASH", &flash_f1_class, 0x40022000u, 0x400, "ahb", 0, 0, NO_IRQ, 0},
    {"PWR", &power_f1_class, 0x40007000u, 0x400, "apb1", APB1ENR, 28, NO_IRQ, 0},
    {"RTC", &rtc_f1_class, 0x40002800u, 0x400, "apb1", APB1ENR, 27, NO_IRQ, 0}, /* BKPEN */
    {"IWDG", &watchdog_class, 0x40003000u, 0x400, "apb1", 0, 0, NO_IRQ, 0},
    {"USART1", &usart_class, 0x40013800u, 0x400, "apb2", APB2ENR, 14, 37, 0},
    {"USART2", &usart_class, 0x40004400u, 0x400, "apb1", APB1ENR, 17, 38, 1},
    {"GPIOA", &gpio_f1_class, 0x40010800u, 0x400, "apb2", APB2ENR, 2, NO_IRQ, 0},
    {"GPIOB", &gpio_f1_class, 0x40010C00u, 0x400, "apb2", APB2ENR, 3, NO_IRQ, 1},
    {"GPIOC", &gpio_f1_class, 0x40011000u, 0x400, "apb2", APB2ENR, 4, NO_IRQ, 2},
    {"SPI1", &spi_f1_class, 0x40013000u, 0x400, "apb2", APB2ENR, 12, 35, 1},
    {"SPI2", &spi_f1_class, 0x40003800u, 0x400, "apb1", APB1ENR, 14, 36, 2},
    {"USART3", &wire_f1_class, 0x40004800u, 0x400, "apb1", APB1ENR, 18, 39, 1},
    {"DBGMCU", &debug_f1_class, 0xE0042000u, 0x400, "core", 0, 0, NO_IRQ, 0},
};

/* After a reset of the Cortex-M3 r1p1, exceptions do not align the stack to 8 bytes (unverified). A firmware that wants it sets CCR_STKALIGN.
 * This core has no protection unit (unverified). */
const struct chip chip_stm32f100 = {
    .name = "STM32F100",
    .cpu_model = UC_CPU_ARM_CORTEX_M3,
    .fpu = false,
    .cpuid = 0x411FC231u,
    .mpu_regions = 0,
    .ccr_reset = 0,
    .priority_bits = 4,
    .interrupts = 56, /* 8.1, medium density */
    .internal_hz = 8000000u,
    .slow_clock_hz = 40000u, /* 6.2.5; RM0008 Rev 12 19.3.3 has 30 to 60 kHz for its sisters */
    .slow_clock_least = 30000u,
    .slow_clock_most = 60000u,
    .memory = memory,
    .n_memory = sizeof(memory) / sizeof(memory[0]),
    .stored_base = 0x0801E000u,
    .stored_size = 0x2000u,
    .flash_control = 0x40022010u,
    .store = flash_f1_store,
    .clocks = &clocks_f1,
    .pin_function = pin_function_f1,
    .pins = &pins_f1,
    .usart_function = 0,
    .parts = parts,
    .n_parts = sizeof(parts) / sizeof(parts[0]),
};

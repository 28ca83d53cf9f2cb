/* STM32F405xG. Read in RM0090 Rev 21: 2.1 and 2.3 memories and addresses, 12.1 and table 62 interrupts, 7.2.2 and 7.2.5 oscillators; in PM0214
 * Rev 10: 4.2.10 regions, 4.4.7 CCR. Enables: the vendor's SVD file. The core is revision r0p1 (RM0090 38.8.3). Its CPUID is 0x410FC241
 * (unverified). The flash has 1 MiB (unverified). Serial ports are the alternate function 7 of their pins (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <unicorn/unicorn.h>

#include "models/models.h"

#define AHB1ENR 0x30
#define APB1ENR 0x40
#define APB2ENR 0x44
#define NO_IRQ  0xFF

static const struct chip_memory memory[] = {
    {MEMORY_FLASH, 0x08000000u, 0x100000u}, /* 1 MiB */
    {MEMORY_RAM, 0x20000000u, 0x20000u},    /* 112 KiB and 16 KiB */
    {MEMORY_CORE_RAM, 0x10000000u, 0x10000u},
};

static const struct chip_part parts[] = {
    {"SCS", &system_control_class, 0xE000E000u, 0x1000, "core", 0, 0, NO_IRQ, 0},
    {"DWT", &trace_class, 0xE0001000u, 0x1000, "core", 0, 0, NO_IRQ, 0},
    {"RCC", &rcc_f4_class, 0x40023800u, 0x400, "ahb1", 0, 0, NO_IRQ, 0},
    {"STORED", &stored_flash_class, 0, 0, "ahb1", 0, 0, NO_IRQ, 0},
    {"FLASH", &flash_f4_class, 0x40023C00u, 0x400, "ahb1", 0, 0, NO_IRQ, 0},
    {"PWR", &power_f4_class, 0x40007000u, 0x400, "apb1", APB1ENR, 28, NO_IRQ, 0},
    {"IWDG", &watchdog_class, 0x40003000u, 0x400, "apb1", 0, 0, NO_IRQ, 0},
    {"USART1", &usart_class, 0x40011000u, 0x400, "apb2", APB2ENR, 4, 37, 0},
    {"USART2", &usart_class, 0x40004400u, 0x400, "apb1", APB1ENR, 17, 38, 1},
    {"GPIOA", &gpio_f4_class, 0x40020000u, 0x400, "ahb1", AHB1ENR, 0, NO_IRQ, 0},
    {"GPIOB", &gpio_f4_class, 0x40020400u, 0x400, "ahb1", AHB1ENR, 1, NO_IRQ, 1},
    {"GPIOC", &gpio_f4_class, 0x40020800u, 0x400, "ahb1", AHB1ENR, 2, NO_IRQ, 2},
    {"GPIOD", &gpio_f4_class, 0x40020C00u, 0x400, "ahb1", AHB1ENR, 3, NO_IRQ, 3},
    {"SPI1", &spi_class, 0x40013000u, 0x400, "apb2", APB2ENR, 12, 35, 1},
    {"SPI2", &spi_class, 0x40003800u, 0x400, "apb1", APB1ENR, 14, 36, 2},
    {"SPI3", &spi_class, 0x40003C00u, 0x400, "apb1", APB1ENR, 15, 51, 3},
    {"I2C1", &i2c_class, 0x40005400u, 0x400, "apb1", APB1ENR, 21, 31, 1},
    {"I2C2", &i2c_class, 0x40005800u, 0x400, "apb1", APB1ENR, 22, 33, 2},
    {"USART6", &wire_class, 0x40011400u, 0x400, "apb2", APB2ENR, 5, 71, 1},
    {"UART4", &wire_class, 0x40004C00u, 0x400, "apb1", APB1ENR, 19, 52, 2},
    {"TIM2", &timer32_class, 0x40000000u, 0x400, "apb1", APB1ENR, 0, NO_IRQ, 0},
    {"TIM11", &timer_capture_class, 0x40014800u, 0x400, "apb2", APB2ENR, 18, NO_IRQ, 0},
    {"TIM3", &pwm_class, 0x40000400u, 0x400, "apb1", APB1ENR, 1, NO_IRQ, 3},
    {"TIM4", &pwm_class, 0x40000800u, 0x400, "apb1", APB1ENR, 2, NO_IRQ, 4},
    {"TIM5", &pwm32_class, 0x40000C00u, 0x400, "apb1", APB1ENR, 3, NO_IRQ, 5},
    {"TIM12", &pwm_class, 0x40001800u, 0x400, "apb1", APB1ENR, 6, NO_IRQ, 12},
    {"SYSCFG", &syscfg_class, 0x40013800u, 0x400, "apb2", APB2ENR, 14, NO_IRQ, 0},
    {"EXTI", &exti_class, 0x40013C00u, 0x400, "apb2", 0, 0, NO_IRQ, 0},
    {"ADC1", &adc_class, 0x40012000u, 0x100, "apb2", APB2ENR, 8, 18, 1},
    {"ADC", &adc_common_class, 0x40012300u, 0x100, "apb2", APB2ENR, 8, NO_IRQ, 0},
    {"FACTORY", &factory_class, 0x1FFF7A00u, 0x40, "core", 0, 0, NO_IRQ, 0},
    {"DBGMCU", &debug_f4_class, 0xE0042000u, 0x400, "core", 0, 0, NO_IRQ, 0},
};

const struct chip chip_stm32f405 = {
    .name = "STM32F405",
    .cpu_model = UC_CPU_ARM_CORTEX_M4,
    .fpu = true,
    .cpuid = 0x410FC241u,
    .mpu_regions = 8,
    .ccr_reset = 0x200u,
    .priority_bits = 4,
    .interrupts = 82,
    .internal_hz = 16000000u,
    .slow_clock_hz = 32000u, /* 17 to 47 kHz over chips: DS8626 table 35 as others quote it */
    .slow_clock_least = 17000u,
    .slow_clock_most = 47000u,
    .memory = memory,
    .n_memory = sizeof(memory) / sizeof(memory[0]),
    .stored_base = 0x080C0000u,
    .stored_size = 0x40000u,
    .factory_base = 0x1FFF7000u,
    .flash_cache = 0x40023C00u,
    .flash_control = 0x40023C10u,
    .store = flash_f4_store,
    .clocks = &clocks_f4,
    .pin_function = pin_function_f4,
    .pins = &pins_f4,
    .usart_function = 7,
    .parts = parts,
    .n_parts = sizeof(parts) / sizeof(parts[0]),
};

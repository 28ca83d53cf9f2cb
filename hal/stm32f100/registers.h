/* The registers of the STM32F100 that this port uses beyond those in stm32/common.h, under the names of the
 * reference manual (RM0041).
 */
#ifndef REFLUX_STM32F100_REGISTERS_H
#define REFLUX_STM32F100_REGISTERS_H

#include "common.h"

#define CHIP_INTERRUPTS 56 /* RM0041 8.1: medium density */

#define STARTUP       reset_entry
#define STARTUP_NOISE 2166136261u

/* RM0041 6.3: reset and clock control */
#define RCC_CR             REG32(0x40021000u)
#define RCC_CR_HSEON       BIT(16)
#define RCC_CR_HSERDY      BIT(17)
#define RCC_CR_PLLON       BIT(24)
#define RCC_CR_PLLRDY      BIT(25)
#define RCC_CIR            REG32(0x40021008u)
#define RCC_CFGR           REG32(0x40021004u)
#define RCC_CFGR_SW        3u
#define RCC_CFGR_SW_PLL    2u
#define RCC_CFGR_SWS       (3u << 2)
#define RCC_CFGR_SWS_PLL   (2u << 2)
#define RCC_CFGR_PLLSRC    BIT(16) /* the crystal; else half the internal oscillator */
#define RCC_CFGR_PLLMUL(n) (((n)-2u) << 18)
#define RCC_APB2RSTR       REG32(0x4002100Cu)
#define RCC_APB1RSTR       REG32(0x40021010u)
#define RCC_APB2ENR        REG32(0x40021018u)
#define RCC_APB2ENR_IOPA   BIT(2)
#define RCC_APB2ENR_IO(n)  BIT(2u + (n)) /* n: 0 for GPIOA */
#define RCC_APB2ENR_USART1 BIT(14)
#define RCC_APB1ENR        REG32(0x4002101Cu)
#define RCC_APB1ENR_USART2 BIT(17)
#define RCC_APB1ENR_BKP    BIT(27)
#define RCC_BDCR           REG32(0x40021020u)
#define RCC_BDCR_HSE_RTC   (3u << 8) /* the crystal's 128th */
#define RCC_BDCR_RTCEN     BIT(15)
#define RCC_BDCR_BDRST     BIT(16)
#define RCC_CSR            REG32(0x40021024u)
#define RCC_CFGR2          REG32(0x4002102Cu)

/* RM0041 4.4.1: 2.4 V; the flash takes writes from 2.0 V on */
#define PWR_CR_PLS_CHOSEN (2u << 5)

/* RM0041 17.4: real-time clock, which measures the crystal */
#define RTC_CRL     REG16(0x40002804u)
#define RTC_CRL_RSF BIT(3)
#define RTC_DIVL    REG16(0x40002814u) /* counts down */

/* PM0063 3: flash interface */
#define FLASH_KEYR      REG32(0x40022004u)
#define FLASH_KEY1      0x45670123u
#define FLASH_KEY2      0xCDEF89ABu
#define FLASH_SR        REG32(0x4002200Cu)
#define FLASH_SR_BSY    BIT(0)
#define FLASH_SR_ERRORS (BIT(2) | BIT(4)) /* PGERR WRPRTERR, cleared by writing one */
#define FLASH_SR_EOP    BIT(5)
#define FLASH_CR        REG32(0x40022010u)
#define FLASH_CR_PG     BIT(0)
#define FLASH_CR_PER    BIT(1)
#define FLASH_CR_STRT   BIT(6)
#define FLASH_CR_LOCK   BIT(7)
#define FLASH_AR        REG32(0x40022014u)

/* RM0041 7.2: general-purpose pins */
#define GPIOA_CRL  REG32(0x40010800u)
#define GPIOA_CRH  REG32(0x40010804u)
#define GPIOA_BSRR REG32(0x40010810u)

/* Each port; n: 0 for GPIOA; high: 0 for pins 0 to 7, 1 for the others */
#define GPIO_BASE(n)     (0x40010800u + 0x400u * (n))
#define GPIO_CR(n, high) REG32(GPIO_BASE(n) + 4u * (high))
#define GPIO_IDR(n)      REG32(GPIO_BASE(n) + 0x08u)
#define GPIO_BSRR(n)     REG32(GPIO_BASE(n) + 0x10u)

/* RM0041 2.3: serial ports */
#define USART1_BASE 0x40013800u
#define USART2_BASE 0x40004400u
#define USART3_BASE 0x40004800u

/* RM0041 25.15: a halted core also halts the watchdog */
#define DBGMCU_CR           REG32(0xE0042004u)
#define DBGMCU_CR_IWDG_STOP BIT(8)

#define LSI_PER_MS 40u /* RM0041 6.2.5; 30 to 60 kHz in RM0008 19.3.3, of its sisters */

#endif

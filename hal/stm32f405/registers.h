/* The registers of the STM32F405 that this port uses beyond those in stm32/common.h, under the names of the
 * reference manual (RM0090).
 */
#ifndef REFLUX_STM32F405_REGISTERS_H
#define REFLUX_STM32F405_REGISTERS_H

#include "common.h"

#define CHIP_INTERRUPTS 82 /* RM0090 table 62 */

/* reset_entry() is in ram_test.c, and has mixed noise from all of the stack. */
#define STARTUP       startup
#define STARTUP_NOISE startup_noise

/* RM0090 7.3: reset and clock control */
#define RCC_CR              REG32(0x40023800u)
#define RCC_CR_HSION        BIT(0)
#define RCC_CR_HSIRDY       BIT(1)
#define RCC_CR_HSEON        BIT(16)
#define RCC_CR_HSERDY       BIT(17)
#define RCC_CR_PLLON        BIT(24)
#define RCC_CR_PLLRDY       BIT(25)
#define RCC_PLLCFGR         REG32(0x40023804u)
#define RCC_PLLCFGR_HSE     BIT(22)
#define RCC_PLLCFGR_KEPT    BIT(29) /* reserved, set out of reset, to be left so (7.3.2) */
#define RCC_CFGR            REG32(0x40023808u)
#define RCC_CFGR_SW_PLL     2u
#define RCC_CFGR_SWS        (3u << 2)
#define RCC_CFGR_SWS_PLL    (2u << 2)
#define RCC_CFGR_PPRE1_4    (5u << 10)
#define RCC_CFGR_PPRE2_2    (4u << 13)
#define RCC_CFGR_RTCPRE(n)  ((uint32_t)(n) << 16)
#define RCC_CIR             REG32(0x4002380Cu)
#define RCC_APB1RSTR        REG32(0x40023820u)
#define RCC_APB2RSTR        REG32(0x40023824u)
#define RCC_AHB1ENR_ADDRESS 0x40023830u /* ram_test.c reaches these without a stack */
#define RCC_AHB1ENR         REG32(RCC_AHB1ENR_ADDRESS)
#define RCC_AHB1ENR_GPIOA   BIT(0)
#define RCC_AHB1ENR_GPIO(n) BIT(n) /* 0: GPIOA */
#define RCC_AHB1ENR_CCM     BIT(20)
#define RCC_APB1ENR         REG32(0x40023840u)
#define RCC_APB1ENR_TIM2    BIT(0)
#define RCC_APB1ENR_USART2  BIT(17)
#define RCC_APB2ENR         REG32(0x40023844u)
#define RCC_APB2ENR_USART1  BIT(4)
#define RCC_APB2ENR_ADC1    BIT(8)
#define RCC_APB2ENR_SYSCFG  BIT(14)
#define RCC_APB2ENR_TIM11   BIT(18)
#define RCC_CSR_ADDRESS     0x40023874u
#define RCC_CSR             REG32(RCC_CSR_ADDRESS)
#define CCM_START           0x10000000u

/* RM0090 5.4.1: power */
#define PWR_CR_VOS BIT(14) /* scale 1: needed above 144 MHz */
/* 2.8 V, which is 2.85 V to 3.10 V over chips and directions (DS8626): above the 2.7 V that words need in the flash, below
 * a supply of 3.3 V less 5 %. */
#define PWR_CR_PLS_CHOSEN (6u << 5)

/* RM0090 3.9: flash interface */
#define FLASH_ACR          REG32(0x40023C00u)
#define FLASH_ACR_PRFTEN   BIT(8)
#define FLASH_ACR_ICEN     BIT(9)
#define FLASH_ACR_DCEN     BIT(10)
#define FLASH_ACR_ICRST    BIT(11)
#define FLASH_ACR_DCRST    BIT(12)
#define FLASH_KEYR         REG32(0x40023C04u)
#define FLASH_KEY1         0x45670123u
#define FLASH_KEY2         0xCDEF89ABu
#define FLASH_SR           REG32(0x40023C0Cu)
#define FLASH_SR_ERRORS    0xF2u /* PGSERR PGPERR PGAERR WRPERR OPERR, cleared by writing one */
#define FLASH_SR_BSY       BIT(16)
#define FLASH_CR           REG32(0x40023C10u)
#define FLASH_CR_PG        BIT(0)
#define FLASH_CR_SER       BIT(1)
#define FLASH_CR_SNB(n)    ((uint32_t)(n) << 3)
#define FLASH_CR_PSIZE32   (2u << 8)
#define FLASH_CR_STRT      BIT(16)
#define FLASH_CR_LOCK      BIT(31)
#define FLASH_OPTCR        REG32(0x40023C14u)
#define FLASH_OPTCR_BOR    (3u << 2) /* 0 level 3, which is 2.7 V and more; 1, 2: less; 3 off */
#define FLASH_OPTCR_WDG_SW BIT(5)    /* 0: the watchdog runs from a reset on */
#define FLASH_OPTCR_NWRP   16u       /* from this bit on: one of each sector; 0: write-protected */

/* RM0090 8.4: general-purpose pins */
#define GPIOA_MODER REG32(0x40020000u)
#define GPIOA_PUPDR REG32(0x4002000Cu)
#define GPIOA_AFRL  REG32(0x40020020u)
#define GPIOA_AFRH  REG32(0x40020024u)

/* Each port; n: 0 for GPIOA */
#define GPIO_BASE(n)      (0x40020000u + 0x400u * (n))
#define GPIO_MODER(n)     REG32(GPIO_BASE(n) + 0x00u)
#define GPIO_OTYPER(n)    REG32(GPIO_BASE(n) + 0x04u)
#define GPIO_OSPEEDR(n)   REG32(GPIO_BASE(n) + 0x08u)
#define GPIO_PUPDR(n)     REG32(GPIO_BASE(n) + 0x0Cu)
#define GPIO_IDR(n)       REG32(GPIO_BASE(n) + 0x10u)
#define GPIO_BSRR(n)      REG32(GPIO_BASE(n) + 0x18u)
#define GPIO_AFR(n, high) REG32(GPIO_BASE(n) + 0x20u + 4u * (high))

/* I2C (RM0090 27.6). Where the bits stand is from memory (unverified). */
#define I2C_CR1(base)   REG32((base) + 0x00u)
#define I2C_CR2(base)   REG32((base) + 0x04u)
#define I2C_DR(base)    REG32((base) + 0x10u)
#define I2C_SR1(base)   REG32((base) + 0x14u)
#define I2C_SR2(base)   REG32((base) + 0x18u)
#define I2C_CCR(base)   REG32((base) + 0x1Cu)
#define I2C_TRISE(base) REG32((base) + 0x20u)
#define I2C_CR1_PE      BIT(0)
#define I2C_CR1_START   BIT(8)
#define I2C_CR1_STOP    BIT(9)
#define I2C_CR1_ACK     BIT(10)
#define I2C_CR1_POS     BIT(11)
#define I2C_CR1_SWRST   BIT(15)
#define I2C_CR2_ITERREN BIT(8)
#define I2C_CR2_ITEVTEN BIT(9)
#define I2C_CR2_ITBUFEN BIT(10)
#define I2C_SR1_SB      BIT(0)
#define I2C_SR1_ADDR    BIT(1)
#define I2C_SR1_BTF     BIT(2)
#define I2C_SR1_RXNE    BIT(6)
#define I2C_SR1_BERR    BIT(8)
#define I2C_SR1_ARLO    BIT(9)
#define I2C_SR1_AF      BIT(10)
#define I2C_SR1_ERRORS  0xDF00u
#define I2C_SR2_BUSY    BIT(1)

/* RM0090 30.6: serial ports */
#define USART1_BASE 0x40011000u
#define USART2_BASE 0x40004400u
#define USART6_BASE 0x40011400u
#define UART4_BASE  0x40004C00u
/* RM0090 18.4, 19.5: TIM2 counts for hal_cycles() on the emulator, TIM11 measures the crystal */
#define TIM2_CR1 REG32(0x40000000u)
#define TIM2_EGR REG32(0x40000014u)
#define TIM2_CNT REG32(0x40000024u)
#define TIM2_PSC REG32(0x40000028u)
#define TIM2_ARR REG32(0x4000002Cu)
/* RM0090 18.4: TIM3, TIM4, TIM5, TIM12; where the bits of the channels stand is from memory (unverified). */
#define TIM_CR1(base)     REG32((base) + 0x00u)
#define TIM_EGR(base)     REG32((base) + 0x14u)
#define TIM_CCMR(base, n) REG32((base) + 0x18u + 4u * (n))
#define TIM_CCER(base)    REG32((base) + 0x20u)
#define TIM_PSC(base)     REG32((base) + 0x28u)
#define TIM_ARR(base)     REG32((base) + 0x2Cu)
#define TIM_CCR(base, n)  REG32((base) + 0x34u + 4u * (n)) /* n: channel, from 0 */
#define TIM_CCMR_PWM1     0x60u
#define TIM_CCER_E        1u
#define TIM_CCER_P        2u
#define TIM_CR1_CEN       BIT(0)
#define TIM_EGR_UG        BIT(0)
#define TIM11_CR1         REG32(0x40014800u)
#define TIM11_SR          REG32(0x40014810u)
#define TIM11_SR_CC1IF    BIT(1)
#define TIM11_CCMR1       REG32(0x40014818u)
#define TIM11_CCMR1_TI1_8 (1u | (3u << 2)) /* capture channel 1 from TI1, one capture in 8 edges */
#define TIM11_CCER        REG32(0x40014820u)
#define TIM11_CCER_CC1E   BIT(0)
#define TIM11_PSC         REG32(0x40014828u)
#define TIM11_ARR         REG32(0x4001482Cu)
#define TIM11_CCR1        REG32(0x40014834u)
#define TIM11_OR          REG32(0x40014850u)
#define TIM11_OR_HSE_RTC  2u

/* Interrupts of pins (RM0090 9.2 and 12.3). Where the bits stand is from memory (unverified). */
#define SYSCFG_EXTICR(n) REG32(0x40013808u + 4u * (n))
#define EXTI_IMR         REG32(0x40013C00u)
#define EXTI_FTSR        REG32(0x40013C0Cu)
#define EXTI_PR          REG32(0x40013C14u)

/* Converter (RM0090 13.13). Where the bits stand is from memory (unverified). */
#define ADC1_SR         REG32(0x40012000u)
#define ADC1_CR1        REG32(0x40012004u)
#define ADC1_CR2        REG32(0x40012008u)
#define ADC1_SMPR1      REG32(0x4001200Cu)
#define ADC1_SMPR2      REG32(0x40012010u)
#define ADC1_SQR1       REG32(0x4001202Cu)
#define ADC1_SQR2       REG32(0x40012030u)
#define ADC1_SQR3       REG32(0x40012034u)
#define ADC1_DR         REG32(0x4001204Cu)
#define ADC_CCR         REG32(0x40012304u)
#define ADC_SR_EOC      BIT(1)
#define ADC_SR_OVR      BIT(5)
#define ADC_SR_ALL      0x3Fu
#define ADC_CR1_EOCIE   BIT(5)
#define ADC_CR1_SCAN    BIT(8)
#define ADC_CR1_OVRIE   BIT(26)
#define ADC_CR2_ADON    BIT(0)
#define ADC_CR2_EOCS    BIT(10)
#define ADC_CR2_SWSTART BIT(30)
#define ADC_CCR_DIV4    BIT(16)
#define ADC_CCR_TSVREFE BIT(23)
#define VREFIN_CAL      REG16(0x1FFF7A2Au) /* code of the chip's reference at 3.3 V */

/* RM0090 38.6.1: which chip; revision A tells a wrong one (errata sheet ES0182) */
#define DBGMCU_IDCODE     REG32(0xE0042000u)
#define DBGMCU_IDCODE_DEV 0xFFFu
#define DBGMCU_IDCODE_REV 0xFFFF0000u
#define DEV_F405          0x413u
#define REV_A             0x10000000u

/* RM0090 38.16: a halted core also halts the watchdog */
#define DBGMCU_APB1_FZ      REG32(0xE0042008u)
#define DBGMCU_APB1_FZ_IWDG BIT(12)

/* PM0214 4.6: floating-point unit */
#define SCB_CPACR     REG32(0xE000ED88u)
#define SCB_CPACR_FPU (15u << 20)

#define LSI_PER_MS 32u /* RM0090 7.2.5; DS8626: 17 to 47 kHz over chips and temperature */

#endif

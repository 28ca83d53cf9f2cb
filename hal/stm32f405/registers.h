/* The registers this port uses, under the names of the reference manual (RM0090 for the STM32F405) and of the
 * Cortex-M4 programming manual (PM0214). No vendor header is packaged for C by the distribution, and these are
 * all that is needed.
 */
#ifndef REFLUX_STM32F405_REGISTERS_H
#define REFLUX_STM32F405_REGISTERS_H

#include <stdint.h>

#define REG32(address) (*(volatile uint32_t *)(address))
#define REG16(address) (*(volatile uint16_t *)(address))
#define REG8(address)  (*(volatile uint8_t *)(address))
#define BIT(n)         (UINT32_C(1) << (n))

/* RM0090 7.3: reset and clock control */
#define RCC_CR             REG32(0x40023800u)
#define RCC_CR_HSION       BIT(0)
#define RCC_CR_HSIRDY      BIT(1)
#define RCC_CR_HSEON       BIT(16)
#define RCC_CR_HSERDY      BIT(17)
#define RCC_CR_PLLON       BIT(24)
#define RCC_CR_PLLRDY      BIT(25)
#define RCC_PLLCFGR        REG32(0x40023804u)
#define RCC_PLLCFGR_HSE    BIT(22)
#define RCC_CFGR           REG32(0x40023808u)
#define RCC_CFGR_SW_PLL    2u
#define RCC_CFGR_SWS       (3u << 2)
#define RCC_CFGR_SWS_PLL   (2u << 2)
#define RCC_CFGR_PPRE1_4   (5u << 10)
#define RCC_CFGR_PPRE2_2   (4u << 13)
#define RCC_CFGR_RTCPRE(n) ((uint32_t)(n) << 16)
#define RCC_AHB1ENR        REG32(0x40023830u)
#define RCC_AHB1ENR_GPIOA  BIT(0)
#define RCC_APB1ENR        REG32(0x40023840u)
#define RCC_APB1ENR_TIM2   BIT(0)
#define RCC_APB1ENR_USART2 BIT(17)
#define RCC_APB1ENR_PWR    BIT(28)
#define RCC_APB2ENR        REG32(0x40023844u)
#define RCC_APB2ENR_USART1 BIT(4)
#define RCC_APB2ENR_TIM11  BIT(18)
#define RCC_CSR            REG32(0x40023874u)
#define RCC_CSR_RMVF       BIT(24)
#define RCC_CSR_BORRST     BIT(25)
#define RCC_CSR_PINRST     BIT(26)
#define RCC_CSR_PORRST     BIT(27)
#define RCC_CSR_SFTRST     BIT(28)
#define RCC_CSR_IWDGRST    BIT(29)
#define RCC_CSR_WWDGRST    BIT(30)
#define RCC_CSR_LPWRRST    BIT(31)

/* RM0090 5.4: power */
#define PWR_CR     REG32(0x40007000u)
#define PWR_CR_VOS BIT(14) /* scale 1: needed above 144 MHz */

/* RM0090 3.9: flash interface */
#define FLASH_ACR        REG32(0x40023C00u)
#define FLASH_ACR_PRFTEN BIT(8)
#define FLASH_ACR_ICEN   BIT(9)
#define FLASH_ACR_DCEN   BIT(10)
#define FLASH_ACR_ICRST  BIT(11)
#define FLASH_ACR_DCRST  BIT(12)
#define FLASH_KEYR       REG32(0x40023C04u)
#define FLASH_KEY1       0x45670123u
#define FLASH_KEY2       0xCDEF89ABu
#define FLASH_SR         REG32(0x40023C0Cu)
#define FLASH_SR_ERRORS  0xF2u /* PGSERR PGPERR PGAERR WRPERR OPERR, cleared by writing one */
#define FLASH_SR_BSY     BIT(16)
#define FLASH_CR         REG32(0x40023C10u)
#define FLASH_CR_PG      BIT(0)
#define FLASH_CR_SER     BIT(1)
#define FLASH_CR_SNB(n)  ((uint32_t)(n) << 3)
#define FLASH_CR_PSIZE32 (2u << 8)
#define FLASH_CR_STRT    BIT(16)
#define FLASH_CR_LOCK    BIT(31)

/* RM0090 8.4: general-purpose pins */
#define GPIOA_MODER REG32(0x40020000u)
#define GPIOA_PUPDR REG32(0x4002000Cu)
#define GPIOA_AFRL  REG32(0x40020020u)
#define GPIOA_AFRH  REG32(0x40020024u)

/* RM0090 30.6: serial ports */
#define USART1_BASE      0x40011000u
#define USART2_BASE      0x40004400u
#define USART_SR(base)   REG32((base) + 0x00u)
#define USART_DR(base)   REG32((base) + 0x04u)
#define USART_BRR(base)  REG32((base) + 0x08u)
#define USART_CR1(base)  REG32((base) + 0x0Cu)
#define USART_SR_PE      BIT(0)
#define USART_SR_FE      BIT(1)
#define USART_SR_NE      BIT(2)
#define USART_SR_ORE     BIT(3)
#define USART_SR_RXNE    BIT(5)
#define USART_SR_TXE     BIT(7)
#define USART_CR1_RE     BIT(2)
#define USART_CR1_TE     BIT(3)
#define USART_CR1_RXNEIE BIT(5)
#define USART_CR1_TXEIE  BIT(7)
#define USART_CR1_UE     BIT(13)
#define USART1_IRQ       37
#define USART2_IRQ       38

/* RM0090 18.4, 19.5: TIM2 counts for hal_cycles() on the emulator, TIM11 measures the crystal */
#define TIM2_CR1          REG32(0x40000000u)
#define TIM2_EGR          REG32(0x40000014u)
#define TIM2_CNT          REG32(0x40000024u)
#define TIM2_PSC          REG32(0x40000028u)
#define TIM2_ARR          REG32(0x4000002Cu)
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

/* RM0090 21.4: independent watchdog */
#define IWDG_KR        REG32(0x40003000u)
#define IWDG_KR_ACCESS 0x5555u
#define IWDG_KR_RELOAD 0xAAAAu
#define IWDG_KR_START  0xCCCCu
#define IWDG_PR        REG32(0x40003004u)
#define IWDG_RLR       REG32(0x40003008u)
#define IWDG_SR        REG32(0x4000300Cu)

/* RM0090 38.16: a halted core also halts the watchdog */
#define DBGMCU_APB1_FZ      REG32(0xE0042008u)
#define DBGMCU_APB1_FZ_IWDG BIT(12)

/* PM0214 4: the core's own */
#define SYST_CSR           REG32(0xE000E010u)
#define SYST_CSR_ENABLE    BIT(0)
#define SYST_CSR_TICKINT   BIT(1)
#define SYST_CSR_CLKSOURCE BIT(2)
#define SYST_RVR           REG32(0xE000E014u)
#define SYST_CVR           REG32(0xE000E018u)
#define NVIC_ISER(n)       REG32(0xE000E100u + 4u * (n))
#define NVIC_IPR(irq)      REG8(0xE000E400u + (irq))
#define SCB_ICSR           REG32(0xE000ED04u)
#define SCB_ICSR_PENDSVSET BIT(28)
#define SCB_VTOR           REG32(0xE000ED08u)
#define SCB_AIRCR          REG32(0xE000ED0Cu)
#define SCB_AIRCR_RESET    (0x05FA0000u | BIT(2))
#define SCB_CCR            REG32(0xE000ED14u)
#define SCB_CCR_DIV_0_TRP  BIT(4)
#define SCB_SHPR(handler)  REG8(0xE000ED14u + (handler)) /* handler: exception number, 4 to 15 */
#define SCB_SHCSR          REG32(0xE000ED24u)
#define SCB_SHCSR_FAULTS                                                                           \
    (BIT(16) | BIT(17) | BIT(18)) /* MemManage, BusFault, UsageFault on their own */
#define SCB_CFSR           REG32(0xE000ED28u)
#define SCB_HFSR           REG32(0xE000ED2Cu)
#define SCB_MMFAR          REG32(0xE000ED34u)
#define SCB_BFAR           REG32(0xE000ED38u)
#define SCB_CPACR          REG32(0xE000ED88u)
#define SCB_CPACR_FPU      (15u << 20)
#define SCB_DEMCR          REG32(0xE000EDFCu)
#define SCB_DEMCR_TRCENA   BIT(24)
#define DWT_CTRL           REG32(0xE0001000u)
#define DWT_CTRL_CYCCNTENA BIT(0)
#define DWT_CYCCNT         REG32(0xE0001004u)

#endif

/* Registers that the STM32F1 and F4 have in common, under the names of the reference manuals (RM0041, RM0090) and
 * of the programming manuals of the core (PM0056, PM0214). No vendor header is packaged for C by the
 * distribution, and these are all that is needed. Each port's registers.h has the rest.
 */
#ifndef REFLUX_STM32_COMMON_H
#define REFLUX_STM32_COMMON_H

#include <stdint.h>

#define REG32(address) (*(volatile uint32_t *)(address))
#define REG16(address) (*(volatile uint16_t *)(address))
#define REG8(address)  (*(volatile uint8_t *)(address))
#define BIT(n)         (UINT32_C(1) << (n))

/* RM0041 23.6, RM0090 30.6: serial ports */
#define USART_SR(base)   REG32((base) + 0x00u)
#define USART_DR(base)   REG32((base) + 0x04u)
#define USART_BRR(base)  REG32((base) + 0x08u)
#define USART_CR1(base)  REG32((base) + 0x0Cu)
#define USART_CR3(base)  REG32((base) + 0x14u)
#define USART_SR_PE      BIT(0)
#define USART_SR_FE      BIT(1)
#define USART_SR_NE      BIT(2)
#define USART_SR_ORE     BIT(3)
#define USART_SR_RXNE    BIT(5)
#define USART_SR_TC      BIT(6)
#define USART_SR_TXE     BIT(7)
#define USART_CR1_RE     BIT(2)
#define USART_CR1_TE     BIT(3)
#define USART_CR1_RXNEIE BIT(5)
#define USART_CR1_TCIE   BIT(6)
#define USART_CR1_TXEIE  BIT(7)
#define USART_CR1_UE     BIT(13)
#define USART_CR3_HDSEL  BIT(3)
#define USART1_IRQ       37
#define USART2_IRQ       38

/* SPI (RM0041 22.5, RM0090 28.5). Where the bits stand is from memory (unverified). */
#define SPI_CR1(base)  REG32((base) + 0x00u)
#define SPI_CR2(base)  REG32((base) + 0x04u)
#define SPI_SR(base)   REG32((base) + 0x08u)
#define SPI_DR(base)   REG32((base) + 0x0Cu)
#define SPI_CR1_MSTR   BIT(2)
#define SPI_CR1_BR(n)  ((uint32_t)(n) << 3)
#define SPI_CR1_SPE    BIT(6)
#define SPI_CR1_SSI    BIT(8)
#define SPI_CR1_SSM    BIT(9)
#define SPI_CR2_RXNEIE BIT(6)
#define SPI_SR_RXNE    BIT(0)
#define SPI_SR_BSY     BIT(7)

/* RM0041 18.4, RM0090 21.4: independent watchdog */
#define IWDG_KR_ADDRESS 0x40003000u
#define IWDG_KR         REG32(IWDG_KR_ADDRESS)
#define IWDG_KR_ACCESS  0x5555u
#define IWDG_KR_RELOAD  0xAAAAu
#define IWDG_KR_START   0xCCCCu
#define IWDG_PR         REG32(0x40003004u)
#define IWDG_RLR        REG32(0x40003008u)
#define IWDG_SR         REG32(0x4000300Cu)

/* RM0041 4.4, RM0090 5.4: power. The voltages of PWR_CR_PLS are the chip's own. */
#define PWR_CR       REG32(0x40007000u)
#define PWR_CR_PVDE  BIT(4)
#define PWR_CR_PLS   (7u << 5)
#define PWR_CR_DBP   BIT(8)
#define PWR_CSR      REG32(0x40007004u)
#define PWR_CSR_PVDO BIT(2)

/* RM0041 6.2.7 and 6.3, RM0090 7.2.7 and 7.3: the clock security system; where RCC_CR and RCC_CIR are, the chip knows */
#define RCC_CR_CSSON    BIT(19)
#define RCC_CIR_CSSF    BIT(7)
#define RCC_CIR_CSSC    BIT(23)
#define RCC_APB1ENR_PWR BIT(28)

/* RM0041 6.3.10, RM0090 7.3.21: why it started (RCC_CSR); BORRST is the F4's alone, reserved on the F1 */
#define RCC_CSR_RMVF    BIT(24)
#define RCC_CSR_BORRST  BIT(25)
#define RCC_CSR_PINRST  BIT(26)
#define RCC_CSR_PORRST  BIT(27)
#define RCC_CSR_SFTRST  BIT(28)
#define RCC_CSR_IWDGRST BIT(29)
#define RCC_CSR_WWDGRST BIT(30)
#define RCC_CSR_LPWRRST BIT(31)

/* PM0056 4, PM0214 4: the core's own */
#define SYST_CSR           REG32(0xE000E010u)
#define SYST_CSR_ENABLE    BIT(0)
#define SYST_CSR_TICKINT   BIT(1)
#define SYST_CSR_CLKSOURCE BIT(2)
#define SYST_CSR_COUNTFLAG BIT(16) /* it has reached 0 since this register was last read */
#define SYST_RVR           REG32(0xE000E014u)
#define SYST_CVR           REG32(0xE000E018u)
#define NVIC_ISER(n)       REG32(0xE000E100u + 4u * (n))
#define NVIC_ICPR(n)       REG32(0xE000E280u + 4u * (n))
#define NVIC_IPR(irq)      REG8(0xE000E400u + (irq))
#define SCB_ICSR           REG32(0xE000ED04u)
#define SCB_ICSR_PENDSVSET BIT(28)
#define SCB_ICSR_PENDSVCLR BIT(27)
#define SCB_ICSR_PENDSTCLR BIT(25)
#define SCB_VTOR           REG32(0xE000ED08u)
#define SCB_AIRCR          REG32(0xE000ED0Cu)
#define SCB_AIRCR_RESET    (0x05FA0000u | BIT(2))
#define SCB_CCR            REG32(0xE000ED14u)
#define SCB_CCR_DIV_0_TRP  BIT(4)
#define SCB_CCR_STKALIGN   BIT(9) /* not set by a reset on every revision of the Cortex-M3 */
#define SCB_SHPR(handler)  REG8(0xE000ED14u + (handler)) /* handler: exception number, 4 to 15 */
#define SCB_SHCSR          REG32(0xE000ED24u)
#define SCB_SHCSR_FAULTS                                                                           \
    (BIT(16) | BIT(17) | BIT(18)) /* MemManage, BusFault, UsageFault on their own */
#define SCB_CFSR            REG32(0xE000ED28u)
#define SCB_CFSR_MMARVALID  (1u << 7)
#define SCB_CFSR_PRECISERR  (1u << 9)
#define SCB_CFSR_BFARVALID  (1u << 15)
#define SCB_HFSR            REG32(0xE000ED2Cu)
#define SCB_MMFAR           REG32(0xE000ED34u)
#define SCB_BFAR            REG32(0xE000ED38u)
#define MPU_TYPE            REG32(0xE000ED90u) /* PM0214 4.2; no part of PM0056: the F1 has none */
#define MPU_TYPE_DREGION    (255u << 8)
#define MPU_CTRL            REG32(0xE000ED94u)
#define MPU_CTRL_ENABLE     BIT(0)
#define MPU_CTRL_PRIVDEFENA BIT(2)
#define MPU_RNR             REG32(0xE000ED98u)
#define MPU_RBAR            REG32(0xE000ED9Cu)
#define MPU_RASR            REG32(0xE000EDA0u)
#define MPU_RASR_ENABLE     BIT(0)
#define MPU_RASR_SIZE(log2) (((log2)-1u) << 1)
#define MPU_RASR_AP_NONE    (0u << 24)
#define MPU_RASR_XN         BIT(28)
#define SCB_DEMCR           REG32(0xE000EDFCu)
#define SCB_DEMCR_TRCENA    BIT(24)
#define DWT_CTRL            REG32(0xE0001000u)
#define DWT_CTRL_CYCCNTENA  BIT(0)
#define DWT_CYCCNT          REG32(0xE0001004u)

#endif

/* A model of the registers that the ports of both chips write, around the port's clock.c: what a chip itself changes, and every write in its
 * order. Included by one file of a test program. */
#ifndef REFLUX_TESTS_STM32_CHIP_BENCH_H
#define REFLUX_TESTS_STM32_CHIP_BENCH_H

#include <setjmp.h>
#include <string.h>

/* So that a start begins with what a reset leaves in its variables. NOLINTNEXTLINE(bugprone-suspicious-include) */
#include "clock.c"
#include "hal/identity.h"
#include "unity.h"

/* From here on the name of a register is its address. */
#undef REG32
#undef REG16
#undef REG8
#define REG32(address) ((uint32_t)(address))
#define REG16(address) ((uint32_t)(address))
#define REG8(address)  ((uint32_t)(address))

#ifdef FLASH_OPTCR
#define F405 1
#else
#define F405 0
#endif

#define REGISTERS 64u
#define WRITES    400u

/* ---- the model ---- */

uint32_t stm32_ipsr, stack_bottom[16], stack_top[1], startup_noise;

static struct {
    uint32_t address, word, noted;
} registers[REGISTERS];
static struct {
    uint32_t address, word;
} writes[WRITES];
static unsigned n_registers, n_writes;

static uint32_t crystal_khz; /* 0: none */
static int hsi_error;        /* thousandths */
static bool pll_locks, rtc_runs, supply_low, waits_taken,
    switches;           /* switches: the core takes the clock that is chosen */
static uint32_t cycles; /* of the core; each access takes some */
static jmp_buf board_reset;

static inline unsigned find(uint32_t address)
{
    unsigned i = 0;
    while (i < n_registers && registers[i].address != address)
        i++;
    TEST_ASSERT_TRUE(i < REGISTERS);
    if (i == n_registers) {
        registers[n_registers++].address = address;
        if (address >> 24 == 0x08u) /* the flash, erased */
            registers[i].word = registers[i].noted = UINT32_MAX;
    }
    return i;
}

static inline uint32_t *word_at(uint32_t address)
{
    return &registers[find(address)].word;
}

/* Changes by the chip itself are no writes of the firmware's. */
static inline void becomes(uint32_t address, uint32_t word)
{
    unsigned i = find(address);
    registers[i].word = registers[i].noted = word;
}

#if !F405
/* RM0041 6.3.2 and 6.3.12: the lowest bit of RCC_CFGR2 and PLLXTPRE in RCC_CFGR are one bit. */
static inline void one_bit_in_two_registers(uint32_t address, uint32_t word)
{
    if (address == RCC_CFGR)
        becomes(RCC_CFGR2, (*word_at(RCC_CFGR2) & ~1u) | (word >> 17 & 1u));
    else if (address == RCC_CFGR2)
        becomes(RCC_CFGR, (*word_at(RCC_CFGR) & ~BIT(17)) | (word & 1u) << 17);
}
#endif

/* RM0090 21.3 and 21.4, RM0041 18.3: PR and RLR take values while KR has the key of access, each some time after the other. */
static unsigned iwdg_busy; /* looks at IWDG_SR until what was written has arrived */
static bool iwdg_early;    /* something was written before that */

static inline void watchdog_written(unsigned i, uint32_t before)
{
    uint32_t address = registers[i].address;
    if (address == IWDG_PR || address == IWDG_RLR) {
        if (*word_at(IWDG_KR) != IWDG_KR_ACCESS)
            becomes(address, before);
        iwdg_early = iwdg_early || (iwdg_busy != 0 && iwdg_busy != 5);
        iwdg_busy = 5;
    }
    if (address == IWDG_KR && registers[i].word == IWDG_KR_RELOAD)
        iwdg_early = iwdg_early || iwdg_busy != 0;
}

static inline void note_writes(void)
{
    for (unsigned i = 0; i < n_registers; i++) {
        if (registers[i].word == registers[i].noted)
            continue;
        TEST_ASSERT_TRUE(n_writes < WRITES);
        uint32_t before = registers[i].noted;
        writes[n_writes].address = registers[i].address;
        writes[n_writes++].word = registers[i].noted = registers[i].word;
        /* RM0090 7.3.1, RM0041 6.3.1: a PLL that is chosen stays on. */
        if (registers[i].address == RCC_CR && (*word_at(RCC_CFGR) & 3u) == RCC_CFGR_SW_PLL)
            becomes(RCC_CR, registers[i].word | RCC_CR_PLLON);
        watchdog_written(i, before);
#if !F405
        one_bit_in_two_registers(registers[i].address, registers[i].word);
#endif
    }
}

static inline void follows(uint32_t address, uint32_t wanted, uint32_t ready, bool can)
{
    uint32_t word = *word_at(address);
    becomes(address, (word & wanted) && can ? word | ready : word & ~ready);
}

static inline double hsi_hz(void)
{
    return HSI_HZ * (1.0 + hsi_error / 1000.0);
}

static inline void measuring(uint32_t address)
{
#if F405
    /* RM0090 19.4.12: TIM11 captures every eighth period of the crystal's 31st */
    if (address == TIM11_SR && crystal_khz &&
        (*word_at(RCC_CFGR) & RCC_CFGR_RTCPRE(31)) == RCC_CFGR_RTCPRE(31) &&
        (*word_at(RCC_APB2ENR) & RCC_APB2ENR_TIM11) != 0 && *word_at(TIM11_OR) == 2 &&
        *word_at(TIM11_CCMR1) == 0xDu && *word_at(TIM11_CCER) == 1 && *word_at(TIM11_CR1) == 1) {
        double each = 31.0 * 8.0 * hsi_hz() / (crystal_khz * 1000.0);
        becomes(TIM11_CCR1, (*word_at(TIM11_CCR1) + (uint32_t)each) & 0xFFFFu);
        becomes(address, TIM11_SR_CC1IF);
    }
#else
    /* RM0041 17.3: the real-time clock counts the crystal's 128th down */
    const uint32_t on = RCC_BDCR_HSE_RTC | RCC_BDCR_RTCEN;
    bool counts =
        rtc_runs && (*word_at(RCC_BDCR) & on) == on && (*word_at(PWR_CR) & PWR_CR_DBP) != 0;
    if (address == RTC_CRL && counts)
        becomes(address, RTC_CRL_RSF);
    if (address == RTC_DIVL && counts)
        becomes(address, 0x8000u - (uint32_t)(cycles * (crystal_khz * 1000.0) / 128.0 / hsi_hz()));
    if (address == DWT_CYCCNT)
        becomes(address, cycles);
#endif
}

/* Before anybody sees the register of that address. */
static inline void chip_moves_on(uint32_t address)
{
    if (address == RCC_CR) {
        follows(address, RCC_CR_HSEON, RCC_CR_HSERDY, crystal_khz != 0);
        follows(address, RCC_CR_PLLON, RCC_CR_PLLRDY, pll_locks);
    }
    if (address == RCC_CFGR) {
        uint32_t word = *word_at(address);
        if (switches)
            becomes(address, (word & ~RCC_CFGR_SWS) | (word & 3u) << 2);
    }
#if F405
    if (address == FLASH_ACR && !waits_taken)
        becomes(address, *word_at(address) & ~7u);
#endif
    if (address == PWR_CSR)
        becomes(address, supply_low && (*word_at(PWR_CR) & PWR_CR_PVDE) ? PWR_CSR_PVDO : 0);
    if (address == IWDG_SR)
        becomes(address, iwdg_busy > 0 ? (iwdg_busy--, 3u) : 0);
    if (address == FLASH_SR) /* ones that are written clear, and nothing lasts */
        becomes(address, 0);
    if (address == SCB_AIRCR)
        longjmp(board_reset, 1);
    measuring(address);
}

volatile uint32_t *stm32_register(uint32_t address)
{
    note_writes();
    cycles += 12;
    chip_moves_on(address);
    return word_at(address);
}

/* ---- what a test looks at ---- */

static inline uint32_t now(uint32_t address)
{
    note_writes();
    return *word_at(address);
}

/* Number of the first write that left these bits so; WRITES: none did. */
static inline unsigned first_write(uint32_t address, uint32_t mask, uint32_t bits)
{
    note_writes();
    for (unsigned i = 0; i < n_writes; i++)
        if (writes[i].address == address && (writes[i].word & mask) == bits)
            return i;
    return WRITES;
}

static inline void forget_writes(void)
{
    note_writes();
    n_writes = 0;
}

/* A reset with these flags in RCC_CSR: registers and variables as after one, the kept memory stays. */
static inline void start(uint32_t flags)
{
    memset(registers, 0, sizeof registers);
    n_registers = n_writes = 0;
    cycles = 0;
    becomes(RCC_CR, 0x83u); /* HSION, HSIRDY, trimming: RM0090 7.3.1, RM0041 6.3.1 */
    becomes(RCC_CSR, flags);
#if F405
    becomes(DBGMCU_IDCODE, 0x10076413u); /* revision 2 */
    apb1_hz = apb2_hz = HSI_HZ;
    source = "HSI 16 MHz";
#else
    source = "HSI 8 MHz";
#endif
    model = false;
    core_hz = HSI_HZ;
    clock_start();
    supply_start();
    identity_start();
}

static inline void usual_surroundings(void)
{
    crystal_khz = 8000;
    hsi_error = 0;
    pll_locks = rtc_runs = switches = waits_taken = true;
    supply_low = iwdg_early = false;
    iwdg_busy = 0;
}

#endif

/* Clock tree: 168 MHz from the crystal where there is one, else from the internal oscillator, else 16 MHz.
 *
 * Every wait has a bound. In the emulator the whole RCC reads zero and the core runs at 168 MHz whatever is
 * asked of it: RCC_CR reads 0 there, which no chip does (its HSION bit is set out of reset).
 */
#include "hal/clock.h"
#include "board.h"
#include "crystal.h"
#include "registers.h"

#define WAIT_TURNS 200000u /* 0.1 s at 16 MHz: several times the slowest start of a crystal */
#define HSI_HZ     16000000u
#define PLL_HZ     168000000u

static bool model;
static uint32_t core_hz = HSI_HZ, apb1_hz = HSI_HZ, apb2_hz = HSI_HZ;
static const char *source = "HSI 16 MHz";

static bool wait_for(volatile uint32_t *reg, uint32_t mask, uint32_t value)
{
    IWDG_KR = IWDG_KR_RELOAD; /* it may run from the reset on: 0.35 s at least */
    for (uint32_t i = 0; i < WAIT_TURNS; i++) {
        if ((*reg & mask) == value) {
            return true;
        }
    }
    return false;
}

/* Boards carry different crystals (8 MHz, 12 MHz, ...) and the same image is to run on all of them, so the
 * crystal is measured against the internal oscillator: TIM11 captures the crystal divided by 31 (the clock
 * offered to the RTC), every eighth edge. Returns whole megahertz, 0 when the count fits no crystal on the list. */
static uint32_t measure_crystal_mhz(void)
{
    static const uint8_t known[] = {8, 12, 16, 25};
    uint32_t first = 0, ticks = 0;

    RCC_CFGR |= RCC_CFGR_RTCPRE(31);
    RCC_APB2ENR |= RCC_APB2ENR_TIM11;
    (void)RCC_APB2ENR; /* a clock needs two cycles to arrive */
    TIM11_PSC = 0;
    TIM11_ARR = 0xFFFFu;
    TIM11_OR = TIM11_OR_HSE_RTC;
    TIM11_CCMR1 = TIM11_CCMR1_TI1_8;
    TIM11_CCER = TIM11_CCER_CC1E;
    TIM11_CR1 = TIM_CR1_CEN;
    for (uint32_t i = 0; i < 3; i++) { /* the first interval is not a whole one */
        if (!wait_for(&TIM11_SR, TIM11_SR_CC1IF, TIM11_SR_CC1IF)) {
            ticks = 0;
            break;
        }
        uint32_t now = TIM11_CCR1; /* reading it clears the flag */
        ticks = (now - first) & 0xFFFFu;
        first = now;
    }
    TIM11_CR1 = 0;
    TIM11_CCER = 0;
    RCC_APB2ENR &= ~RCC_APB2ENR_TIM11;
    return crystal_mhz(known, sizeof(known), ticks, HSI_HZ / 1000000u * 31u * 8u);
}

/* Everything the flash interface has to make up for its wait states, but the prefetch on early silicon: revision A does
 * not have it (errata sheet ES0182), and tells a wrong device (0x411), by which it is recognised as well. */
static uint32_t flash_speed(void)
{
    uint32_t id = DBGMCU_IDCODE;
    bool early = (id & DBGMCU_IDCODE_DEV) != DEV_F405 || (id & DBGMCU_IDCODE_REV) == REV_A;
    return FLASH_ACR_ICEN | FLASH_ACR_DCEN | (early ? 0 : FLASH_ACR_PRFTEN);
}

static bool start_pll(uint32_t input_mhz, uint32_t from)
{
    /* 1 MHz into the oscillator, 336 MHz out of it, halved for the core; 48 MHz for USB on the side. */
    RCC_PLLCFGR = RCC_PLLCFGR_KEPT | input_mhz | (336u << 6) | (7u << 24) | from;
    RCC_CR |= RCC_CR_PLLON;
    if (!wait_for(&RCC_CR, RCC_CR_PLLRDY, RCC_CR_PLLRDY)) {
        RCC_CR &= ~RCC_CR_PLLON;
        return false;
    }
    /* Five wait states at 168 MHz and 2.7 V to 3.6 V; must be in force before the clock rises. */
    FLASH_ACR = 5u | flash_speed();
    if (!wait_for(&FLASH_ACR, 7u, 5u)) {
        return false;
    }
    RCC_CFGR = (RCC_CFGR & RCC_CFGR_RTCPRE(31)) | RCC_CFGR_PPRE1_4 | RCC_CFGR_PPRE2_2;
    RCC_CFGR |= RCC_CFGR_SW_PLL;
    if (!wait_for(&RCC_CFGR, RCC_CFGR_SWS, RCC_CFGR_SWS_PLL)) {
        RCC_CFGR &= ~(3u | (7u << 10) | (7u << 13));
        return false;
    }
    core_hz = PLL_HZ;
    apb1_hz = PLL_HZ / 4u;
    apb2_hz = PLL_HZ / 2u;
    return true;
}

static void start_clock_tree(void)
{
    RCC_APB1ENR |= RCC_APB1ENR_PWR;
    (void)RCC_APB1ENR;
    PWR_CR |= PWR_CR_VOS;
    FLASH_ACR = flash_speed();

    if (identity_crystal_failed()) {
        if (start_pll(HSI_HZ / 1000000u, 0)) {
            source = "HSI 16 MHz, PLL: the crystal has failed";
        }
        return;
    }
    RCC_CR |= RCC_CR_HSEON;
    if (wait_for(&RCC_CR, RCC_CR_HSERDY, RCC_CR_HSERDY)) {
        uint32_t mhz = measure_crystal_mhz();
        if (mhz != 0 && start_pll(mhz, RCC_PLLCFGR_HSE)) {
            RCC_CR |= RCC_CR_CSSON; /* should it fail, the NMI starts the board anew without it */
            source = mhz == 8    ? "HSE 8 MHz, PLL"
                     : mhz == 12 ? "HSE 12 MHz, PLL"
                     : mhz == 16 ? "HSE 16 MHz, PLL"
                                 : "HSE 25 MHz, PLL";
            return;
        }
    }
    RCC_CR &= ~RCC_CR_HSEON;
    if (start_pll(HSI_HZ / 1000000u, 0)) {
        source = "HSI 16 MHz, PLL";
    }
}

void clock_start(void)
{
    model = RCC_CR == 0;
    if (model) {
        core_hz = PLL_HZ;
        apb1_hz = PLL_HZ / 4u;
        apb2_hz = PLL_HZ / 2u;
        source = "emulator";
    } else {
        start_clock_tree();
    }

    SCB_DEMCR |= SCB_DEMCR_TRCENA;
    DWT_CYCCNT = 0;
    DWT_CTRL |= DWT_CTRL_CYCCNTENA;
    RCC_APB1ENR |= RCC_APB1ENR_TIM2;
    (void)RCC_APB1ENR;
    TIM2_PSC = 0;
    TIM2_ARR = UINT32_MAX;
    TIM2_EGR = TIM_EGR_UG;
    TIM2_CR1 = TIM_CR1_CEN;
}

bool clock_is_model(void)
{
    return model;
}

uint32_t clock_apb1_hz(void)
{
    return apb1_hz;
}

uint32_t clock_apb2_hz(void)
{
    return apb2_hz;
}

/* The emulator has no cycle counter; its timers count 1 GHz of emulated time, which under
 * -icount shift=0 is one count an instruction. Without icount it is time of the host. */
uint32_t hal_cycles(void)
{
    return model ? TIM2_CNT : DWT_CYCCNT;
}

const char *hal_cycles_unit(void)
{
    return model ? "model ticks" : "cycles";
}

uint32_t hal_core_hz(void)
{
    return core_hz;
}

const char *hal_clock_source(void)
{
    return source;
}

/* Clock tree: 24 MHz, the most this chip does, from a crystal where there is one that fits, else from the internal oscillator,
 * else 8 MHz. No wait states are needed (PM0063 2.1).
 *
 * Every wait has a bound. In the emulator the whole RCC reads zero and the core runs at 24 MHz whatever is asked
 * of it: RCC_CR reads 0 there, which no chip does (its HSION bit is set out of reset).
 */
#include "hal/clock.h"
#include "board.h"
#include "crystal.h"
#include "registers.h"

#define WAIT_TURNS 100000u /* 0.1 s at 8 MHz: several times the slowest start of a crystal */
#define HSI_HZ     8000000u
#define PLL_HZ     24000000u
#define RTC_CLOCKS 64u /* over which the crystal is measured: 1 ms with one of 8 MHz */

static bool model;
static uint32_t core_hz = HSI_HZ;
static const char *source = "HSI 8 MHz";

static bool wait_for(volatile uint32_t *reg, uint32_t mask, uint32_t value)
{
    for (uint32_t i = 0; i < WAIT_TURNS; i++) {
        if ((*reg & mask) == value) {
            return true;
        }
    }
    return false;
}

/* Waits until the real-time clock has gone on by so many of its counts; returns the core's cycles then, in *cycles. */
static bool rtc_goes_on(uint16_t from, uint16_t counts, uint32_t *cycles)
{
    for (uint32_t i = 0; i < WAIT_TURNS; i++) {
        if ((uint16_t)(from - RTC_DIVL) >= counts) {
            *cycles = DWT_CYCCNT;
            return true;
        }
    }
    return false;
}

/* The crystal is measured against the internal oscillator, from which the core runs: no timer can be fed with it on this
 * chip, but the real-time clock can, with its 128th (RM0041 6.2.8 and 17.3). Nobody else here uses that clock, and the
 * backup domain is left as after a power-on. Returns whole megahertz; 0: none on the list, or the clock stands still. */
static uint32_t measure_crystal_mhz(void)
{
    static const uint8_t known[] = {4, 8, 12, 16, 24};
    uint32_t first = 0, last = 0;

    RCC_APB1ENR |= RCC_APB1ENR_PWR | RCC_APB1ENR_BKP;
    (void)RCC_APB1ENR; /* a clock needs two cycles to arrive */
    PWR_CR |= PWR_CR_DBP;
    RCC_BDCR =
        RCC_BDCR_BDRST; /* whatever its clock was before: it can be chosen once after a reset */
    RCC_BDCR = 0;
    RCC_BDCR = RCC_BDCR_HSE_RTC | RCC_BDCR_RTCEN;
    RTC_CRL = 0; /* until RSF is set again what is read may be old */
    bool read = false;
    for (uint32_t i = 0; i < WAIT_TURNS && !read; i++) {
        read = (RTC_CRL & RTC_CRL_RSF) != 0;
    }
    uint16_t from = RTC_DIVL;
    bool whole = read && rtc_goes_on(from, 1, &first) &&
                 rtc_goes_on((uint16_t)(from - 1u), RTC_CLOCKS, &last);
    RCC_BDCR = RCC_BDCR_BDRST;
    RCC_BDCR = 0;
    PWR_CR &= ~PWR_CR_DBP;
    RCC_APB1ENR &= ~RCC_APB1ENR_BKP;
    return whole ? crystal_mhz(known, sizeof(known), last - first,
                               HSI_HZ / 1000000u * 128u * RTC_CLOCKS)
                 : 0;
}

/* divided: of the crystal, 1 .. 16, before the PLL. RCC_CFGR2 comes last, because its lowest bit is also a bit of RCC_CFGR (RM0041
 * 6.3.2, PLLXTPRE), which `settings` leaves at 0: the other way round a divider of 2 is lost and the PLL runs at 48 MHz. */
static bool start_pll(uint32_t divided, uint32_t settings)
{
    RCC_CFGR = settings;
    RCC_CFGR2 = divided - 1u;
    RCC_CR |= RCC_CR_PLLON;
    if (wait_for(&RCC_CR, RCC_CR_PLLRDY, RCC_CR_PLLRDY)) {
        RCC_CFGR |= RCC_CFGR_SW_PLL;
        if (wait_for(&RCC_CFGR, RCC_CFGR_SWS, RCC_CFGR_SWS_PLL)) {
            core_hz = PLL_HZ;
            return true;
        }
    }
    RCC_CFGR &= ~RCC_CFGR_SW;
    RCC_CR &= ~RCC_CR_PLLON;
    return false;
}

static bool start_from_crystal(void)
{
    RCC_CR |= RCC_CR_HSEON;
    if (!wait_for(&RCC_CR, RCC_CR_HSERDY, RCC_CR_HSERDY)) {
        return false;
    }
    uint32_t mhz = measure_crystal_mhz();
    uint32_t divided = mhz > 12u ? 2u : 1u; /* 4 to 12 MHz into the PLL, 24 MHz out of it */
    if (mhz == 0 || !start_pll(divided, RCC_CFGR_PLLSRC | RCC_CFGR_PLLMUL(24u * divided / mhz))) {
        return false;
    }
    RCC_CR |= RCC_CR_CSSON; /* should it fail, the NMI starts the board anew without it */
    source = mhz == 4    ? "HSE 4 MHz, PLL"
             : mhz == 8  ? "HSE 8 MHz, PLL"
             : mhz == 12 ? "HSE 12 MHz, PLL"
             : mhz == 16 ? "HSE 16 MHz, PLL"
                         : "HSE 24 MHz, PLL";
    return true;
}

void clock_start(void)
{
    SCB_DEMCR |= SCB_DEMCR_TRCENA;
    DWT_CYCCNT = 0;
    DWT_CTRL |= DWT_CTRL_CYCCNTENA;
    model = RCC_CR == 0;
    if (model) {
        core_hz = PLL_HZ;
        source = "emulator";
        return;
    }
    bool failed = identity_crystal_failed();
    if (!failed && start_from_crystal()) {
        return;
    }
    RCC_CR &= ~RCC_CR_HSEON;
    if (start_pll(1, RCC_CFGR_PLLMUL(6u))) {
        source = failed ? "HSI 8 MHz, PLL: the crystal has failed" : "HSI 8 MHz, PLL";
    }
}

bool clock_is_model(void)
{
    return model;
}

uint32_t clock_apb1_hz(void)
{
    return core_hz;
}

uint32_t clock_apb2_hz(void)
{
    return core_hz;
}

/* The emulator has neither a cycle counter nor TIM2: what is left is SysTick, lengthened by the milliseconds it
 * counts. One of its counts is 125/3 ns of the emulator's time, which under -icount shift=0 are as many
 * instructions: exact to 42 of them, and to none on average. Else it is time of the host. */
static uint32_t model_ns(void)
{
    uint32_t ms, left;
    do {
        ms = (uint32_t)hal_clock_ms();
        left = SYST_CVR;
    } while (ms != (uint32_t)hal_clock_ms());
    uint32_t counts = left == 0 ? 0 : PLL_HZ / 1000u - left;
    return ms * 1000000u + counts * 125u / 3u;
}

uint32_t hal_cycles(void)
{
    return model ? model_ns() : DWT_CYCCNT;
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

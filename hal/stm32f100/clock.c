/* Clock tree: 24 MHz, the most this chip does, from an 8 MHz crystal (that of the discovery board) where there is
 * one, else from the internal oscillator, else 8 MHz. No wait states are needed (PM0063 2.1).
 *
 * Every wait has a bound. In the emulator the whole RCC reads zero and the core runs at 24 MHz whatever is asked
 * of it: RCC_CR reads 0 there, which no chip does (its HSION bit is set out of reset).
 */
#include "hal/clock.h"
#include "board.h"
#include "registers.h"

#define WAIT_TURNS 100000u /* 0.1 s at 8 MHz: several times the slowest start of a crystal */
#define HSI_HZ     8000000u
#define PLL_HZ     24000000u

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

static bool start_pll(uint32_t settings)
{
    RCC_CFGR2 = 0; /* the crystal is not divided */
    RCC_CFGR = settings;
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

void clock_start(void)
{
    model = RCC_CR == 0;
    if (model) {
        core_hz = PLL_HZ;
        source = "emulator";
    } else {
        RCC_CR |= RCC_CR_HSEON;
        if (wait_for(&RCC_CR, RCC_CR_HSERDY, RCC_CR_HSERDY) &&
            start_pll(RCC_CFGR_PLLSRC | RCC_CFGR_PLLMUL(3u))) {
            source = "HSE 8 MHz, PLL";
        } else {
            RCC_CR &= ~RCC_CR_HSEON;
            if (start_pll(RCC_CFGR_PLLMUL(6u))) {
                source = "HSI 8 MHz, PLL";
            }
        }
    }
    SCB_DEMCR |= SCB_DEMCR_TRCENA;
    DWT_CYCCNT = 0;
    DWT_CTRL |= DWT_CTRL_CYCCNTENA;
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

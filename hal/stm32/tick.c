/* Time base (SysTick, 1 ms) and the tick context (PendSV, below every interrupt and above the main loop). */
#include "hal/tick.h"
#include "app/app.h"
#include "board.h"
#include "hal/clock.h"
#include "registers.h"

void interrupt_systick(void);
void interrupt_pendsv(void);

static volatile uint32_t ms_low, ms_high;
static volatile uint32_t until_tick = HAL_TICK_PERIOD_MS;
static volatile bool ticking, work;

void interrupt_systick(void)
{
    uint32_t low = ms_low + 1u;
    if (low == 0) {
        ms_high = ms_high + 1u;
    }
    ms_low = low;
    if (HAL_BOARD_CLOCK) {
        analog_clock();
        pulse_clock();
        app_clock(app_instance(), low);
    }
    work = true;
    if (until_tick > 1u) {
        until_tick = until_tick - 1u;
    } else {
        until_tick = HAL_TICK_PERIOD_MS;
        hal_tick_request();
    }
}

void interrupt_pendsv(void)
{
    app_tick(app_instance());
    work = true; /* what it queued for sending, say */
}

/* The interrupt may fall between the two reads, but never stops half-way itself: read until nothing moved. */
uint64_t hal_clock_ms(void)
{
    uint32_t high, low;
    do {
        high = ms_high;
        low = ms_low;
    } while (high != ms_high || low != ms_low);
    return ((uint64_t)high << 32) | low;
}

void tick_start_timebase(void)
{
    SCB_SHPR(14) = PRIORITY_TICK;
    SCB_SHPR(15) = PRIORITY_CLOCK;
    SYST_RVR = hal_core_hz() / 1000u - 1u;
    SYST_CVR = 0;
    SYST_CSR = SYST_CSR_CLKSOURCE | SYST_CSR_TICKINT | SYST_CSR_ENABLE;
}

void tick_start(void)
{
    ticking = true;
}

void tick_work_seen(void)
{
    work = true;
}

void hal_tick_request(void)
{
    if (ticking) {
        SCB_ICSR = SCB_ICSR_PENDSVSET;
        __asm volatile("dsb" ::: "memory");
    }
}

static unsigned locks; /* that are held; the main loop's alone */

void hal_tick_lock(void)
{
    locks++;
    __asm volatile("msr basepri, %0\n\tdsb\n\tisb" : : "r"(PRIORITY_TICK) : "memory");
}

void hal_tick_unlock(void)
{
    if (--locks == 0)
        __asm volatile("dsb\n\tmsr basepri, %0\n\tisb" : : "r"(0) : "memory");
}

/* Interrupts are held off between the look and the sleep, so that work that arrives just then is not slept
 * over: a pending interrupt ends WFI even while it is masked. */
void hal_idle(bool wait)
{
    if (!wait) {
        work = false;
        return;
    }
    __asm volatile("cpsid i" ::: "memory");
    if (!work) {
        __asm volatile("dsb\n\twfi" ::: "memory");
    }
    work = false;
    __asm volatile("cpsie i\n\tisb" ::: "memory");
}

/* An image for a board whose watchdog bites: the firmware's own decision when to feed (service/heartbeat.h) around a main loop and a tick
 * that go wrong, one way in each life.
 *
 *     life 1   healthy for a while, then the main loop hangs
 *     life 2   the tick hangs
 *     life 3   every tick ends past its deadline
 *     life 4   healthy for ten time-outs: says done
 */
#include <stdbool.h>
#include <stdint.h>

#include "device.h"
#include "hal/watchdog.h"
#include "service/heartbeat.h"

#define REG32(address) (*(volatile uint32_t *)(address))

/* The core's own. */
#define SYST_CSR  REG32(0xE000E010u)
#define SYST_RVR  REG32(0xE000E014u)
#define SYST_CVR  REG32(0xE000E018u)
#define SCB_ICSR  REG32(0xE000ED04u)
#define SCB_SHPR3 REG32(0xE000ED20u)

#define TIMEOUT_MS  400u
#define PERIOD_MS   50u
#define DEADLINE_MS 50u
#define MAGIC       0x57444F47u

extern uint32_t stack_top[], bss_start[], bss_end[];

int main(void);
void reset_entry(void);
void nothing(void);
void interrupt_systick(void);
void interrupt_pendsv(void);

/* Survives the reset. */
static struct {
    uint32_t magic, life, alive_ms;
} kept __attribute__((section(".noinit")));

static volatile uint32_t now_ms;
static volatile uint32_t turns;
static struct heartbeat heartbeat;

union vector {
    void (*handler)(void);
    const void *address;
};
__attribute__((section(".vectors"), used)) static const union vector vectors[16] = {
    [0] = {.address = stack_top},         [1] = {.handler = reset_entry},
    [2] = {.handler = nothing}, /* the watchdog's first warning */
    [14] = {.handler = interrupt_pendsv}, [15] = {.handler = interrupt_systick},
};

static void say(const char *text)
{
    for (; *text; text++)
        device_send(*text);
}

static void say_number(uint32_t x)
{
    char digits[11] = {0};
    unsigned n = 10;
    do {
        digits[--n] = (char)('0' + x % 10u);
        x /= 10u;
    } while (x);
    say(digits + n);
}

void nothing(void) {}

void interrupt_systick(void)
{
    now_ms = now_ms + 1u;
    kept.alive_ms = now_ms;
    if (now_ms % PERIOD_MS == 0)
        SCB_ICSR = 1u << 28;
}

/* The tick context. */
void interrupt_pendsv(void)
{
    uint32_t began = now_ms;
    heartbeat_tick_begins(&heartbeat, began);
    while (kept.life == 2 && began > 300u) {
    }
    while (kept.life == 3 && began > 300u && now_ms - began < 2u * DEADLINE_MS) {
    }
    heartbeat_tick_ends(&heartbeat, now_ms, DEADLINE_MS);
    if (heartbeat_due(&heartbeat, now_ms, turns))
        hal_watchdog_feed();
}

int main(void)
{
    if (kept.magic != MAGIC) {
        kept.magic = MAGIC;
        kept.life = 0;
    } else {
        say("life ");
        say_number(kept.life);
        say(" ended after ms ");
        say_number(kept.alive_ms);
        say("\n");
    }
    kept.life++;
    heartbeat_init(&heartbeat, TIMEOUT_MS);
    say("life ");
    say_number(kept.life);
    say(hal_watchdog_start(TIMEOUT_MS) ? " begins, watchdog runs\n" : " begins, no watchdog\n");
    SCB_SHPR3 = 0x00FF0000u; /* PendSV below SysTick */
    SYST_RVR = device_hz / 1000u - 1u;
    SYST_CVR = 0;
    SYST_CSR = 7u;
    while (now_ms < 10u * TIMEOUT_MS) {
        turns = turns + 1u;
        while (kept.life == 1 && now_ms > 3u * TIMEOUT_MS) {
        }
    }
    say("done\n");
    for (;;)
        turns = turns + 1u;
}

void reset_entry(void)
{
    for (uint32_t *p = bss_start; p < bss_end; p++)
        *p = 0;
    device_start();
    main();
    for (;;) {
    }
}

#include "memory_port.h"

#include <setjmp.h>
#include <string.h>

#include "app/app.h"
#include "flash_model.h"
#include "hal/clock.h"
#include "hal/identity.h"
#include "hal/memory_use.h"
#include "hal/ring.h"
#include "hal/tick.h"
#include "hal/watchdog.h"

#define TURNS_MAX 100000u

static bool idle; /* the main loop had nothing to do in its last turn */
static uint8_t bytes[HAL_UART_COUNT][2][16384];
static struct line {
    struct ring rx, tx;
    struct hal_uart_stats stats;
} lines[HAL_UART_COUNT];
static uint64_t clock_ms, ticked_ms;
static bool tick_asked;
static uint32_t boot_id;
static enum hal_reset cause = HAL_RESET_POWER_ON;
static unsigned reboots;
static jmp_buf reset_vector;
static bool flash_ready;

static void power_up(void)
{
    for (unsigned i = 0; i < HAL_UART_COUNT; i++) {
        lines[i].rx = (struct ring){.bytes = bytes[i][0], .size = sizeof bytes[i][0]};
        lines[i].tx = (struct ring){.bytes = bytes[i][1], .size = sizeof bytes[i][1]};
        lines[i].stats = (struct hal_uart_stats){0};
    }
    clock_ms = ticked_ms = 0;
    tick_asked = true;
    boot_id++;
    app_init(app_instance());
}

void memory_port_start(void)
{
    if (!flash_ready)
        memory_port_erase_all();
    cause = HAL_RESET_POWER_ON;
    reboots = 0;
    power_up();
}

void memory_port_set_clock(uint64_t ms)
{
    if (ms > clock_ms)
        clock_ms = ms;
}

size_t memory_port_give(enum hal_uart port, const void *data, size_t n)
{
    struct line *l = &lines[port];
    size_t room = ring_room(&l->rx), taken = n < room ? n : room;
    (void)ring_write(&l->rx, data, taken);
    l->stats.received += (uint32_t)n;
    l->stats.rx_dropped += (uint32_t)(n - taken);
    if (port == HAL_UART_LINK)
        tick_asked = true;
    return taken;
}

size_t memory_port_take(enum hal_uart port, void *data, size_t size)
{
    return ring_read(&lines[port].tx, data, size);
}

/* Changes whenever a byte moves in either direction on either line. */
static uint32_t movement(void)
{
    uint32_t sum = 0;
    for (unsigned i = 0; i < HAL_UART_COUNT; i++)
        sum += lines[i].rx.tail + lines[i].tx.head;
    return sum;
}

unsigned memory_port_run(void)
{
    volatile unsigned turns = 0; /* survives the jump */
    if (setjmp(reset_vector) != 0) {
        uint64_t now = clock_ms;
        reboots++;
        cause = HAL_RESET_REQUESTED;
        power_up();
        clock_ms = ticked_ms = now; /* whoever simulates around goes on counting */
    }
    unsigned quiet = 0;
    while (quiet < 2 && turns < TURNS_MAX) {
        uint32_t before = movement();
        if (tick_asked || clock_ms - ticked_ms >= HAL_TICK_PERIOD_MS) {
            tick_asked = false;
            ticked_ms = clock_ms;
            app_tick(app_instance());
        }
        app_background(app_instance());
        turns = turns + 1u;
        quiet = idle && movement() == before ? quiet + 1u : 0;
    }
    return turns;
}

unsigned memory_port_reboots(void)
{
    return reboots;
}

uint8_t *memory_port_flash(void)
{
    return flash_model;
}

size_t memory_port_flash_size(void)
{
    return sizeof flash_model;
}

void memory_port_erase_all(void)
{
    flash_model_erase_all();
    flash_ready = true;
}

/* ---- the contract ---- */

size_t hal_uart_read(enum hal_uart port, uint8_t *buffer, size_t size)
{
    return ring_read(&lines[port].rx, buffer, size);
}

size_t hal_uart_room(enum hal_uart port)
{
    return ring_room(&lines[port].tx);
}

bool hal_uart_write(enum hal_uart port, const void *data, size_t n)
{
    if (!ring_write(&lines[port].tx, data, n))
        return false;
    lines[port].stats.sent += (uint32_t)n;
    return true;
}

size_t hal_uart_pump(enum hal_uart port)
{
    (void)port;
    return 0; /* the bench takes bytes from the ring itself */
}

bool hal_uart_connected(enum hal_uart port)
{
    (void)port;
    return true;
}

void hal_uart_get_stats(enum hal_uart port, struct hal_uart_stats *stats)
{
    *stats = lines[port].stats;
}

uint64_t hal_clock_ms(void)
{
    return clock_ms;
}

uint32_t hal_cycles(void)
{
    return 0;
}

const char *hal_cycles_unit(void)
{
    return "none";
}

uint32_t hal_core_hz(void)
{
    return 0;
}

const char *hal_clock_source(void)
{
    return "set by the bench";
}

void hal_tick_request(void)
{
    tick_asked = true;
}

void hal_tick_lock(void) {}

void hal_tick_unlock(void) {}

void hal_idle(bool wait)
{
    idle = wait;
}

bool hal_watchdog_start(uint32_t timeout_ms)
{
    (void)timeout_ms;
    return false;
}

void hal_watchdog_feed(void) {}

const char *hal_board_name(void)
{
    return "memory";
}

const char *hal_board_text(void)
{
    return "in the bench's own process";
}

enum hal_reset hal_reset_cause(void)
{
    return cause;
}

uint32_t hal_boot_id(void)
{
    return boot_id;
}

_Noreturn void hal_reboot(void)
{
    longjmp(reset_vector, 1);
}

uint32_t hal_stack_size(void)
{
    return 0;
}

uint32_t hal_stack_unused(void)
{
    return 0;
}

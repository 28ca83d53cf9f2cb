#include "memory_port.h"

#include <setjmp.h>
#include <string.h>

#include "app/app.h"
#include "buses.h"
#include "flash_model.h"
#include "hal/clock.h"
#include "hal/flow.h"
#include "hal/identity.h"
#include "hal/image.h"
#include "hal/retained.h"
#include "hal/ring.h"
#include "hal/self_check.h"
#include "hal/tick.h"
#include "hal/watchdog.h"

#define TURNS_MAX 100000u

static bool idle; /* the main loop had nothing to do in its last turn */
static uint8_t bytes[HAL_UART_COUNT][2][16384];
static struct line {
    struct ring rx, tx;
    struct flow flow;
    struct hal_uart_stats stats;
} lines[HAL_UART_COUNT];
static uint32_t console_rx_size = sizeof bytes[0][0], console_tx_size = sizeof bytes[0][1];
static uint64_t clock_ms, ticked_ms;
static uint32_t frame_ms;
static uint64_t fed_ms, unfed_ms; /* the last feeding; the longest time without one */
static bool tick_asked;
static uint32_t boot_id;
static enum hal_reset cause = HAL_RESET_POWER_ON;
static unsigned reboots;
static jmp_buf reset_vector;
static bool flash_ready;
static void (*tick_lock)(void), (*tick_unlock)(void);
static unsigned tick_locks; /* that are held */
static struct hal_retained_memory retained;
static enum hal_image image;
static struct hal_fault fault;
static bool faulted;

/* Whoever simulates around a board that is reset goes on counting: its clock does not begin anew. */
static void power_up(uint64_t now)
{
    for (unsigned i = 0; i < HAL_UART_COUNT; i++) {
        lines[i].rx = (struct ring){.bytes = bytes[i][0], .size = sizeof bytes[i][0]};
        lines[i].tx = (struct ring){.bytes = bytes[i][1], .size = sizeof bytes[i][1]};
        lines[i].stats = (struct hal_uart_stats){0};
        lines[i].flow = (struct flow){.on = i == HAL_UART_CONSOLE};
    }
    lines[HAL_UART_CONSOLE].rx.size = console_rx_size;
    lines[HAL_UART_CONSOLE].tx.size = console_tx_size;
    clock_ms = ticked_ms = fed_ms = now;
    unfed_ms = frame_ms = 0;
    tick_locks = 0;
    tick_asked = true;
    boot_id++;
    buses_reset();
    app_init(app_instance());
}

void memory_port_start(void)
{
    if (!flash_ready)
        memory_port_erase_all();
    cause = HAL_RESET_POWER_ON;
    memset(&retained, 0xA5, sizeof retained);
    reboots = 0;
    power_up(0);
}

void memory_port_set_clock(uint64_t ms)
{
    while (clock_ms < ms) {
        app_clock(app_instance(), (uint32_t)++clock_ms);
        buses_clock();
    }
}

void memory_port_jump(uint64_t ms)
{
    clock_ms = ms;
}

size_t memory_port_give(enum hal_uart port, const void *data, size_t n)
{
    struct line *l = &lines[port];
    const uint8_t *from = data;
    size_t taken = 0;
    for (size_t i = 0; i < n; i++)
        taken += !flow_received(&l->flow, from[i]) || ring_put(&l->rx, from[i]);
    flow_look(&l->flow, &l->rx);
    l->stats.received += (uint32_t)n;
    l->stats.rx_dropped += (uint32_t)(n - taken);
    if (port == HAL_UART_LINK)
        tick_asked = true;
    return taken;
}

void memory_port_damage(enum hal_uart port)
{
    lines[port].stats.line_errors++;
}

size_t memory_port_take(enum hal_uart port, void *data, size_t size)
{
    struct line *l = &lines[port];
    uint8_t *to = data;
    size_t n = 0;
    while (n < size && flow_next(&l->flow, &l->tx, &to[n]))
        n++;
    return n;
}

void memory_port_set_console_rings(uint32_t rx, uint32_t tx)
{
    console_rx_size = rx;
    console_tx_size = tx;
}

/* Changes whenever a byte moves in either direction on either line. */
static uint32_t movement(void)
{
    uint32_t sum = 0;
    for (unsigned i = 0; i < HAL_UART_COUNT; i++)
        sum += lines[i].rx.tail + lines[i].tx.head;
    return sum;
}

/* One turn of both contexts. Whoever calls it has set the reset vector. */
static void turn(void)
{
    if (tick_asked || clock_ms - ticked_ms >= HAL_TICK_PERIOD_MS) {
        tick_asked = false;
        ticked_ms = clock_ms;
        app_tick(app_instance());
    }
    app_background(app_instance());
}

static void restarted(void)
{
    reboots++;
    cause = HAL_RESET_REQUESTED;
    power_up(clock_ms);
}

void memory_port_set_tick_lock(void (*lock)(void), void (*unlock)(void))
{
    tick_lock = lock;
    tick_unlock = unlock;
}

void memory_port_turn(void)
{
    if (setjmp(reset_vector) != 0)
        restarted();
    else
        turn();
}

unsigned memory_port_run(void)
{
    volatile unsigned turns = 0; /* survives the jump */
    if (setjmp(reset_vector) != 0)
        restarted();
    unsigned quiet = 0;
    while (quiet < 2 && turns < TURNS_MAX) {
        uint32_t before = movement();
        turn();
        turns = turns + 1u;
        quiet = idle && movement() == before ? quiet + 1u : 0;
    }
    return turns;
}

void memory_port_reset(enum hal_reset reason)
{
    cause = reason;
    power_up(clock_ms);
}

unsigned memory_port_reboots(void)
{
    return reboots;
}

void memory_port_slow_frame(uint32_t ms)
{
    frame_ms = ms;
}

uint64_t memory_port_unfed_ms(void)
{
    uint64_t now = clock_ms - fed_ms, longest = unfed_ms > now ? unfed_ms : now;
    unfed_ms = 0;
    return longest;
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
    size_t n = ring_read(&lines[port].rx, buffer, size);
    flow_look(&lines[port].flow, &lines[port].rx);
    return n;
}

size_t hal_uart_room(enum hal_uart port)
{
    return ring_room(&lines[port].tx);
}

bool hal_uart_write(enum hal_uart port, const void *data, size_t n)
{
    if (!ring_write(&lines[port].tx, data, n))
        return false;
    if (port == HAL_UART_LINK) {
        clock_ms += frame_ms;
        frame_ms = 0;
    }
    lines[port].stats.sent += (uint32_t)n;
    return true;
}

size_t hal_uart_pump(enum hal_uart port)
{
    (void)port;
    return 0; /* the bench takes bytes from the ring itself */
}

bool hal_uart_sends_alone(void)
{
    return false;
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

static uint32_t cycles, cycles_step;

void memory_port_count_looks(uint32_t step)
{
    cycles_step = step;
}

uint32_t hal_cycles(void)
{
    return cycles += cycles_step;
}

const char *hal_cycles_unit(void)
{
    return "none";
}

const char *hal_clock_source(void)
{
    return "set by the bench";
}

void hal_tick_request(void)
{
    tick_asked = true;
}

void hal_tick_lock(void)
{
    if (tick_locks++ == 0 && tick_lock)
        tick_lock();
}

void hal_tick_unlock(void)
{
    if (--tick_locks == 0 && tick_unlock)
        tick_unlock();
}

void hal_idle(bool wait)
{
    idle = wait;
}

bool hal_watchdog_start(uint32_t timeout_ms)
{
    (void)timeout_ms;
    return false;
}

bool hal_watchdog_change(uint32_t timeout_ms)
{
    (void)timeout_ms;
    return true;
}

void hal_watchdog_feed(void)
{
    unfed_ms = clock_ms - fed_ms > unfed_ms ? clock_ms - fed_ms : unfed_ms;
    fed_ms = clock_ms;
}

const char *hal_board_name(void)
{
    return "memory";
}

const char *hal_board_text(void)
{
    return "in the bench's own process";
}

void memory_port_set_fault(const struct hal_fault *what)
{
    faulted = what != NULL;
    fault = what ? *what : (struct hal_fault){0};
}

bool hal_last_fault(struct hal_fault *last)
{
    if (faulted)
        *last = fault;
    return faulted;
}

enum hal_reset hal_reset_cause(void)
{
    return cause;
}

uint32_t hal_boot_id(void)
{
    return boot_id;
}

void memory_port_set_image(enum hal_image state)
{
    image = state;
}

enum hal_image hal_image_check(void)
{
    return image;
}

enum hal_image hal_image_watch(void)
{
    return image;
}

void *hal_retained(enum hal_retained_area area, size_t n)
{
    return hal_retained_in(&retained, area, n);
}

_Noreturn void hal_reboot(void)
{
    longjmp(reset_vector, 1);
}

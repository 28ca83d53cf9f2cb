#include "memory_transport.h"

#include <stdio.h>
#include <string.h>

#include "bench/text.h"
#include "buses.h"
#include "chips/wired.h"
#include "hal/memory/memory_port.h"
#include "pins_side.h"

#define IDLE_STEP_MS 1
#define NS_PER_MS    UINT64_C(1000000)

static uint64_t clock_ms;
static bool moved; /* bytes crossed since the firmware last ran */
static bool in_use[HAL_UART_COUNT];
static struct wired *wired;
static uint64_t unplugged_ms; /* until then the link is */

static enum hal_uart line_of(const struct transport *t)
{
    return t->context == &in_use[HAL_UART_LINK] ? HAL_UART_LINK : HAL_UART_CONSOLE;
}

static bool is_unplugged(const struct transport *t)
{
    return line_of(t) == HAL_UART_LINK && clock_ms < unplugged_ms;
}

static long memory_read(struct transport *t, void *buffer, size_t size)
{
    size_t n = memory_port_take(line_of(t), buffer, size);
    moved = moved || n > 0;
    return is_unplugged(t) ? 0 : (long)n;
}

/* A firmware that does not look at its link lets its bytes be lost, as a serial line does. */
static long memory_write(struct transport *t, const void *data, size_t n)
{
    size_t given = is_unplugged(t) ? n : memory_port_give(line_of(t), data, n);
    moved = moved || given > 0;
    return (long)(line_of(t) == HAL_UART_LINK ? n : given);
}

static void memory_turn(struct transport *t, uint64_t timeout_ms)
{
    (void)timeout_ms;
    (void)t;
    clock_ms += moved ? 0 : IDLE_STEP_MS;
    moved = false;
    memory_port_set_clock(clock_ms);
    (void)memory_port_run();
}

static uint64_t memory_now(struct transport *t)
{
    (void)t;
    return clock_ms;
}

/* Tells how the firmware has treated its chips. */
static void warn_of_broken_rules(void)
{
    unsigned n = 0;
    const char *first = wired == NULL ? "" : wiring_wrong(wired_wiring(wired), &n);
    if (n > 0) {
        (void)fprintf(stderr, "reflux-sim: warning: rules of data sheets broken: %u; first: %s\n",
                      n, first);
    }
}

static void memory_close(struct transport *t)
{
    in_use[line_of(t)] = false;
    if (line_of(t) == HAL_UART_LINK) {
        buses_set_world(NULL);
        warn_of_broken_rules();
        wired_close(wired);
        wired = NULL;
    }
}

static bool memory_wire(struct transport *t, const char *wiring, uint64_t seed, char *err,
                        size_t err_size)
{
    (void)t;
    wired = wired_open(wiring, seed, err, err_size);
    if (wired == NULL) {
        return false;
    }
    buses_set_world(wired_world(wired));
    return true;
}

static void memory_measure(struct transport *t, const char *sensor, double value)
{
    (void)t;
    wired_measure(wired, clock_ms * NS_PER_MS, sensor, value);
}

static bool memory_pins_fault(struct transport *t, const char *name, double value)
{
    char err[SIM_ERROR_SIZE], line[64];
    const char *dot = strchr(name, '.');
    (void)t;
    if (wired == NULL || dot == NULL) {
        return false;
    }
    (void)snprintf(line, sizeof(line), "%.*s", (int)(dot - name), name);
    return wired_fault(wired, clock_ms * NS_PER_MS, line, dot + 1, value, err, sizeof(err));
}

static bool memory_loads(struct transport *t, double *ns, size_t n)
{
    (void)t;
    /* As late in the millisecond as those of a board are, so that a tick has as much of the command before it. */
    return wired_loads(wired, clock_ms * NS_PER_MS + PINS_DONE_NS, ns) == n;
}

/* Of the faults of a virtual board this one is left, because here there are no registers. */
static bool memory_fault(struct transport *t, const char *name, double value)
{
    (void)t;
    if (strcmp(name, "unplug_link") != 0) {
        return false;
    }
    unplugged_ms = clock_ms + (uint64_t)(value * 1000.0);
    return true;
}

static void memory_clock(struct transport *t, uint64_t *now_ns, uint64_t *began_ns)
{
    (void)t;
    *now_ns = clock_ms * NS_PER_MS;
    *began_ns = 0; /* a reset does not set it back */
}

static const struct transport_ops memory_ops = {.read = memory_read,
                                                .write = memory_write,
                                                .turn = memory_turn,
                                                .now_ms = memory_now,
                                                .fault = memory_fault,
                                                .wire = memory_wire,
                                                .measure = memory_measure,
                                                .pins_fault = memory_pins_fault,
                                                .loads = memory_loads,
                                                .clock = memory_clock,
                                                .close = memory_close};

/* The first one opened is the link, the second the console: so reflux_sim() opens them. */
bool memory_transport_open(struct transport *t, const char *rest, char *err, size_t err_size)
{
    enum hal_uart line = in_use[HAL_UART_LINK] ? HAL_UART_CONSOLE : HAL_UART_LINK;
    if (rest[0] != '\0' || in_use[line]) {
        return sim_fail(err, err_size, "memory: there is one link and one console, without a name");
    }
    if (line == HAL_UART_LINK) {
        unplugged_ms = 0;
        memory_port_start();
    }
    in_use[line] = true;
    t->context = &in_use[line];
    t->ops = &memory_ops;
    return true;
}

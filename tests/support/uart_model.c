#include "uart_model.h"

#include "hal/flow.h"
#include "memory_port.h"

#define QUIET_MS 1500
#define LIMIT_MS 600000

/* The time of one byte on the line towards the board. */
static void send(struct uart_model *m, const char *text, size_t n)
{
    if (m->sent == n || (m->stopped && m->coasting == 0))
        return;
    if (m->stopped)
        m->coasting--;
    m->dropped += memory_port_give(HAL_UART_CONSOLE, text + m->sent, 1) == 0;
    m->sent++;
}

/* And on the line from it. Returns whether anything came. */
static bool hear(struct uart_model *m)
{
    uint8_t byte;
    if (memory_port_take(HAL_UART_CONSOLE, &byte, 1) == 0)
        return false;
    if (byte == FLOW_XOFF) {
        m->xoffs++;
        m->stopped = m->honours;
        m->coasting = m->latency;
    } else if (byte == FLOW_XON) {
        m->xons++;
        m->stopped = false;
    } else if (m->n_heard < UART_HEARD_MAX - 1) {
        m->heard[m->n_heard++] = (char)byte;
        m->heard[m->n_heard] = '\0';
    }
    return true;
}

static void think(struct uart_model *m)
{
    if (m->clock_ms < m->busy_until_ms)
        return;
    memory_port_turn();
    m->turns++;
    bool slow = m->slow_every && m->turns % m->slow_every == 0;
    m->busy_until_ms = m->clock_ms + (slow ? m->slow_ms : m->turn_ms);
}

void uart_model_paste(struct uart_model *m, const char *text, size_t n)
{
    unsigned quiet = 0;
    for (m->ms = 0; m->ms < LIMIT_MS && quiet < QUIET_MS; m->ms++) {
        memory_port_set_clock(++m->clock_ms);
        bool any = false;
        think(m);
        for (m->byte_times += UART_BYTES_PER_MS; m->byte_times >= 1.0; m->byte_times -= 1.0) {
            any = hear(m) || any;
            send(m, text, n);
        }
        quiet = m->sent == n && !any ? quiet + 1 : 0;
        m->stop_ms = m->stopped ? m->stop_ms + 1 : 0;
        if (m->stop_ms > m->longest_stop_ms)
            m->longest_stop_ms = m->stop_ms;
    }
    m->ms -= quiet;
}

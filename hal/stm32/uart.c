/* USART1 is the console (PA9 TX, PA10 RX), USART2 the plant link (PA2 TX, PA3 RX), both 115200 8N1.
 *
 * Reception is by interrupt. Transmission is by polling in hal_uart_pump() and, on the chip, also by the
 * transmit interrupt, so that a long job in the main loop does not hold a reply back: the emulator raises no
 * such interrupt but takes every byte at once, so there the first pump empties the ring.
 */
#include "hal/uart.h"
#include "base/error.h"
#include "board.h"
#include "hal/flow.h"
#include "hal/ring.h"
#include "hal/tick.h"
#include "registers.h"

#define BAUD 115200u

void interrupt_usart1(void);
void interrupt_usart2(void);

/* Powers of two. The terminal may be slow to stop (hal/flow.h). To the console: a reply at once (CONSOLE_REPLY_ROOM),
 * the rest as the line takes it. The link: two of the longest frames either way. */
#ifndef UART_CONSOLE_RX
#define UART_CONSOLE_RX 1024
#define UART_CONSOLE_TX 1024
#define UART_LINK_RX    512
#define UART_LINK_TX    512
#endif

static uint8_t console_rx[UART_CONSOLE_RX], console_tx[UART_CONSOLE_TX];
#if HAL_LINK
static uint8_t link_rx[UART_LINK_RX], link_tx[UART_LINK_TX];
#define LINK_PORT                                                                                  \
    [HAL_UART_LINK] = {.base = USART2_BASE, .rx = RING_OVER(link_rx), .tx = RING_OVER(link_tx)},
#else
#define LINK_PORT
#endif

static struct uart {
    uint32_t base;
    struct ring rx, tx;
    struct flow flow;
    struct hal_uart_stats stats;
} uarts[HAL_UART_COUNT] = {[HAL_UART_CONSOLE] = {.base = USART1_BASE,
                                                 .rx = RING_OVER(console_rx),
                                                 .tx = RING_OVER(console_tx),
                                                 .flow = {.on = true}},
                           LINK_PORT};

/* True while the terminal has been asked to wait: a reset would leave it waiting for ever. At power-on, with any
 * bits here, an XON too many does no harm. */
static uint32_t terminal_waits __attribute__((section(".noinit")));

/* Gives the line what it takes at once; no more than a ring-full. The interrupt of this port must be held off. */
static void transmit(struct uart *u)
{
    uint32_t base = u->base;
    uint8_t byte;
    if (u->flow.pending && (USART_SR(base) & USART_SR_TXE) != 0 &&
        flow_next(&u->flow, &u->tx, &byte)) {
        USART_DR(base) = byte;
        u->stats.sent++;
    }
    for (unsigned piece = 0; piece < 2;
         piece++) { /* up to the end of the ring, then its beginning */
        const uint8_t *bytes = NULL;
        size_t n = flow_run(&u->flow, &u->tx, &bytes), given = 0;
        while (given < n && (USART_SR(base) & USART_SR_TXE) != 0) {
            USART_DR(base) = bytes[given++];
        }
        ring_skip(&u->tx, given);
        u->stats.sent += (uint32_t)given;
    }
    if (flow_ready(&u->flow, &u->tx) > 0) {
        USART_CR1(u->base) |= USART_CR1_TXEIE;
    } else {
        USART_CR1(u->base) &= ~USART_CR1_TXEIE;
    }
}

/* Looks at the receive ring and says at once what there is to say. The interrupt must be held off. */
static void regulate(struct uart *u)
{
    if (!u->flow.on) {
        return;
    }
    flow_look(&u->flow, &u->rx);
    terminal_waits = u->flow.holding;
    if (u->flow.pending) {
        transmit(u);
    }
}

/* Returns whether the tick context has something to look at. */
static bool receive(struct uart *u, uint32_t status)
{
    uint8_t byte = (uint8_t)USART_DR(u->base); /* reading SR, then DR, clears the error flags */

    if ((status & (USART_SR_PE | USART_SR_FE | USART_SR_NE | USART_SR_ORE)) != 0) {
        u->stats.line_errors++;
    }
    if ((status & USART_SR_RXNE) == 0 ||
        (status & (USART_SR_PE | USART_SR_FE | USART_SR_NE)) != 0) {
        return false; /* a damaged byte is worth no more than a lost one, and a break is no delimiter */
    }
    u->stats.received++;
    if (!flow_received(&u->flow, byte)) {
        transmit(u); /* XON sets waiting output going again */
        return false;
    }
    if (!ring_put(&u->rx, byte)) {
        u->stats.rx_dropped++;
    }
    if (u == &uarts[HAL_UART_CONSOLE]) {
        tick_work_seen(); /* of room in the transmit ring the main loop hears with the next millisecond */
    }
    regulate(u);
    return byte == 0 || ring_used(&u->rx) > u->rx.size / 2u;
}

static bool serve(struct uart *u)
{
    uint32_t status = USART_SR(u->base);
    bool look = false;

    if ((status & (USART_SR_RXNE | USART_SR_ORE)) != 0) {
        look = receive(u, status);
    }
    if ((USART_CR1(u->base) & USART_CR1_TXEIE) != 0) {
        transmit(u);
    }
    return look;
}

void interrupt_usart1(void)
{
    (void)serve(&uarts[HAL_UART_CONSOLE]);
}

/* A frame ends with a zero byte (link/frame.h); nothing can be done before that. The half-full rule is for a
 * line full of noise without one. */
#if HAL_LINK
void interrupt_usart2(void)
{
    if (serve(&uarts[HAL_UART_LINK])) {
        hal_tick_request();
    }
}
#endif

void uart_start(void)
{
    if (terminal_waits != 0) {
        uarts[HAL_UART_CONSOLE].flow.pending = FLOW_XON;
    }
    terminal_waits = 0;
    pins_start();
    USART_BRR(USART1_BASE) = (clock_apb2_hz() + BAUD / 2u) / BAUD;
    if (HAL_LINK) {
        USART_BRR(USART2_BASE) = (clock_apb1_hz() + BAUD / 2u) / BAUD;
    }
    for (unsigned i = 0; i < HAL_UART_COUNT; i++) {
        USART_CR1(uarts[i].base) = USART_CR1_UE | USART_CR1_TE | USART_CR1_RE | USART_CR1_RXNEIE;
    }
    NVIC_IPR(USART1_IRQ) = PRIORITY_UART;
    if (HAL_LINK) {
        NVIC_IPR(USART2_IRQ) = PRIORITY_UART;
    }
    NVIC_ISER(USART1_IRQ / 32u) = BIT(USART1_IRQ % 32u) | (HAL_LINK ? BIT(USART2_IRQ % 32u) : 0);
}

size_t hal_uart_read(enum hal_uart port, uint8_t *buffer, size_t size)
{
    size_t n = ring_read(&uarts[port].rx, buffer, size);
    if (n != 0 && uarts[port].flow.holding) {
        uint32_t before = mask_raise(PRIORITY_UART);
        regulate(&uarts[port]);
        mask_restore(before);
    }
    return n;
}

size_t hal_uart_room(enum hal_uart port)
{
    return ring_room(&uarts[port].tx);
}

bool hal_uart_write(enum hal_uart port, const void *data, size_t n)
{
    return ring_write(&uarts[port].tx, data, n);
}

size_t hal_uart_pump(enum hal_uart port)
{
    struct uart *u = &uarts[port];
    uint32_t before = mask_raise(PRIORITY_UART); /* callable from both contexts */
    transmit(u);
    mask_restore(before);
    return flow_ready(&u->flow, &u->tx) + ((USART_SR(u->base) & USART_SR_TC) == 0 ? 1u : 0u);
}

bool hal_uart_sends_alone(void)
{
    return !clock_is_model();
}

bool hal_uart_connected(enum hal_uart port)
{
    (void)port;
    return true; /* three wires do not tell */
}

void hal_uart_get_stats(enum hal_uart port, struct hal_uart_stats *stats)
{
    *stats = uarts[port].stats;
}

void uart_hold_interrupts(bool hold)
{
    static uint32_t before[HAL_UART_COUNT];
    for (unsigned i = 0; i < HAL_UART_COUNT; i++) {
        uint32_t held = USART_CR1_TXEIE | (i == HAL_UART_LINK ? 0 : USART_CR1_RXNEIE);
        if (hold) {
            before[i] = USART_CR1(uarts[i].base);
        }
        USART_CR1(uarts[i].base) = hold ? before[i] & ~held : before[i];
    }
}

#if HAL_LINK
RAM_CODE("link") bool uart_serve_link(const uint8_t *more)
{
    struct uart *u = &uarts[HAL_UART_LINK];
    uint32_t base = u->base, status = USART_SR(base), head = u->rx.head, tail = u->tx.tail;
    if ((status & (USART_SR_RXNE | USART_SR_ORE)) != 0) {
        uint8_t byte = (uint8_t)USART_DR(base);
        bool good = (status & USART_SR_RXNE) != 0 &&
                    (status & (USART_SR_PE | USART_SR_FE | USART_SR_NE)) == 0;
        if (good && head - u->rx.tail < u->rx.size) {
            u->rx.bytes[head & (u->rx.size - 1u)] = byte;
            u->rx.head = head + 1u;
        }
    }
    if ((status & USART_SR_TXE) == 0) {
        return false;
    }
    if (u->tx.head != tail) {
        USART_DR(base) = u->tx.bytes[tail & (u->tx.size - 1u)];
        u->tx.tail = tail + 1u;
        return false;
    }
    if (more == NULL) {
        return false;
    }
    USART_DR(base) = *more;
    return true;
}
#endif

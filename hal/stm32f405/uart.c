/* USART1 is the console (PA9 TX, PA10 RX), USART2 the plant link (PA2 TX, PA3 RX), both 115200 8N1.
 *
 * Reception is by interrupt. Transmission is by polling in hal_uart_pump() and, on the chip, also by the
 * transmit interrupt, so that a long job in the main loop does not hold a reply back: the emulator raises no
 * such interrupt but takes every byte at once, so there the first pump empties the ring.
 */
#include "hal/uart.h"
#include "base/error.h"
#include "board.h"
#include "hal/ring.h"
#include "hal/tick.h"
#include "registers.h"

#define BAUD 115200u

void interrupt_usart1(void);
void interrupt_usart2(void);

static uint8_t console_rx[1024], console_tx[4096], link_rx[1024], link_tx[1024];

static struct uart {
    uint32_t base;
    struct ring rx, tx;
    struct hal_uart_stats stats;
} uarts[HAL_UART_COUNT] = {
    [HAL_UART_CONSOLE] = {.base = USART1_BASE,
                          .rx = RING_OVER(console_rx),
                          .tx = RING_OVER(console_tx)},
    [HAL_UART_LINK] = {.base = USART2_BASE, .rx = RING_OVER(link_rx), .tx = RING_OVER(link_tx)},
};

/* Gives the line what it takes at once; no more than a ring-full. The interrupt of this port must be held off. */
static void transmit(struct uart *u)
{
    uint8_t byte;
    for (uint32_t i = 0; i < u->tx.size && (USART_SR(u->base) & USART_SR_TXE) != 0; i++) {
        if (!ring_get(&u->tx, &byte)) {
            break;
        }
        USART_DR(u->base) = byte;
        u->stats.sent++;
    }
    if (ring_used(&u->tx) > 0) {
        USART_CR1(u->base) |= USART_CR1_TXEIE;
    } else {
        USART_CR1(u->base) &= ~USART_CR1_TXEIE;
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
    if (!ring_put(&u->rx, byte)) {
        u->stats.rx_dropped++;
    }
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
    tick_work_seen();
}

/* A frame ends with a zero byte (link/frame.h); nothing can be done before that. The half-full rule is for a
 * line full of noise without one. */
void interrupt_usart2(void)
{
    if (serve(&uarts[HAL_UART_LINK])) {
        hal_tick_request();
    }
    tick_work_seen();
}

void uart_start(void)
{
    RCC_AHB1ENR |= RCC_AHB1ENR_GPIOA;
    RCC_APB1ENR |= RCC_APB1ENR_USART2;
    RCC_APB2ENR |= RCC_APB2ENR_USART1;
    (void)RCC_APB2ENR;
    /* Alternate function 7, and a pull-up where a line may be left open. */
    GPIOA_AFRL = (GPIOA_AFRL & ~0x0000FF00u) | 0x00007700u;
    GPIOA_AFRH = (GPIOA_AFRH & ~0x00000FF0u) | 0x00000770u;
    GPIOA_PUPDR = (GPIOA_PUPDR & ~((3u << 6) | (3u << 20))) | (1u << 6) | (1u << 20);
    GPIOA_MODER = (GPIOA_MODER & ~((15u << 4) | (15u << 18))) | (10u << 4) | (10u << 18);

    USART_BRR(USART1_BASE) = (clock_apb2_hz() + BAUD / 2u) / BAUD;
    USART_BRR(USART2_BASE) = (clock_apb1_hz() + BAUD / 2u) / BAUD;
    for (unsigned i = 0; i < HAL_UART_COUNT; i++) {
        USART_CR1(uarts[i].base) = USART_CR1_UE | USART_CR1_TE | USART_CR1_RE | USART_CR1_RXNEIE;
    }
    NVIC_IPR(USART1_IRQ) = PRIORITY_UART;
    NVIC_IPR(USART2_IRQ) = PRIORITY_UART;
    NVIC_ISER(USART1_IRQ / 32u) = BIT(USART1_IRQ % 32u) | BIT(USART2_IRQ % 32u);
}

size_t hal_uart_read(enum hal_uart port, uint8_t *buffer, size_t size)
{
    return ring_read(&uarts[port].rx, buffer, size);
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
    return ring_used(&u->tx);
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

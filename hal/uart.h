/* Two byte streams: the console and the plant link.
 *
 * Rules
 *  1. Nothing here waits. read() takes what has arrived, write() queues what fits.
 *  2. One writer and one reader per stream: the console belongs to the main loop, the link to the tick.
 *  3. Received bytes are put into a ring by the receive interrupt (or the operating system); what does not
 *     fit is dropped and counted, never stops the receiver. The end of a frame on the link (a zero byte),
 *     or its ring half full, requests the tick context (hal/tick.h).
 *  4. The console's line honours XON and XOFF and sends them (hal/flow.h); the link's is binary.
 *  5. Transmission is a ring drained by hal_uart_pump(), because some boards raise no transmit interrupt.
 *     pump() moves bytes while the hardware takes them at once and returns.
 */
#ifndef REFLUX_HAL_UART_H
#define REFLUX_HAL_UART_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum hal_uart {
    HAL_UART_CONSOLE = 0, /* text, 115200 8N1 */
    HAL_UART_LINK = 1     /* plant link frames, 115200 8N1 */
};

/* Ports that the board has: no link on boards whose plant is always at their own pins (exchange/config.h). */
#if defined(CONFIG_LINK) && CONFIG_LINK == 0
#define HAL_LINK 0
#else
#define HAL_LINK 1
#endif
#define HAL_UART_COUNT (1 + HAL_LINK)

struct hal_uart_stats {
    uint32_t received;    /* bytes taken from the line */
    uint32_t sent;        /* bytes given to the line */
    uint32_t rx_dropped;  /* bytes lost because the receive ring was full */
    uint32_t line_errors; /* framing, parity, noise, overrun reported by the hardware */
};

/* Takes up to size received bytes; returns how many. */
size_t hal_uart_read(enum hal_uart port, uint8_t *buffer, size_t size);

/* Free bytes in the transmit ring. */
size_t hal_uart_room(enum hal_uart port);

/* Queues all n bytes or, where they do not fit, none; returns whether they were taken. */
bool hal_uart_write(enum hal_uart port, const void *data, size_t n);

/* Moves queued bytes to the line as far as it takes them now. Returns the bytes that wait for the line, of which none
 * do while the other side has sent XOFF, and 1 more while the port still sends: a reset would cut that byte off. */
size_t hal_uart_pump(enum hal_uart port);

/* Interrupts send what is queued: nobody has to pump for it, and the main loop may sleep meanwhile. */
bool hal_uart_sends_alone(void);

/* False where the port knows that nobody is at the other end (a closed pseudo-terminal). */
bool hal_uart_connected(enum hal_uart port);

void hal_uart_get_stats(enum hal_uart port, struct hal_uart_stats *stats);

#endif

/* A serial line at 115200 baud between a terminal that pastes and the board in memory, in steps of a millisecond.
 *
 * Bytes pass at 11.52 a millisecond each way. What arrives while the receive ring is full is lost, as on a wire. The
 * main loop takes time for its turns; the receive path does not wait for it. A terminal that honours XOFF goes on for
 * as many bytes as were under way already (in its own buffer, and while the XOFF travelled).
 */
#ifndef REFLUX_TESTS_UART_MODEL_H
#define REFLUX_TESTS_UART_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define UART_BYTES_PER_MS 11.52
#define UART_HEARD_MAX    60000

struct uart_model {
    /* The terminal */
    bool honours;     /* XON and XOFF */
    unsigned latency; /* bytes it still sends after an XOFF has come */
    /* The board */
    unsigned turn_ms;             /* time of a turn of the main loop */
    unsigned slow_every, slow_ms; /* every n-th turn takes this long instead; 0 = none */
    /* Events so far */
    unsigned turns, xoffs, xons, dropped, ms, longest_stop_ms;
    size_t sent;
    char heard[UART_HEARD_MAX]; /* without XON and XOFF */
    size_t n_heard;

    bool stopped;
    unsigned coasting, stop_ms;
    double byte_times; /* of this millisecond */
    uint64_t clock_ms, busy_until_ms;
};

/* Pastes text from board time `clock_ms` on, until all is sent and the board has been quiet for a while. */
void uart_model_paste(struct uart_model *m, const char *text, size_t n);

#endif

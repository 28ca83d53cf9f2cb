/* One serial line of the host board: a pseudo-terminal, a unix socket that is listened on, or standard input
 * and output. Never waits. */
#ifndef REFLUX_HAL_HOST_LINE_H
#define REFLUX_HAL_HOST_LINE_H

#include <poll.h>
#include <stdbool.h>

#include "hal/flow.h"
#include "hal/ring.h"
#include "hal/uart.h"

#define LINE_RING 16384
#define LINE_FDS  2 /* most descriptors one line waits for */

struct line {
    enum { LINE_NONE, LINE_PTY, LINE_SOCKET, LINE_STDIO } kind;
    int listener;            /* socket: where peers arrive */
    int in, out;             /* -1 while nobody is there */
    int slave;               /* pty: held open, so that a terminal that leaves is no hang-up */
    int in_flags, out_flags; /* stdio: how the descriptors were found */
    char path[108];
    uint8_t rx_bytes[LINE_RING], tx_bytes[LINE_RING];
    struct ring rx, tx;
    struct flow flow;
    struct hal_uart_stats stats;
    bool blocked; /* the other side takes nothing now: wait for room */
};

/* Has it one of the forms below? False with one line in err. */
bool line_known(const char *where, char *err, size_t err_size);
/* where: "pty", "pty:LINK", "socket:PATH", "stdio". False with one line in err. */
bool line_open(struct line *line, const char *where, char *err, size_t err_size);
void line_close(struct line *line);
/* Adds what to wait for to fds (room for LINE_FDS); returns how many were added. */
int line_watch(const struct line *line, struct pollfd *fds);
/* Takes what poll reported. Returns whether bytes arrived. */
bool line_serve(struct line *line, short events);
/* Writes queued bytes; drops them where nobody is there. Returns the bytes that wait for the line. */
size_t line_flush(struct line *line);

#endif

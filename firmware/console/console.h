/* The console: a line of text in, lines of text out, on the main loop.
 *
 * For people: echo, editing (line_editor.h), a prompt. For scripts (`mode machine`): no echo, and every command
 * is answered by zero or more lines and then exactly one `ok` or `err CODE text`. Asynchronous lines are whole
 * and tagged, so that they never break a reply: `H,` telemetry header, `T,` telemetry row, `!` event.
 *
 * Nothing here waits: long listings go out line by line as the transmit ring takes them, and input is left
 * in the receive ring meanwhile.
 */
#ifndef REFLUX_CONSOLE_CONSOLE_H
#define REFLUX_CONSOLE_CONSOLE_H

#include "console/line_editor.h"
#include "console/reply.h"

#define CONSOLE_LINE_MAX LINE_EDITOR_MAX /* characters of input */
#ifndef CONSOLE_RX_BLOCK
#define CONSOLE_RX_BLOCK 32 /* bytes taken from the port at a time */
#endif

struct console {
    struct client client; /* who types here, and the reply under way */
    struct line_editor editor;
    uint8_t rx[CONSOLE_RX_BLOCK];
    unsigned rx_n, rx_next;

    uint32_t header_serial;          /* of the plan whose telemetry header was printed last */
    const struct plan *header_plan;  /* telemetry header being written, or NULL */
    const struct telemetry_row *row; /* row being written, or NULL */
    unsigned piece;                  /* of either, next */
    uint32_t lost_reported;          /* telemetry rows reported as lost */
    uint32_t bytes_lost;             /* on the line, before the line under way */
};

void console_init(struct console *c, struct operate *door);
/* Takes one turn. Returns whether there was anything to do. */
bool console_poll(struct console *c);

#endif

/* The firmware's console as a program uses it (docs/use/console.md, `mode machine`): lines out, replies in, and the
 * asynchronous lines that may come at any time: `H,` telemetry header, `T,<format>,<sample number>,` telemetry row,
 * `!` event or alarm.
 * It never waits: console_turn() takes what has arrived.
 */
#ifndef REFLUX_HOST_SIM_CONSOLE_DRIVER_H
#define REFLUX_HOST_SIM_CONSOLE_DRIVER_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "bench/transport.h"

#define CONSOLE_LINE_SIZE  8192
#define CONSOLE_REPLY_SIZE 200

enum console_reply { REPLY_NONE, REPLY_OK, REPLY_ERR };

struct console {
    struct transport *transport;
    FILE *transcript;    /* may be NULL: every line with its direction */
    FILE *telemetry;     /* may be NULL: H and T lines */
    double plant_time_s; /* for the transcript, set by the owner */
    bool before_run;     /* likewise: rows are no samples of the run, telemetry does not get them */

    char line[CONSOLE_LINE_SIZE];
    size_t n;
    char last_sent[256];
    enum console_reply reply;
    char reply_text[CONSOLE_REPLY_SIZE]; /* of an err */
    uint32_t replies;                    /* ok and err lines since start */

    char events[1024]; /* codes announced since console_watch(), each between two '|' */

    bool header;        /* an H line was seen since the last start or `log off` */
    bool log_on;        /* telemetry was asked for, or its header came */
    bool thinned;       /* `log on N`: rows of some samples only, none is waited for */
    char log_line[256]; /* the last acknowledged "log on ...", to send again after a restart */
    bool have_row;
    uint32_t last_row;
    uint64_t rows;
    char error[256];
};

void console_driver_init(struct console *c, struct transport *t, FILE *transcript, FILE *telemetry);

/* The firmware was restarted: it echoes again, and its telemetry is off. */
void console_forget(struct console *c);

/* Sends one line and starts waiting for its reply; false when the peer is gone. */
bool console_send(struct console *c, const char *line);

/* Takes what has arrived; false when the peer is gone or a line does not end: reason in c->error. */
bool console_turn(struct console *c);

/* Forgets the events announced so far. */
void console_watch(struct console *c);
/* Has an event with one of these codes, separated by '|', been announced since? */
bool console_announced(const struct console *c, const char *codes);

/* Telemetry is on, and the row of this sample has not come yet. */
bool console_row_missing(const struct console *c, uint32_t number);

#endif

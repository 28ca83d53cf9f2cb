/* The console: a line of text in, lines of text out, on the main loop.
 *
 * For people: echo, backspace, a prompt. For scripts (`mode machine`): no echo, and every command is answered
 * by zero or more lines and then exactly one `ok` or `err CODE text`. Asynchronous lines are whole and
 * tagged, so that they never break a reply: `H,` telemetry header, `T,` telemetry row, `!` event.
 *
 * Nothing here waits: long listings go out line by line as the transmit ring takes them, and input is left
 * in the receive ring meanwhile.
 */
#ifndef REFLUX_SERVICE_CONSOLE_H
#define REFLUX_SERVICE_CONSOLE_H

#include "service/service.h"

#define CONSOLE_LINE_MAX   200 /* characters of input */
#define CONSOLE_OUTPUT_MAX 240 /* characters of an ordinary line of output */
#define CONSOLE_WORDS      10

struct console;

/* Puts the n-th line of a listing into *line; false past the end. A line left empty is not printed. */
typedef bool (*console_listing)(struct console *c, unsigned n, struct text *line);

struct console {
    struct service *service;
    bool machine;
    char line[CONSOLE_LINE_MAX + 1];
    unsigned n;
    bool overlong, garbled; /* the line under way will be refused */
    char last;              /* last character, to take CR LF as one end */
    uint8_t rx[32];
    unsigned rx_n, rx_at;

    console_listing listing; /* under way */
    unsigned listing_at;
    char argument[CONSOLE_LINE_MAX + 1]; /* of the listing */

    uint32_t header;    /* serial of the plan whose telemetry header was printed last */
    bool header_asked;  /* `log on` is answered once the header is out */
    uint32_t lost_told; /* telemetry rows reported as lost */
    bool reboot;        /* after the reply has gone out */
    struct {
        uint32_t lines, errors, dropped;
    } stats;
};

void console_init(struct console *c, struct service *service);
/* One turn. Returns whether there was anything to do. */
bool console_poll(struct console *c);

/* For the commands */
void console_list(struct console *c, console_listing listing, const char *argument);
void console_ok(struct console *c);
/* err CODE text */
void console_err(struct console *c, enum err code, const char *text);
/* err CODE subject: text; either part may be NULL */
void console_err_about(struct console *c, enum err code, const char *subject, const char *text);
/* One whole line. */
void console_print(struct console *c, const char *text);

struct console_command {
    const char *name;
    const char *arguments;
    const char *help;
    unsigned lowest, highest; /* words after the name */
    void (*run)(struct console *c, unsigned n, char **word);
};

extern const struct console_command console_commands[];
extern const unsigned console_command_count;

/* An event as text: time, level, code, subject, value, words. */
void event_line(const struct event *e, struct text *line);

/* Commands by subject */
void command_list(struct console *c, unsigned n, char **word);
void command_get(struct console *c, unsigned n, char **word);
void command_set(struct console *c, unsigned n, char **word);
void command_diff(struct console *c, unsigned n, char **word);
void command_begin(struct console *c, unsigned n, char **word);
void command_apply(struct console *c, unsigned n, char **word);
void command_abandon(struct console *c, unsigned n, char **word);
bool parameter_help(struct console *c, unsigned n, struct text *line);

void command_loop(struct console *c, unsigned n, char **word);
void command_mode(struct console *c, unsigned n, char **word);
void command_sp(struct console *c, unsigned n, char **word);
void command_out(struct console *c, unsigned n, char **word);
void command_tune(struct console *c, unsigned n, char **word);

#endif

/* Replies: the lines of text with which a console answers a command. The commands (console_*.c) see this header, not the console.
 *
 * A command gets a struct client. It reads `service`, acts through `session`, and answers exactly once: with reply_ok(), with
 * reply_err() or its like, with reply_answer(), or with reply_list(), whose lines go out one by one and end with `ok`.
 */
#ifndef REFLUX_CONSOLE_REPLY_H
#define REFLUX_CONSOLE_REPLY_H

#include "operate/operate.h"

#ifndef CONSOLE_OUTPUT_MAX
#define CONSOLE_OUTPUT_MAX 240 /* characters of an ordinary line of output */
#endif
#ifndef CONSOLE_REPLY_ROOM
#define CONSOLE_REPLY_ROOM (3 * CONSOLE_OUTPUT_MAX) /* a reply is at most a few lines */
#endif
#define REPLY_ARGUMENT_MAX 39 /* characters: longer than any name */

/* A channel is configured, but not in the plant. */
static inline const char *not_announced(const struct service *s)
{
    return pins_leave_link(&service_in_force(s)->config.pins) ? "not announced by the plant"
                                                              : "in no row of chan or out";
}

struct client;

/* Suggests a word in place of one that is unknown. On a board without it this is empty. */
#if CONFIG_PEOPLE
struct console_command;
struct reply_hint {
    /* Writes "; did you mean `bottom`?", or nothing. channel: the word should name a channel or a loop. */
    void (*write)(const struct client *c, const char *word, bool channel, struct text *line);
    const struct console_command *command; /* whose refusals come next; NULL: its name is unknown */
};
#else
struct reply_hint {
};
#endif

/* Puts the n-th line of a listing into *line; false past the end. A line left empty is not printed. */
typedef bool (*reply_listing)(struct client *c, unsigned n, struct text *line);

/* Counts since the start. */
struct reply_counts {
    uint32_t lines;   /* of input */
    uint32_t errors;  /* replies `err` */
    uint32_t dropped; /* lines of output that found no room */
};

/* Files other than reply.c touch `service`, `session` and `argument` only. */
struct client {
    struct service *service; /* to read; acts go through `session` */
    struct session session;
    char argument[REPLY_ARGUMENT_MAX + 1]; /* of the listing under way */
    bool machine;
    bool header_due;
    bool reboot_due;
    reply_listing listing; /* under way, or NULL */
    unsigned listing_line; /* next */
    struct reply_counts counts;
    struct reply_hint hint;
};

void client_init(struct client *c, struct operate *door);

/* Settings in force: names by index are of these. */
static inline const struct config *client_settings(const struct client *c)
{
    return operate_in_force(&c->session);
}

#if CONFIG_PEOPLE
/* Writes a suggestion behind a refusal of an unknown word, where there is one. */
static inline void reply_hint(const struct client *c, enum err code, const char *word, bool channel,
                              struct text *line)
{
    if (code == ERR_UNKNOWN && word && c->hint.write)
        c->hint.write(c, word, channel, line);
}
#else
static inline void reply_hint(const struct client *c, enum err code, const char *word, bool channel,
                              struct text *line)
{
    (void)c;
    (void)code;
    (void)word;
    (void)channel;
    (void)line;
}
#endif

/* Prints one whole line, or none where the transmit ring has no room for it. */
void reply_print(struct client *c, const char *text);
/* Writes "> " for people, nothing for scripts. */
void reply_prompt(const struct client *c);
const char *reply_line_end(const struct client *c);

void reply_ok(struct client *c);
/* err CODE text */
void reply_err(struct client *c, enum err code, const char *text);
/* err CODE subject: text; either part may be NULL */
void reply_err_about(struct client *c, enum err code, const char *subject, const char *text);
/* Answers with what the door said: ok, or err CODE and the reason in words. */
void reply_answer(struct client *c, enum err code, const struct answer *answer);
/* Reads a word as a number. False: refused and answered; `what` names what the command wants. */
bool reply_number(struct client *c, const char *text, const char *what, float *x);

/* Writes a reading: four significant digits for people, for scripts all there are. */
void reply_value(const struct client *c, struct text *line, float x);
/* The same with its unit: "78.53 degC" */
void reply_amount(const struct client *c, struct text *line, float x, const char *unit);

/* Begins a listing. */
void reply_list(struct client *c, reply_listing listing, const char *argument);
/* Prints the next lines of the listing under way, as many as there is room for. Returns whether it printed any. */
bool reply_list_lines(struct client *c);

/* A listing is under way. */
static inline bool reply_is_listing(const struct client *c)
{
    return c->listing != NULL;
}
/* A listing, a save or a load is under way: its reply is not complete. */
static inline bool reply_is_pending(const struct client *c)
{
    return c->listing || operate_waits(&c->session);
}

/* Puts off the `ok` until the telemetry header has been printed. */
static inline void reply_after_header(struct client *c)
{
    c->header_due = true;
}
static inline bool reply_header_is_due(const struct client *c)
{
    return c->header_due;
}
/* The header has been printed. */
void reply_header_done(struct client *c);

/* Restarts the board once the reply has gone out. */
static inline void reply_then_reboot(struct client *c)
{
    c->reboot_due = true;
}
static inline bool reply_reboot_is_due(const struct client *c)
{
    return c->reboot_due;
}

/* A script is at the console, and no person: `mode machine`. */
static inline bool client_is_machine(const struct client *c)
{
    return c->machine;
}
static inline void client_set_machine(struct client *c, bool machine)
{
    c->machine = machine;
}

static inline void reply_count_line(struct client *c)
{
    c->counts.lines++;
}
static inline void reply_count_dropped(struct client *c)
{
    c->counts.dropped++;
}
static inline const struct reply_counts *reply_counts(const struct client *c)
{
    return &c->counts;
}

#endif

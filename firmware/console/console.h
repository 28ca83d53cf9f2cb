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

#include "console/commands.h"
#include "console/line_editor.h"
#include "operate/operate.h"

#define CONSOLE_LINE_MAX LINE_EDITOR_MAX /* characters of input */
#ifndef CONSOLE_OUTPUT_MAX
#define CONSOLE_OUTPUT_MAX 240 /* characters of an ordinary line of output */
#endif
#ifndef CONSOLE_RX_BLOCK
#define CONSOLE_RX_BLOCK 32 /* bytes taken from the port at a time */
#endif
#define CONSOLE_WORDS        10
#define CONSOLE_ARGUMENT_MAX 39 /* characters: longer than any name */
#ifndef CONSOLE_REPLY_ROOM
#define CONSOLE_REPLY_ROOM (3 * CONSOLE_OUTPUT_MAX) /* a reply is at most a few lines */
#endif

struct console;

/* Puts the n-th line of a listing into *line; false past the end. A line left empty is not printed. */
typedef bool (*console_listing)(struct console *c, unsigned n, struct text *line);

struct console {
    struct service *service; /* to look at; what is done goes through `session` */
    struct session session;
    bool machine;
    struct line_editor editor;
    uint8_t rx[CONSOLE_RX_BLOCK];
    unsigned rx_n, rx_at;

    console_listing listing; /* under way */
    unsigned listing_at;
    char argument[CONSOLE_ARGUMENT_MAX + 1]; /* of the listing */

    uint32_t header;              /* serial of the plan whose telemetry header was printed last */
    const struct plan *header_of; /* telemetry header being written, or NULL */
    const struct telemetry_row *row; /* row being written, or NULL */
    unsigned piece;                  /* of either, next */
    bool header_asked;               /* `log on` is answered once the header is out */
    uint32_t lost_told;              /* telemetry rows reported as lost */
    uint32_t bytes_lost;             /* on the line, before the line under way */
    bool reboot;                     /* after the reply has gone out */
    struct {
        uint32_t lines, errors, dropped;
    } stats;
};

void console_init(struct console *c, struct operate *door);
/* One turn. Returns whether there was anything to do. */
bool console_poll(struct console *c);

/* For the commands */
void console_list(struct console *c, console_listing listing, const char *argument);
void console_ok(struct console *c);
/* err CODE text */
void console_err(struct console *c, enum err code, const char *text);
/* err CODE subject: text; either part may be NULL */
void console_err_about(struct console *c, enum err code, const char *subject, const char *text);
/* What the door has answered: ok, or err CODE and the answer in words. */
void console_answer(struct console *c, enum err code, const struct answer *answer);
/* The words of a refusal, behind `err CODE`: console_refusals.c. */
void console_refusal(enum err code, const struct answer *answer, struct text *t);
/* A word as a number; false: refused, and answered, with what is wanted. */
bool console_number(struct console *c, const char *text, const char *what, float *x);
/* One whole line. */
void console_print(struct console *c, const char *text);

struct console_command {
    const char *name;
    const char *arguments;
    const char *help;
    unsigned lowest, highest; /* words after the name */
    void (*run)(struct console *c, unsigned n, char **word);
};

/* One for each row of commands.h, in console_*.c by subject. */
#define RUNS(name, ...) void command_##name(struct console *c, unsigned n, char **word);
CONSOLE_COMMANDS(RUNS)
#undef RUNS
extern const struct console_command console_commands[];
extern const unsigned console_command_count;

/* An event as text: time, level, code, subject, value, words. */
void event_line(const struct event *e, struct text *line);

/* Goes on with the save or load that has not been answered yet. Returns whether there was anything to do. */
bool console_storage_poll(struct console *c);
bool parameter_help(struct console *c, unsigned n, struct text *line);
/* The command that sets a parameter to its value; a remark where this build cannot: a block of an unknown kind. */
void console_set_line(const struct parameter *p, const struct config *config, struct text *line);

/* "engineer level open, no key is set" */
void console_access_text(const struct console *c, struct text *line);

/* For the line editor: what may be typed next, by the arguments of the command's row. */
bool console_choice(void *console, const char *line, unsigned n, struct text *word);

/* What is wrong with a block: that it has given up (0), or the k-th event of its kind (k + 1), where that is an alarm and holds. */
void block_alarm_line(const struct console *c, uint8_t block, unsigned what, struct text *line);
/* ": the model has left the plant", what the kind says of an event of a block; nothing where it is not of this build. */
void block_event_words(const struct event *e, struct text *line);
/* "its kind has no such verb, but: freeze tune" */
void block_verbs_words(const struct block_kind *kind, struct text *t);
/* "start held at step 7: guard, CW"; nothing where none is under way, nor has been. */
void sequence_headline(const struct service *s, struct text *line);
/* What is in force: names by index are of this. */
static inline const struct config *console_settings(const struct console *c)
{
    return operate_in_force(&c->session);
}

/* Automatic start-up */
/* `commission relay [LOOP]`, what it is about while it goes on, and what it has found */
void commission_relay_command(struct console *c, unsigned n, char **word);
void commission_relay_now(struct console *c, struct text *line);
bool commission_relay_line(struct console *c, unsigned n, struct text *line);
/* Listings of `commission plant|plan|model|gains|pairing|structure|proposal|trial` */
bool commission_plan_line(struct console *c, unsigned n, struct text *line);
bool commission_plant_line(struct console *c, unsigned n, struct text *line);
bool commission_structure_line(struct console *c, unsigned n, struct text *line);
bool commission_trial_line(struct console *c, unsigned n, struct text *line);
bool commission_model_line(struct console *c, unsigned n, struct text *line);
bool commission_gains_line(struct console *c, unsigned n, struct text *line);
bool commission_pairing_line(struct console *c, unsigned n, struct text *line);
bool commission_proposal_line(struct console *c, unsigned n, struct text *line);
#define COMMISSION_GONE                                                                            \
    "what was found has made room: the workspace has been leased for something else since"
/* Shared by them: channels of the tests by their place there, as the settings in force have them. */
const struct measurement_config *commission_measurement(const struct console *c, unsigned j);
const struct mv_config *commission_output(const struct console *c, unsigned k);
/* ... flags of an element, and whether there is nothing to list (a line says why). */
void commission_flags(struct text *t, unsigned bits);
bool commission_has_nothing(struct console *c, unsigned n, struct text *line);
/* The last lines of the proposal: inner loops and feedforwards. */
bool commission_structural_line(struct console *c, unsigned n, struct text *line);

#endif

/* One line of input, edited as it is typed: echo, rubbing out, cursor keys, history, completion. An access
 * key is echoed as stars and not kept.
 *
 * For scripts (people = false) nothing is echoed, a tab is a blank, and only backspace, ^U and ^C edit. A line
 * that is too long or has characters that are not printable ASCII is finished as usual and marked.
 */
#ifndef REFLUX_CONSOLE_LINE_EDITOR_H
#define REFLUX_CONSOLE_LINE_EDITOR_H

#include "base/text.h"

#ifndef LINE_EDITOR_MAX
#define LINE_EDITOR_MAX 200 /* characters of a line, at most 250 */
#endif
#ifndef LINE_EDITOR_HISTORY
#define LINE_EDITOR_HISTORY 256 /* bytes of past lines, with a zero after each; 1 = none kept */
#endif
#ifndef LINE_EDITOR_CLEARS
#define LINE_EDITOR_CLEARS (LINE_EDITOR_HISTORY > 1) /* ^L clears the screen */
#endif
#ifndef LINE_EDITOR_CHOICES
#define LINE_EDITOR_CHOICES 300 /* characters of choices shown at most */
#endif

/* Most bytes one character makes the editor write. */
#define LINE_EDITOR_ECHO (LINE_EDITOR_CHOICES + 2 * LINE_EDITOR_MAX + 12)

struct line_editor_port {
    void (*write)(void *context, const char *text, size_t n);
    /* The n-th word that may stand where the last word of `line` is being typed; false past the end. A word left
     * empty is passed over. */
    bool (*choice)(void *context, const char *line, unsigned n, struct text *word);
    void (*prompt)(void *context);
};

struct line_editor {
    const struct line_editor_port *port;
    void *context;                  /* handed to the port */
    char line[LINE_EDITOR_MAX + 1]; /* always terminated */
    uint8_t n, cursor;              /* characters; place in them */
    bool overlong, garbled;         /* the line under way is to be refused */
    char last;                      /* last character, to take CR LF as one end */
    uint8_t escape;                 /* how far into an escape sequence */
    char parameter;                 /* digit in it */
    uint8_t back;                   /* lines gone back in the history, 0 = the line under way */
    uint16_t history_n;
    char history[LINE_EDITOR_HISTORY]; /* oldest first */
};

/* Keeps the pointers. */
void line_editor_init(struct line_editor *e, const struct line_editor_port *port, void *context);
/* Returns whether a line was finished: look at line, n, overlong, garbled, then line_editor_next(). */
bool line_editor_take(struct line_editor *e, char x, bool people);
/* Puts a line into the history, unless it is empty or the newest already. */
void line_editor_remember(struct line_editor *e, const char *line);
void line_editor_next(struct line_editor *e);
/* Writes the line under way once more, after something else has been printed in its place. */
void line_editor_show(const struct line_editor *e);

#endif

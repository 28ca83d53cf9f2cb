#include "console/line_editor.h"

#include <string.h>

#include "base/assertion.h"
#include "base/secret.h"

_Static_assert(LINE_EDITOR_MAX <= 250, "positions are bytes");

enum { ESCAPE_NONE, ESCAPE_BEGUN, ESCAPE_BRACKET };

enum key {
    KEY_BACKSPACE = '\b',
    KEY_DELETE_BACK = 127,
    KEY_HOME = 1,    /* ^A */
    KEY_CANCEL = 3,  /* ^C */
    KEY_END = 5,     /* ^E */
    KEY_CLEAR = 12,  /* ^L */
    KEY_RESTART = 21 /* ^U */
};

void line_editor_init(struct line_editor *e, const struct line_editor_port *port, void *context)
{
    memset(e, 0, sizeof *e);
    e->port = port;
    e->context = context;
}

static void put(const struct line_editor *e, const char *text, size_t n)
{
    e->port->write(e->context, text, n);
}

static void put_times(const struct line_editor *e, char x, unsigned n)
{
    while (n--)
        put(e, &x, 1);
}

/* Characters of the line, those of an access key as stars. */
static void put_line(const struct line_editor *e, unsigned from, unsigned to)
{
    unsigned secret = (unsigned)secret_from(e->line);
    unsigned shown = from > secret ? from : to < secret ? to : secret;
    put(e, e->line + from, shown - from);
    put_times(e, '*', to - shown);
}

/* Writes the line behind the cursor and puts the cursor back; `blanks` wipe characters that were there before. */
static void put_tail(const struct line_editor *e, unsigned blanks)
{
    REFLUX_ASSERT(e->cursor <= e->n);
    unsigned tail = (unsigned)e->n - e->cursor;
    put_line(e, e->cursor, e->n);
    put_times(e, ' ', blanks);
    put_times(e, '\b', tail + blanks);
}

void line_editor_show(const struct line_editor *e)
{
    put_line(e, 0, e->n);
    put_times(e, '\b', (unsigned)e->n - e->cursor);
}

/* ---- editing ---- */

static void insert(struct line_editor *e, char x, bool people)
{
    REFLUX_ASSERT(e->cursor <= e->n && e->n <= LINE_EDITOR_MAX);
    if (e->n == LINE_EDITOR_MAX) {
        e->overlong = true;
        return;
    }
    memmove(e->line + e->cursor + 1, e->line + e->cursor, (size_t)(e->n - e->cursor) + 1u);
    e->line[e->cursor++] = x;
    e->n++;
    if (!people)
        return;
    put_line(e, e->cursor - 1u, e->cursor);
    if (e->cursor < e->n)
        put_tail(e, 0);
}

/* Takes out what stands before the cursor. */
static void rub_out(struct line_editor *e, bool people)
{
    REFLUX_ASSERT(e->cursor <= e->n && e->n <= LINE_EDITOR_MAX);
    if (e->cursor == 0)
        return;
    memmove(e->line + e->cursor - 1, e->line + e->cursor, (size_t)(e->n - e->cursor) + 1u);
    e->cursor--;
    e->n--;
    if (!people)
        return;
    put(e, "\b", 1);
    put_tail(e, 1);
}

static void clear_screen(const struct line_editor *e)
{
    static const char home_and_clear[] = "\033[H\033[2J";
    put(e, home_and_clear, sizeof home_and_clear - 1u);
    e->port->prompt(e->context);
    line_editor_show(e);
}

static void move_cursor(struct line_editor *e, unsigned to)
{
    while (e->cursor > to) {
        e->cursor--;
        put(e, "\b", 1);
    }
    to = to < e->n ? to : e->n;
    if (e->cursor < to) {
        put_line(e, e->cursor, to);
        e->cursor = (uint8_t)to;
    }
}

static void delete_under(struct line_editor *e)
{
    if (e->cursor < e->n) {
        move_cursor(e, e->cursor + 1u);
        rub_out(e, true);
    }
}

/* The line gives way to another one. */
static void replace(struct line_editor *e, const char *line, bool people)
{
    if (people && e->n) {
        move_cursor(e, 0);
        put(e, "\033[K", 3);
    }
    size_t n = strlen(line);
    REFLUX_ASSERT(n <= LINE_EDITOR_MAX);
    memmove(e->line, line, n + 1);
    e->n = e->cursor = (uint8_t)n;
    if (people)
        put_line(e, 0, e->n);
}

/* ---- history ---- */

/* The line that was finished `back` lines ago, 1 = the newest; NULL when none is kept. */
static const char *past(const struct line_editor *e, unsigned back)
{
    REFLUX_ASSERT(e->history_n <= sizeof e->history);
    unsigned at = e->history_n;
    while (back--) {
        if (at == 0)
            return NULL;
        at--; /* over its zero */
        while (at && e->history[at - 1])
            at--;
    }
    return e->history + at;
}

void line_editor_remember(struct line_editor *e, const char *line)
{
    size_t size = strlen(line) + 1;
    const char *newest = past(e, 1);
    if (size == 1 || size > sizeof e->history || (newest && strcmp(newest, line) == 0))
        return;
    while (e->history_n + size > sizeof e->history) {
        size_t oldest = strlen(e->history) + 1;
        memmove(e->history, e->history + oldest, e->history_n - oldest);
        e->history_n = (uint16_t)(e->history_n - oldest);
    }
    memcpy(e->history + e->history_n, line, size);
    e->history_n = (uint16_t)(e->history_n + size);
}

static void recall_earlier(struct line_editor *e)
{
    const char *line = past(e, e->back + 1u);
    if (!line)
        return;
    e->back++;
    replace(e, line, true);
}

static void go_forth(struct line_editor *e)
{
    if (e->back == 0)
        return;
    e->back--;
    replace(e, e->back ? past(e, e->back) : "", true);
}

/* ---- completion ---- */

static unsigned common(const char *a, const char *b)
{
    unsigned n = 0;
    while (a[n] && a[n] == b[n])
        n++;
    return n;
}

static bool choice(const struct line_editor *e, const char *line, unsigned n, struct text *word)
{
    word->n = 0;
    word->start[0] = '\0';
    return e->port->choice(e->context, line, n, word);
}

static void show_choices(struct line_editor *e, const char *line, const char *begun)
{
    char buffer[32];
    struct text word = text_on(buffer, sizeof buffer);
    unsigned shown = 0;
    put(e, "\r\n", 2);
    for (unsigned n = 0; choice(e, line, n, &word); n++) {
        if (word.n == 0 || strncmp(buffer, begun, strlen(begun)) != 0)
            continue;
        shown += (unsigned)word.n + 2u;
        if (shown > LINE_EDITOR_CHOICES) {
            put(e, "...", 3);
            break;
        }
        put(e, buffer, word.n);
        put(e, "  ", 2);
    }
    put(e, "\r\n", 2);
    e->port->prompt(e->context);
    line_editor_show(e);
}

/* Completes the word before the cursor as far as all choices agree; shows them when they agree no further. */
static void complete_word(struct line_editor *e)
{
    char line[LINE_EDITOR_MAX + 1], best[32], buffer[32];
    struct text word = text_on(buffer, sizeof buffer);
    unsigned found = 0, agree = 0, begin = e->cursor;
    REFLUX_ASSERT(e->cursor <= LINE_EDITOR_MAX);
    memcpy(line, e->line, e->cursor);
    line[e->cursor] = '\0';
    while (begin && line[begin - 1] != ' ')
        begin--;
    const char *begun = line + begin;
    unsigned length = e->cursor - begin;
    for (unsigned n = 0; choice(e, line, n, &word); n++) {
        if (word.n == 0 || strncmp(buffer, begun, length) != 0)
            continue;
        if (found++ == 0) {
            memcpy(best, buffer, word.n + 1);
            agree = (unsigned)word.n;
        } else {
            unsigned alike = common(best, buffer);
            agree = alike < agree ? alike : agree;
        }
    }
    if (found == 0)
        return;
    if (found > 1 && agree == length) {
        show_choices(e, line, begun);
        return;
    }
    for (unsigned i = length; i < agree && e->n < LINE_EDITOR_MAX; i++)
        insert(e, best[i], true);
    /* A choice that ends with a dot is only half of a name. */
    if (found == 1 && best[agree - 1] != '.' && e->cursor == e->n && e->n < LINE_EDITOR_MAX)
        insert(e, ' ', true);
}

/* ---- input ---- */

static void final_of_sequence(struct line_editor *e, char x)
{
    switch (x == '~' ? e->parameter : x) { /* ESC [ 3 ~: the digit names the key */
    case 'A':
        recall_earlier(e);
        break;
    case 'B':
        go_forth(e);
        break;
    case 'C':
        move_cursor(e, e->cursor + 1u);
        break;
    case 'D':
        move_cursor(e, e->cursor ? e->cursor - 1u : 0);
        break;
    case 'H':
    case '1':
    case '7':
        move_cursor(e, 0);
        break;
    case 'F':
    case '4':
    case '8':
        move_cursor(e, e->n);
        break;
    case '3':
        delete_under(e);
        break;
    default:
        break; /* a key that means nothing here */
    }
}

/* ESC [ digits letter, ESC O letter. Returns whether x belonged to a sequence. */
static bool take_escape(struct line_editor *e, char x)
{
    bool control = (unsigned char)x < ' ' || (unsigned char)x >= 127;
    if (x == '\033') {
        e->escape = ESCAPE_BEGUN;
        e->parameter = 0;
        return true;
    }
    if (e->escape == ESCAPE_NONE)
        return false;
    if (control) {
        e->escape = ESCAPE_NONE;
        return false;
    }
    if (e->escape == ESCAPE_BEGUN) {
        e->escape = x == '[' || x == 'O' ? ESCAPE_BRACKET : ESCAPE_NONE;
    } else if (x >= '@') {
        e->escape = ESCAPE_NONE;
        final_of_sequence(e, x);
    } else {
        e->parameter = e->parameter == 0 ? x : '?'; /* one digit is all we know */
    }
    return true;
}

static void take_key(struct line_editor *e, char x, bool people)
{
    switch (x) {
    case KEY_BACKSPACE:
    case KEY_DELETE_BACK:
        rub_out(e, people);
        break;
    case KEY_CANCEL:
    case KEY_RESTART:
        replace(e, "", people);
        e->overlong = e->garbled = false;
        e->back = 0;
        break;
    case '\t':
        if (people)
            complete_word(e);
        else
            insert(e, ' ', false);
        break;
    case KEY_HOME:
    case KEY_END:
        if (people)
            move_cursor(e, x == KEY_HOME ? 0 : e->n);
        else
            e->garbled = true;
        break;
    case '\0':
        break;
    default:
        if (x >= ' ' && x < 127)
            insert(e, x, people);
        else if (LINE_EDITOR_CLEARS && people && x == KEY_CLEAR)
            clear_screen(e);
        else
            e->garbled = true;
    }
}

bool line_editor_take(struct line_editor *e, char x, bool people)
{
    char before = e->last;
    e->last = x;
    if (people && take_escape(e, x))
        return false;
    if (x == '\r' || x == '\n')
        return x != '\n' || before != '\r';
    take_key(e, x, people);
    return false;
}

void line_editor_next(struct line_editor *e)
{
    e->n = e->cursor = 0;
    e->line[0] = '\0';
    e->overlong = e->garbled = false;
    e->back = 0;
    e->escape = ESCAPE_NONE;
}

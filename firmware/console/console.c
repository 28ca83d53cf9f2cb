/* Dispatch and output of the console. The commands are in console_*.c. */
#include "console/console.h"

#include <string.h>

#include "base/secret.h"
#include "hal/clock.h"
#include "hal/identity.h"
#include "hal/uart.h"
#include "hal/watchdog.h"
#include "settings/parameters.h"

#define TEXT_OF_(x) #x
#define TEXT_OF(x)  TEXT_OF_(x)

/* Room kept in the transmit ring before a command runs. */
#define REPLY_ROOM ((size_t)CONSOLE_REPLY_ROOM)
/* ... and beside a piece of telemetry: prompt and line under way, shown again. */
#define SHOW_ROOM (TELEMETRY_PIECE_MAX + 2 * CONSOLE_LINE_MAX + 8)
_Static_assert(LINE_EDITOR_ECHO <= CONSOLE_REPLY_ROOM, "what the editor writes finds room");

static const char *end_of_line(const struct console *c)
{
    return c->machine ? "\n" : "\r\n";
}

static bool write_text(const char *text, size_t n)
{
    return hal_uart_write(HAL_UART_CONSOLE, text, n);
}

static void prompt(struct console *c)
{
    if (!c->machine)
        (void)write_text("> ", 2);
}

static void editor_write(void *console, const char *text, size_t n)
{
    (void)console;
    (void)write_text(text, n);
}

static void editor_prompt(void *console)
{
    prompt(console);
}

static const struct line_editor_port editor_port = {editor_write, console_choice, editor_prompt};

void console_init(struct console *c, struct operate *door)
{
    memset(c, 0, sizeof *c);
    c->service = door->service;
    session_init(&c->session, door);
    line_editor_init(&c->editor, &editor_port, c);
}

void console_print(struct console *c, const char *text)
{
    size_t n = strlen(text);
    n = n < CONSOLE_OUTPUT_MAX ? n : CONSOLE_OUTPUT_MAX;
    if (hal_uart_room(HAL_UART_CONSOLE) < n + 2u) { /* whole or not at all */
        c->stats.dropped++;
        return;
    }
    (void)write_text(text, n);
    (void)write_text(end_of_line(c), strlen(end_of_line(c)));
}

void console_ok(struct console *c)
{
    console_print(c, "ok");
    prompt(c);
}

static struct text err_on(char *line, size_t size, enum err code)
{
    struct text t = text_on(line, size);
    text_str(&t, "err ");
    text_str(&t, err_name(code));
    text_char(&t, ' ');
    return t;
}

static void print_err(struct console *c, const char *line)
{
    c->stats.errors++;
    console_print(c, line);
    prompt(c);
}

void console_err_about(struct console *c, enum err code, const char *subject, const char *text)
{
    char line[CONSOLE_OUTPUT_MAX];
    struct text t = err_on(line, sizeof line, code);
    if (subject && subject[0]) {
        text_str(&t, subject);
        text_str(&t, ": ");
    }
    text_str(&t, text ? text : err_text(code));
    print_err(c, line);
}

void console_answer(struct console *c, enum err code, const struct answer *answer)
{
    if (!code) {
        console_ok(c);
        return;
    }
    char line[CONSOLE_OUTPUT_MAX];
    struct text t = err_on(line, sizeof line, code);
    console_refusal(code, answer, &t);
    print_err(c, line);
}

void console_err(struct console *c, enum err code, const char *text)
{
    console_err_about(c, code, NULL, text);
}

void console_list(struct console *c, console_listing listing, const char *argument)
{
    struct text t = text_on(c->argument, sizeof c->argument);
    text_str(&t, argument);
    c->listing = listing;
    c->listing_at = 0;
}

static unsigned split_words(char *line, char **word)
{
    unsigned n = 0;
    while (*line) {
        while (*line == ' ' || *line == '\t')
            *line++ = '\0';
        if (!*line)
            break;
        if (n == CONSOLE_WORDS)
            return CONSOLE_WORDS + 1;
        word[n++] = line;
        while (*line && *line != ' ' && *line != '\t')
            line++;
    }
    return n;
}

static void usage(struct console *c, const struct console_command *command)
{
    char text[CONSOLE_OUTPUT_MAX];
    struct text t = text_on(text, sizeof text);
    text_str(&t, "usage: ");
    text_str(&t, command->name);
    text_char(&t, ' ');
    text_str(&t, command->arguments);
    console_err(c, ERR_PARSE, text);
}

static void dispatch(struct console *c)
{
    char *word[CONSOLE_WORDS];
    unsigned n = split_words(c->editor.line, word);
    c->stats.lines++;
    if (n == 0) {
        prompt(c);
        return;
    }
    if (word[0][0] == '#') { /* a remark in a pasted file */
        console_ok(c);
        return;
    }
    for (unsigned i = 0; i < console_command_count; i++) {
        const struct console_command *command = &console_commands[i];
        if (strcmp(word[0], command->name) != 0)
            continue;
        if (n - 1 < command->lowest || n - 1 > command->highest)
            usage(c, command);
        else
            command->run(c, n - 1, word + 1);
        return;
    }
    console_err_about(c, ERR_UNKNOWN, word[0], "no such command; `help` lists them");
}

/* Bytes that were lost or damaged since the last line may be missing in this one: "12" must not pass for
 * the "1200" that was sent. */
static bool bytes_lost(struct console *c)
{
    struct hal_uart_stats stats;
    hal_uart_get_stats(HAL_UART_CONSOLE, &stats);
    uint32_t lost = stats.rx_dropped + stats.line_errors;
    bool any = lost != c->bytes_lost;
    c->bytes_lost = lost;
    return any;
}

static void finish_line(struct console *c)
{
    bool lossy = bytes_lost(c);
    const struct line_editor *e = &c->editor;
    if (!c->machine) {
        (void)write_text("\r\n", 2);
        if (!e->overlong && !e->garbled && !lossy && secret_from(e->line) == e->n)
            line_editor_remember(&c->editor, e->line);
    }
    if (e->overlong)
        console_err(c, ERR_FULL,
                    "line longer than " TEXT_OF(LINE_EDITOR_MAX) " characters, ignored");
    else if (lossy)
        console_err(c, ERR_IO, "bytes were lost on the line, ignored; send it again, more slowly");
    else if (e->garbled)
        console_err(c, ERR_PARSE, "line has characters that are not printable ASCII, ignored");
    else
        dispatch(c);
    line_editor_next(&c->editor);
}

/* People see an asynchronous line in place of what they were typing, and their typing again below it. */
static void async_line(struct console *c, char *line, size_t n, size_t size)
{
    struct text t = {.start = line, .n = n, .size = size, .cut = false};
    text_str(&t, end_of_line(c));
    if (!c->machine)
        (void)write_text("\r\033[K", 4);
    if (!write_text(line, t.n))
        c->stats.dropped++;
    if (!c->machine && !c->listing && !operate_waits(&c->session)) {
        prompt(c);
        line_editor_show(&c->editor);
    }
}

static bool print_event(struct console *c)
{
    struct event e;
    char line[CONSOLE_OUTPUT_MAX];
    if (hal_uart_room(HAL_UART_CONSOLE) < CONSOLE_OUTPUT_MAX + CONSOLE_LINE_MAX ||
        !service_next_event(c->service, &e))
        return false;
    struct text t = text_on(line, sizeof line - 2);
    text_str(&t, "! ");
    event_line(&e, &t);
    async_line(c, line, t.n, sizeof line);
    return true;
}

/* Telemetry lines go out piece by piece as the transmit ring takes them; nothing else is printed meanwhile. */
static bool line_under_way(const struct console *c)
{
    return c->header_of || c->row;
}

static void begin_line(struct console *c)
{
    c->piece = 0;
    c->service->telemetry.printing = true;
    if (!c->machine)
        (void)write_text("\r\033[K", 4);
}

static void end_line(struct console *c)
{
    (void)write_text(end_of_line(c), strlen(end_of_line(c)));
    if (c->row)
        spsc_read_done(&c->service->telemetry.index);
    c->row = NULL;
    c->header_of = NULL;
    c->service->telemetry.printing = false;
    if (!c->machine && !c->listing && !operate_waits(&c->session) && !c->header_asked) {
        prompt(c);
        line_editor_show(&c->editor);
    }
    if (c->header_asked) {
        c->header_asked = false;
        console_ok(c);
    }
}

static void go_on_line(struct console *c)
{
    char text[TELEMETRY_PIECE_MAX];
    while (line_under_way(c) && hal_uart_room(HAL_UART_CONSOLE) >= SHOW_ROOM) {
        struct text t = text_on(text, sizeof text);
        bool more = c->row ? telemetry_row(c->row, c->piece++, &t)
                           : telemetry_header(c->header_of, c->piece++, &t);
        (void)write_text(text, t.n);
        if (!more)
            end_line(c);
    }
}

static void begin_header(struct console *c, const struct plan *plan)
{
    c->header = plan->serial;
    c->header_of = plan;
    begin_line(c);
}

/* Once the queue is empty again: how many rows found no room. */
static bool tell_losses(struct console *c)
{
    struct service *s = c->service;
    uint32_t lost = s->telemetry.lost;
    if (lost == c->lost_told)
        return false;
    service_record(s, EVENT_TELEMETRY_LOST, NULL, (float)(lost - c->lost_told), 0);
    c->lost_told = lost;
    return true;
}

static bool print_row(struct console *c)
{
    struct telemetry *telemetry = &c->service->telemetry;
    if (!line_under_way(c)) {
        if (!c->header_asked && !spsc_can_read(&telemetry->index))
            return tell_losses(c);
        const struct telemetry_row *row = &telemetry->slot[spsc_read_index(&telemetry->index)];
        if (hal_uart_room(HAL_UART_CONSOLE) < SHOW_ROOM)
            return false;
        if (c->header_asked) {
            begin_header(c, service_plan(c->service));
        } else if (row->plan->serial != c->header) {
            begin_header(c, row->plan);
        } else {
            c->row = row;
            begin_line(c);
        }
    }
    go_on_line(c);
    return !line_under_way(c);
}

static bool go_on_listing(struct console *c)
{
    char line[CONSOLE_OUTPUT_MAX];
    service_flush(c->service); /* lines look at states by their index */
    /* A few lines a turn, so that telemetry is not kept waiting. */
    for (unsigned turn = 0; turn < 16; turn++) {
        if (hal_uart_room(HAL_UART_CONSOLE) < REPLY_ROOM)
            return false;
        struct text t = text_on(line, sizeof line);
        if (!c->listing(c, c->listing_at++, &t)) {
            c->listing = NULL;
            console_ok(c);
            return true;
        }
        if (t.n)
            console_print(c, line);
    }
    return true;
}

static bool read_input(struct console *c)
{
    bool any = false;
    while (!c->listing && !operate_waits(&c->session) && !c->header_asked &&
           hal_uart_room(HAL_UART_CONSOLE) >= REPLY_ROOM) {
        if (c->rx_at == c->rx_n) {
            c->rx_at = 0;
            c->rx_n = (unsigned)hal_uart_read(HAL_UART_CONSOLE, c->rx, sizeof c->rx);
            if (c->rx_n == 0)
                break;
        }
        any = true;
        if (line_editor_take(&c->editor, (char)c->rx[c->rx_at++], !c->machine)) {
            finish_line(c);
            break; /* one command a turn */
        }
    }
    return any;
}

static void finish_and_reboot(struct console *c)
{
    service_keep_events(c->service);
    /* The reply leaves first, but a line nobody reads does not keep the board. */
    uint64_t start = hal_clock_ms();
    while (hal_uart_pump(HAL_UART_CONSOLE) != 0 && hal_clock_ms() - start < 500)
        hal_watchdog_feed();
    hal_reboot();
}

bool console_poll(struct console *c)
{
    service_keep_events(c->service);
    session_poll(&c->session);
    bool busy = !line_under_way(c) && print_event(c);
    busy = print_row(c) || busy;
    if (line_under_way(c))
        ; /* what else there is to say waits for its end */
    else if (c->listing)
        busy = go_on_listing(c) || busy;
    else if (operate_waits(&c->session))
        busy = console_storage_poll(c) || busy;
    else
        busy = read_input(c) || busy;
    (void)hal_uart_pump(HAL_UART_CONSOLE);
    if (c->reboot)
        finish_and_reboot(c);
    return busy;
}

/* Line editing, dispatch and output of the console. The commands are in console_*.c. */
#include "service/console.h"

#include <string.h>

#include "hal/clock.h"
#include "hal/identity.h"
#include "hal/tick.h"
#include "hal/uart.h"
#include "hal/watchdog.h"

/* Room kept in the transmit ring before a command runs: its reply is at most a few lines. */
#define REPLY_ROOM ((size_t)3 * CONSOLE_OUTPUT_MAX)

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

void console_init(struct console *c, struct service *service)
{
    memset(c, 0, sizeof *c);
    c->service = service;
}

void console_print(struct console *c, const char *text)
{
    char line[CONSOLE_OUTPUT_MAX + 4];
    struct text t = text_on(line, sizeof line - 2);
    text_str(&t, text);
    t.size += 2;
    text_str(&t, end_of_line(c));
    if (!write_text(line, t.n))
        c->stats.dropped++;
}

void console_ok(struct console *c)
{
    console_print(c, "ok");
    prompt(c);
}

void console_err_about(struct console *c, enum err code, const char *subject, const char *text)
{
    char line[CONSOLE_OUTPUT_MAX];
    struct text t = text_on(line, sizeof line);
    c->stats.errors++;
    text_str(&t, "err ");
    text_str(&t, err_name(code));
    text_char(&t, ' ');
    if (subject && subject[0]) {
        text_str(&t, subject);
        text_str(&t, ": ");
    }
    text_str(&t, text ? text : err_text(code));
    console_print(c, line);
    prompt(c);
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

static unsigned split(char *line, char **word)
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
    unsigned n = split(c->line, word);
    c->stats.lines++;
    if (n == 0) {
        prompt(c);
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

static void finish_line(struct console *c)
{
    if (!c->machine)
        (void)write_text("\r\n", 2);
    c->line[c->n] = '\0';
    if (c->overlong)
        console_err(c, ERR_FULL, "line longer than 200 characters, ignored");
    else if (c->garbled)
        console_err(c, ERR_PARSE, "line has characters that are not printable ASCII, ignored");
    else
        dispatch(c);
    c->n = 0;
    c->overlong = c->garbled = false;
}

static void rub_out(struct console *c, unsigned characters)
{
    for (; characters && c->n; characters--) {
        c->n--;
        if (!c->machine)
            (void)write_text("\b \b", 3);
    }
}

/* Returns whether a line was finished. */
static bool take(struct console *c, char x)
{
    char before = c->last;
    c->last = x;
    if (x == '\r' || x == '\n') {
        if (x == '\n' && before == '\r')
            return false;
        finish_line(c);
        return true;
    }
    if (x == '\b' || x == 127) {
        rub_out(c, 1);
    } else if (x == 21 || x == 3) { /* ^U, ^C: start the line again */
        rub_out(c, c->n);
        c->overlong = c->garbled = false;
    } else if (x == '\t' || (x >= ' ' && x < 127)) {
        if (c->n == CONSOLE_LINE_MAX) {
            c->overlong = true;
            return false;
        }
        c->line[c->n++] = x == '\t' ? ' ' : x;
        if (!c->machine)
            (void)write_text(&c->line[c->n - 1], 1);
    } else if (x != 0) {
        c->garbled = true;
    }
    return false;
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
    if (!c->machine && !c->listing) {
        prompt(c);
        (void)write_text(c->line, c->n);
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

/* One line at a time: static keeps 2.3 KB off the stack. */
static char long_line[TELEMETRY_LINE_MAX];

static void print_header(struct console *c, const struct plan *plan)
{
    struct text t = text_on(long_line, sizeof long_line - 2);
    telemetry_header(plan, &t);
    c->header = plan->serial;
    async_line(c, long_line, t.n, sizeof long_line);
}

/* Once the queue is empty again: how many rows found no room. */
static bool tell_losses(struct console *c)
{
    struct service *s = c->service;
    uint32_t lost = s->telemetry.lost;
    if (lost == c->lost_told)
        return false;
    hal_tick_lock();
    uint64_t now = s->supervisor->time_ms;
    hal_tick_unlock();
    event_put(&s->main_events, now, EVENT_TELEMETRY_LOST, NULL, (float)(lost - c->lost_told), 0);
    c->lost_told = lost;
    return true;
}

static bool print_row(struct console *c)
{
    struct telemetry *telemetry = &c->service->telemetry;
    if (!c->header_asked && !spsc_can_read(&telemetry->index))
        return tell_losses(c);
    if (hal_uart_room(HAL_UART_CONSOLE) < TELEMETRY_LINE_MAX)
        return false;
    if (c->header_asked) {
        print_header(c, service_plan(c->service));
        c->header_asked = false;
        console_ok(c);
        return true;
    }
    const struct telemetry_row *row = &telemetry->slot[spsc_read_index(&telemetry->index)];
    if (row->plan->serial != c->header) {
        print_header(c, row->plan);
        return true;
    }
    struct text t = text_on(long_line, sizeof long_line - 2);
    telemetry_row(row, &t);
    spsc_read_done(&telemetry->index);
    async_line(c, long_line, t.n, sizeof long_line);
    return true;
}

static bool go_on_listing(struct console *c)
{
    char line[CONSOLE_OUTPUT_MAX];
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
    while (!c->listing && !c->header_asked && hal_uart_room(HAL_UART_CONSOLE) >= REPLY_ROOM) {
        if (c->rx_at == c->rx_n) {
            c->rx_at = 0;
            c->rx_n = (unsigned)hal_uart_read(HAL_UART_CONSOLE, c->rx, sizeof c->rx);
            if (c->rx_n == 0)
                break;
        }
        any = true;
        if (take(c, (char)c->rx[c->rx_at++]))
            break; /* one command a turn */
    }
    return any;
}

static void finish_and_reboot(void)
{
    /* The reply leaves first, but a line nobody reads does not keep the board. */
    uint64_t start = hal_clock_ms();
    while (hal_uart_pump(HAL_UART_CONSOLE) != 0 && hal_clock_ms() - start < 500)
        hal_watchdog_feed();
    hal_reboot();
}

bool console_poll(struct console *c)
{
    bool busy = print_event(c);
    busy = print_row(c) || busy;
    if (c->listing)
        busy = go_on_listing(c) || busy;
    else
        busy = read_input(c) || busy;
    (void)hal_uart_pump(HAL_UART_CONSOLE);
    if (c->reboot)
        finish_and_reboot();
    return busy;
}

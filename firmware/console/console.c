/* Dispatch and output of the console. The commands are in console_*.c. */
#include "console/console.h"

#include <string.h>

#include "base/assertion.h"
#include "base/secret.h"
#include "console/command_table.h"
#include "console/completion.h"
#include "console/event_sentence.h"
#include "console/suggestion.h"
#include "hal/clock.h"
#include "hal/identity.h"
#include "hal/uart.h"
#include "hal/watchdog.h"

#define CONSOLE_WORDS 10 /* of a command line */

#define TEXT_OF_(x) #x
#define TEXT_OF(x)  TEXT_OF_(x)

/* Room kept in the transmit ring before a command runs. */
#define REPLY_ROOM ((size_t)CONSOLE_REPLY_ROOM)
/* Room for a piece of telemetry, and for the prompt and the line under way behind it. */
#define SHOW_ROOM (TELEMETRY_PIECE_MAX + 2 * CONSOLE_LINE_MAX + 8)
_Static_assert(LINE_EDITOR_ECHO <= CONSOLE_REPLY_ROOM, "what the editor writes finds room");

static bool write_text(const char *text, size_t n)
{
    return hal_uart_write(HAL_UART_CONSOLE, text, n);
}

static void editor_write(void *client, const char *text, size_t n)
{
    (void)client;
    (void)write_text(text, n);
}

static void editor_prompt(void *client)
{
    reply_prompt(client);
}

static const struct line_editor_port editor_port = {editor_write, console_choice, editor_prompt};

void console_init(struct console *c, struct operate *door)
{
    memset(c, 0, sizeof *c);
    client_init(&c->client, door);
    suggestion_init(&c->client);
    line_editor_init(&c->editor, &editor_port, &c->client);
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

static void dispatch(struct console *c)
{
    char *word[CONSOLE_WORDS];
    struct client *client = &c->client;
    unsigned n = split_words(c->editor.line, word);
    reply_count_line(client);
    if (n == 0) {
        reply_prompt(client);
        return;
    }
    if (word[0][0] == '#') { /* a remark in a pasted file */
        reply_ok(client);
        return;
    }
    const struct console_command *command = find_command(word[0]);
    suggestion_begin(client, command);
    if (!command)
        reply_err_about(client, ERR_UNKNOWN, word[0], "no such command; `help` lists them");
    else if (n - 1 < command->words_min || n - 1 > command->words_max)
        reply_usage(client, NULL, command->name);
    else
        command->run(client, n - 1, word + 1);
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
    if (!client_is_machine(&c->client)) {
        (void)write_text("\r\n", 2);
        if (!e->overlong && !e->garbled && !lossy && secret_from(e->line) == e->n)
            line_editor_remember(&c->editor, e->line);
    }
    if (e->overlong)
        reply_err(&c->client, ERR_FULL,
                  "line longer than " TEXT_OF(LINE_EDITOR_MAX) " characters, ignored");
    else if (lossy)
        reply_err(&c->client, ERR_IO,
                  "bytes were lost on the line, ignored; send it again, more slowly");
    else if (e->garbled)
        reply_err(&c->client, ERR_PARSE,
                  "line has characters that are not printable ASCII, ignored");
    else
        dispatch(c);
    line_editor_next(&c->editor);
}

/* People see an asynchronous line in place of what they were typing, and their typing again below it. */
static void async_line(struct console *c, char *line, size_t n, size_t size)
{
    struct text t = {.start = line, .n = n, .size = size, .cut = false};
    text_str(&t, reply_line_end(&c->client));
    if (!client_is_machine(&c->client))
        (void)write_text("\r\033[K", 4);
    if (!write_text(line, t.n))
        reply_count_dropped(&c->client);
    if (!client_is_machine(&c->client) && !reply_is_pending(&c->client)) {
        reply_prompt(&c->client);
        line_editor_show(&c->editor);
    }
}

static bool print_event(struct console *c)
{
    struct event e;
    char line[CONSOLE_OUTPUT_MAX];
    if (hal_uart_room(HAL_UART_CONSOLE) < CONSOLE_OUTPUT_MAX + CONSOLE_LINE_MAX ||
        !service_next_event(c->client.service, &e))
        return false;
    struct text t = text_on(line, sizeof line - 2);
    text_str(&t, "! ");
    event_for_client(&c->client, &e, &t);
    async_line(c, line, t.n, sizeof line);
    return true;
}

/* Telemetry lines go out piece by piece as the transmit ring takes them; nothing else is printed meanwhile. */
static bool line_under_way(const struct console *c)
{
    return c->header_plan || c->row;
}

static void begin_line(struct console *c)
{
    c->piece = 0;
    c->client.service->telemetry.printing = true;
    if (!client_is_machine(&c->client))
        (void)write_text("\r\033[K", 4);
}

static void end_line(struct console *c)
{
    (void)write_text(reply_line_end(&c->client), strlen(reply_line_end(&c->client)));
    if (c->row)
        spsc_read_done(&c->client.service->telemetry.index);
    c->row = NULL;
    c->header_plan = NULL;
    c->client.service->telemetry.printing = false;
    if (!client_is_machine(&c->client) && !reply_is_pending(&c->client) &&
        !reply_header_is_due(&c->client)) {
        reply_prompt(&c->client);
        line_editor_show(&c->editor);
    }
    reply_header_done(&c->client);
}

static void go_on_line(struct console *c)
{
    char text[TELEMETRY_PIECE_MAX];
    while (line_under_way(c) && hal_uart_room(HAL_UART_CONSOLE) >= SHOW_ROOM) {
        struct text t = text_on(text, sizeof text);
        bool more = c->row ? telemetry_row(c->row, c->piece++, &t)
                           : telemetry_header(c->header_plan, c->piece++, &t);
        (void)write_text(text, t.n);
        if (!more)
            end_line(c);
    }
}

static void begin_header(struct console *c, const struct plan *plan)
{
    c->header_serial = plan->serial;
    c->header_plan = plan;
    begin_line(c);
}

/* Reports how many rows found no room, once the queue is empty again. */
static bool report_losses(struct console *c)
{
    struct service *s = c->client.service;
    uint32_t lost = s->telemetry.lost;
    if (lost == c->lost_reported)
        return false;
    service_record(s, EVENT_TELEMETRY_LOST, NULL, (float)(lost - c->lost_reported), 0);
    c->lost_reported = lost;
    return true;
}

static bool print_row(struct console *c)
{
    struct telemetry *telemetry = &c->client.service->telemetry;
    if (!line_under_way(c)) {
        if (!reply_header_is_due(&c->client) && !spsc_can_read(&telemetry->index))
            return report_losses(c);
        const struct telemetry_row *row = &telemetry->slot[spsc_read_index(&telemetry->index)];
        if (hal_uart_room(HAL_UART_CONSOLE) < SHOW_ROOM)
            return false;
        if (reply_header_is_due(&c->client)) {
            begin_header(c, service_plan(c->client.service));
        } else if (row->plan->serial != c->header_serial) {
            begin_header(c, row->plan);
        } else {
            c->row = row;
            begin_line(c);
        }
    }
    go_on_line(c);
    return !line_under_way(c);
}

static bool read_input(struct console *c)
{
    REFLUX_ASSERT(c->rx_next <= c->rx_n && c->rx_n <= sizeof c->rx);
    bool any = false;
    while (!reply_is_pending(&c->client) && !reply_header_is_due(&c->client) &&
           hal_uart_room(HAL_UART_CONSOLE) >= REPLY_ROOM) {
        if (c->rx_next == c->rx_n) {
            c->rx_next = 0;
            c->rx_n = (unsigned)hal_uart_read(HAL_UART_CONSOLE, c->rx, sizeof c->rx);
            if (c->rx_n == 0)
                break;
        }
        any = true;
        if (line_editor_take(&c->editor, (char)c->rx[c->rx_next++],
                             !client_is_machine(&c->client))) {
            finish_line(c);
            break; /* one command a turn */
        }
    }
    return any;
}

static void finish_and_reboot(struct console *c)
{
    service_keep_events(c->client.service);
    /* The reply leaves first, but a line nobody reads does not keep the board. */
    uint64_t start = hal_clock_ms();
    while (hal_uart_pump(HAL_UART_CONSOLE) != 0 && hal_clock_ms() - start < 500)
        hal_watchdog_feed();
    hal_reboot();
}

/* Goes on with the save or load that has not been answered yet. Returns whether there was anything to do. */
static bool poll_storage(struct client *c)
{
    struct answer a;
    enum err err = operate_result(&c->session, &a);
    if (!operate_waits(&c->session))
        reply_answer(c, err, &a);
    return true;
}

bool console_poll(struct console *c)
{
    service_keep_events(c->client.service);
    session_poll(&c->client.session);
    bool busy = !line_under_way(c) && print_event(c);
    busy = print_row(c) || busy;
    if (line_under_way(c))
        ; /* what else there is to say waits for its end */
    else if (reply_is_listing(&c->client))
        busy = reply_list_lines(&c->client) || busy;
    else if (operate_waits(&c->client.session))
        busy = poll_storage(&c->client) || busy;
    else
        busy = read_input(c) || busy;
    (void)hal_uart_pump(HAL_UART_CONSOLE);
    if (reply_reboot_is_due(&c->client))
        finish_and_reboot(c);
    return busy;
}

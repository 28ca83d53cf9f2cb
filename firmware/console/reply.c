/* Lines of a reply, and listings that go out as the transmit ring takes them. */
#include "console/reply.h"

#include <string.h>

#include "console/phrases.h"
#include "console/refusal_words.h"
#include "hal/uart.h"

void client_init(struct client *c, struct operate *door)
{
    memset(c, 0, sizeof *c);
    c->service = door->service;
    session_init(&c->session, door);
}

const char *reply_line_end(const struct client *c)
{
    return c->machine ? "\n" : "\r\n";
}

static void write_out(const char *text, size_t n)
{
    (void)hal_uart_write(HAL_UART_CONSOLE, text, n);
}

void reply_prompt(const struct client *c)
{
    if (!c->machine)
        write_out("> ", 2);
}

void reply_print(struct client *c, const char *text)
{
    size_t n = strlen(text);
    n = n < CONSOLE_OUTPUT_MAX ? n : CONSOLE_OUTPUT_MAX;
    if (hal_uart_room(HAL_UART_CONSOLE) < n + 2u) { /* whole or not at all */
        c->counts.dropped++;
        return;
    }
    write_out(text, n);
    write_out(reply_line_end(c), strlen(reply_line_end(c)));
}

void reply_ok(struct client *c)
{
    reply_print(c, "ok");
    reply_prompt(c);
}

static struct text err_on(char *line, size_t size, enum err code)
{
    struct text t = text_on(line, size);
    text_str(&t, "err ");
    text_str(&t, err_name(code));
    text_char(&t, ' ');
    return t;
}

static void print_err(struct client *c, const char *line)
{
    c->counts.errors++;
    reply_print(c, line);
    reply_prompt(c);
}

void reply_err_about(struct client *c, enum err code, const char *subject, const char *text)
{
    char line[CONSOLE_OUTPUT_MAX];
    struct text t = err_on(line, sizeof line, code);
    if (subject && subject[0]) {
        text_str(&t, subject);
        text_str(&t, ": ");
    }
    text_str(&t, text ? text : err_text(code));
    reply_hint(c, code, subject, false, &t);
    print_err(c, line);
}

void reply_err(struct client *c, enum err code, const char *text)
{
    reply_err_about(c, code, NULL, text);
}

void reply_answer(struct client *c, enum err code, const struct answer *answer)
{
    if (!code) {
        reply_ok(c);
        return;
    }
    char line[CONSOLE_OUTPUT_MAX];
    struct text t = err_on(line, sizeof line, code);
    refusal_words(code, answer, &t);
    if (answer->more == ANSWER_CONFIG)
        reply_hint(c, code, answer->config.subject, true, &t);
    else if (answer->more == ANSWER_PLAIN) /* others may have no subject */
        reply_hint(c, code, answer->subject, false, &t);
    print_err(c, line);
}

bool reply_number(struct client *c, const char *text, const char *what, float *x)
{
    enum err err = text_parse_float(text, x);
    if (!err)
        return true;
    char reason[80];
    struct text t = text_on(reason, sizeof reason);
    text_str(&t, "is not a number; expected ");
    text_str(&t, what);
    text_str(&t, ", like 78.5");
    reply_err_about(c, err, text, reason);
    return false;
}

void reply_value(const struct client *c, struct text *line, float x)
{
    if (c->machine)
        text_float(line, x);
    else
        text_float4(line, x);
}

void reply_amount(const struct client *c, struct text *line, float x, const char *unit)
{
    reply_value(c, line, x);
    put_word(line, unit);
}

void reply_header_done(struct client *c)
{
    if (!c->header_due)
        return;
    c->header_due = false;
    reply_ok(c);
}

void reply_list(struct client *c, reply_listing listing, const char *argument)
{
    struct text t = text_on(c->argument, sizeof c->argument);
    text_str(&t, argument);
    c->listing = listing;
    c->listing_line = 0;
}

bool reply_list_lines(struct client *c)
{
    char line[CONSOLE_OUTPUT_MAX];
    service_flush(c->service); /* lines look at states by their index */
    /* A few lines a turn, so that telemetry is not kept waiting. */
    for (unsigned turn = 0; turn < 16; turn++) {
        if (hal_uart_room(HAL_UART_CONSOLE) < (size_t)CONSOLE_REPLY_ROOM)
            return false;
        struct text t = text_on(line, sizeof line);
        if (!c->listing(c, c->listing_line++, &t)) {
            c->listing = NULL;
            reply_ok(c);
            return true;
        }
        if (t.n)
            reply_print(c, line);
    }
    return true;
}

#include "bench/console_driver.h"

#include <stdlib.h>
#include <string.h>

#include "base/secret.h"
#include "bench/text.h"

void console_driver_init(struct console *c, struct transport *t, FILE *transcript, FILE *telemetry)
{
    *c = (struct console){.transport = t, .transcript = transcript, .telemetry = telemetry};
    console_watch(c);
}

void console_forget(struct console *c)
{
    c->reply = REPLY_NONE;
    c->header = false;
    c->log_on = false;
    c->have_row = false;
    c->n = 0;
}

static void note(const struct console *c, char direction, const char *line)
{
    size_t n = secret_from(line);
    if (c->transcript != NULL) {
        (void)fprintf(c->transcript, "%.3f %c %.*s%s\n", c->plant_time_s, direction, (int)n, line,
                      line[n] != '\0' ? "***" : "");
    }
}

bool console_send(struct console *c, const char *line)
{
    note(c, '>', line);
    c->reply = REPLY_NONE;
    (void)snprintf(c->last_sent, sizeof(c->last_sent), "%s", line);
    char bytes[300];
    int n = snprintf(bytes, sizeof(bytes), "%s\r\n", line);
    return transport_write(c->transport, bytes, (size_t)n);
}

static bool begins(const char *line, const char *with)
{
    return strncmp(line, with, strlen(with)) == 0;
}

static void acknowledged(struct console *c)
{
    if (begins(c->last_sent, "log on")) {
        c->log_on = true;
        c->thinned = strtoul(c->last_sent + strlen("log on"), NULL, 10) > 1;
        (void)snprintf(c->log_line, sizeof(c->log_line), "%s", c->last_sent);
    } else if (begins(c->last_sent, "log off")) {
        c->log_on = false;
        c->header = false;
        c->log_line[0] = '\0';
    }
}

static void telemetry_row(struct console *c, const char *line)
{
    char *end;
    /* T,<format version>,<sample number>,... */
    const char *second = strchr(line + 2, ',');
    const char *text = second != NULL ? second + 1 : line;
    unsigned long number = strtoul(text, &end, 10);
    if (second == NULL || end == text || *end != ',' || number > UINT32_MAX) {
        (void)sim_fail(
            c->error, sizeof(c->error),
            "console: a telemetry row does not begin with T,<version>,<sample number>,: \"%.80s\"",
            line);
        return;
    }
    c->have_row = true;
    c->last_row = (uint32_t)number;
    c->rows++;
}

void console_watch(struct console *c)
{
    c->events[0] = '|';
    c->events[1] = '\0';
}

/* `! <time> <level> <CODE> ...`; one that finds no room any more is not waited for. */
static void note_event(struct console *c, const char *line)
{
    char code[40];
    if (sscanf(line, "! %*s %*s %39s", code) != 1) {
        return;
    }
    char wrapped[42];
    (void)snprintf(wrapped, sizeof(wrapped), "|%s|", code);
    size_t n = strlen(c->events);
    if (strstr(c->events, wrapped) == NULL && n + strlen(code) + 2 <= sizeof(c->events)) {
        (void)snprintf(c->events + n, sizeof(c->events) - n, "%s|", code);
    }
}

bool console_announced(const struct console *c, const char *codes)
{
    while (*codes != '\0') {
        size_t n = strcspn(codes, "|");
        char wrapped[64];
        (void)snprintf(wrapped, sizeof(wrapped), "|%.*s|", (int)n, codes);
        if (n > 0 && strstr(c->events, wrapped) != NULL) {
            return true;
        }
        codes += n + (codes[n] == '|');
    }
    return false;
}

static void take_line(struct console *c)
{
    const char *line = c->line;
    note(c, '<', line);
    bool header = begins(line, "H,");
    if (header || begins(line, "T,")) {
        if (c->telemetry != NULL && (header || !c->before_run)) {
            (void)fprintf(c->telemetry, "%s\n", line);
        }
        if (header) {
            c->header = true;
            c->log_on = true;
        } else {
            telemetry_row(c, line);
        }
    } else if (strcmp(line, "ok") == 0) {
        c->reply = REPLY_OK;
        c->replies++;
        acknowledged(c);
    } else if (begins(line, "err ")) {
        c->reply = REPLY_ERR;
        c->replies++;
        (void)snprintf(c->reply_text, sizeof(c->reply_text), "%.*s", CONSOLE_REPLY_SIZE - 1, line);
    } else if (begins(line, "! ")) {
        note_event(c, line);
    }
}

static void take_byte(struct console *c, char byte)
{
    if (byte == '\n') {
        if (c->n > 0 && c->line[c->n - 1] == '\r') {
            c->n--;
        }
        c->line[c->n] = '\0';
        c->n = 0;
        take_line(c);
    } else if (byte == '\0') {
        return; /* line noise of a board that starts */
    } else if (c->n < sizeof(c->line) - 1) {
        c->line[c->n] = byte;
        c->n++;
    } else {
        c->line[80] = '\0';
        (void)sim_fail(c->error, sizeof(c->error), "console: a line has more than %d bytes: \"%s\"",
                       CONSOLE_LINE_SIZE - 1, c->line);
    }
}

bool console_turn(struct console *c)
{
    char bytes[4096];
    size_t n = transport_read(c->transport, bytes, sizeof(bytes));
    for (size_t i = 0; i < n && c->error[0] == '\0'; i++) {
        take_byte(c, bytes[i]);
    }
    if (c->transport->gone && c->error[0] == '\0') {
        (void)sim_fail(c->error, sizeof(c->error), "console %.90s: %.60s", c->transport->where,
                       c->transport->reason);
    }
    return c->error[0] == '\0';
}

bool console_row_missing(const struct console *c, uint32_t number)
{
    return c->log_on && !c->thinned && !(c->have_row && c->last_row == number);
}

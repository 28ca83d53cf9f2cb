/* Console lines of a run in lockstep: greeting of the console, lines of the script, what they wait for. */
#include <string.h>

#include "base/secret.h"
#include "bench/text.h"
#include "lockstep_parts.h"

#define CONSOLE_RETRY_MS  500 /* a board that starts swallows what came too early */
#define CONSOLE_SETTLE_MS 200 /* late replies to repeated greetings of the console */

static bool replied(const struct lockstep *k)
{
    return k->console != NULL && k->console->reply != REPLY_NONE;
}

static bool replied_ok(const struct lockstep *k)
{
    return k->console != NULL && k->console->reply == REPLY_OK;
}

static bool never(const struct lockstep *k)
{
    (void)k;
    return false;
}

static enum outcome console_line(struct lockstep *k, const char *line)
{
    if (!console_send(k->console, line)) {
        (void)console_turn(k->console);
        return lockstep_stop(k, k->console->error);
    }
    return GOT_IT;
}

/* Puts the console into machine mode, and telemetry back on if log_line says so. Never interrupted by a greeting:
 * the caller looks at that afterwards. */
enum outcome lockstep_start_console(struct lockstep *k)
{
    char log_line[sizeof(k->console->log_line)];
    (void)memcpy(log_line, k->console->log_line, sizeof(log_line));
    bool log_on = k->console->log_on;
    console_forget(k->console);
    uint64_t began = transport_now_ms(k->link->transport);
    uint32_t before = k->console->replies;
    uint32_t asked = 0;
    enum outcome r = TOO_LATE;
    while (r == TOO_LATE) {
        if (transport_now_ms(k->link->transport) - began >= k->timeout_ms) {
            return lockstep_late(k, "reply ok to \"mode machine\" on the console");
        }
        (void)transport_write(k->console->transport, "\r\n", 2);
        if (console_line(k, "mode machine") == STOPPED) {
            return STOPPED;
        }
        asked++;
        r = lockstep_wait(k, replied_ok, CONSOLE_RETRY_MS);
    }
    while (r == GOT_IT && k->console->replies - before < asked) {
        k->console->reply = REPLY_NONE;
        if (lockstep_wait(k, replied, CONSOLE_SETTLE_MS) == TOO_LATE) {
            break;
        }
    }
    if (r == GOT_IT && log_on && log_line[0] != '\0') {
        if (console_line(k, log_line) == STOPPED) {
            return STOPPED;
        }
        r = lockstep_wait(k, replied, k->timeout_ms);
        if (r == TOO_LATE) {
            return lockstep_late(k, "reply to \"log on\" after a restart");
        }
    }
    return r;
}

static bool is_reboot(const char *line)
{
    return strncmp(line, "reboot", 6) == 0 && (line[6] == '\0' || line[6] == ' ');
}

/* Settings of a board at its own pins bring it a plant, with the first sample: the lines that follow may want one. */
static bool brings_plant(const struct lockstep *k, const char *line)
{
    return k->pins != NULL && k->console->before_run && k->console->reply == REPLY_OK &&
           strcmp(line, "apply") == 0;
}

/* Sends one scripted line and waits for what it leads to. */
enum outcome lockstep_one_line(struct lockstep *k, const struct script_line *x)
{
    char what[SCRIPT_LINE_SIZE + 64];
    int shown = (int)secret_from(x->text);
    (void)snprintf(what, sizeof(what), "reply to console line %u, \"%.*s\",", x->line, shown,
                   x->text);
    console_watch(k->console);
    if (console_line(k, x->text) == STOPPED) {
        return STOPPED;
    }
    bool restarted = false;
    for (;;) {
        enum outcome r = lockstep_wait(k, replied, k->timeout_ms);
        if (r == TOO_LATE) {
            return lockstep_late(k, what);
        }
        if (r == GOT_IT) {
            break;
        }
        if (r == STOPPED || (r = lockstep_recover(k, &restarted)) != GOT_IT) {
            return r;
        }
        if (restarted && (x->may_be_cut || is_reboot(x->text))) {
            return GOT_IT; /* its ok was lost with the transmit ring */
        }
        if (restarted) {
            (void)sim_fail(k->error, sizeof(k->error),
                           "the controller restarted before its %s came", what);
            return STOPPED;
        }
    }
    if (k->console->reply == REPLY_ERR && !x->may_fail) {
        (void)sim_fail(k->error, sizeof(k->error), "%s:%u: \"%.*s\" was answered \"%s\"",
                       k->script->file, x->line, shown, x->text, k->console->reply_text);
        return STOPPED;
    }
    if (brings_plant(k, x->text)) {
        return lockstep_next_sample(k);
    }
    if (k->console->reply == REPLY_OK && is_reboot(x->text)) {
        while (!restarted) { /* no sample goes to the firmware that is about to end */
            enum outcome r = lockstep_wait(k, never, k->timeout_ms);
            if (r == TOO_LATE) {
                return lockstep_late(k, "HELLO from the rebooted controller");
            }
            if (r != REGREETED || (r = lockstep_recover(k, &restarted)) != GOT_IT) {
                return r;
            }
        }
    }
    return GOT_IT;
}

/* Is what this line waits for there? */
static enum outcome until(struct lockstep *k, struct script_line *x, double time_s, bool *there)
{
    *there = console_announced(k->console, x->text);
    if (*there) {
        return GOT_IT;
    }
    if (x->waiting_s < 0.0) {
        x->waiting_s = time_s;
    }
    if (x->limit_s < 0.0 || time_s - x->waiting_s <= x->limit_s) {
        return GOT_IT;
    }
    (void)sim_fail(k->error, sizeof(k->error),
                   "at plant time %.3f s: %s:%u: no event %.120s within %g s", time_s,
                   k->script->file, x->line, x->text, x->limit_s);
    return STOPPED;
}

enum outcome lockstep_lines(struct lockstep *k, double time_s)
{
    if (k->console == NULL) {
        return GOT_IT;
    }
    for (; k->script->next < k->script->n; k->script->next++) {
        struct script_line *x = &k->script->list[k->script->next];
        if (x->time_s > time_s) {
            break;
        }
        if (x->kind == SCRIPT_END) {
            k->ended = true;
            break;
        }
        bool there = true;
        enum outcome r =
            x->kind == SCRIPT_UNTIL ? until(k, x, time_s, &there) : lockstep_one_line(k, x);
        if (r != GOT_IT) {
            return r;
        }
        if (!there) {
            break;
        }
    }
    return GOT_IT;
}

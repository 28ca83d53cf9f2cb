/* The two levels of the console: operators look at everything and operate; engineers change it. */
#include <string.h>

#include "hal/clock.h"
#include "console/console.h"

/* No other try meanwhile, and twice as long after each wrong key in a row: a key is not found by trying them all. */
#define WRONG_KEY_MS      2000u
#define WRONG_KEY_MOST_MS 60000u

/* The low bits of the board's clock: what is compared lies less than 49 days apart. */
static uint32_t now_ms(void)
{
    return (uint32_t)hal_clock_ms();
}

static const struct config *settings(const struct console *c)
{
    return &service_plan(c->service)->config;
}

bool console_is_engineer(const struct console *c)
{
    return c->unlocked || !settings(c)->console_key[0];
}

void console_engineer_acts(struct console *c)
{
    c->unlocked = true; /* also without a key: whoever sets one is not locked out by it */
    c->engineer_ms = now_ms();
}

static uint32_t relock_ms(const struct console *c)
{
    return (uint32_t)(settings(c)->relock_s * 1000.0f);
}

void console_relock(struct console *c)
{
    if (!c->unlocked || relock_ms(c) == 0 || now_ms() - c->engineer_ms < relock_ms(c))
        return;
    c->unlocked = false;
    if (settings(c)->console_key[0])
        service_record(c->service, EVENT_DO_LOCK, "time", 0.0f, EVENT_ENGINEER);
}

void console_access_text(const struct console *c, struct text *line)
{
    if (!settings(c)->console_key[0]) {
        text_str(line, "engineer level open: no key is set (`key NEW` sets one)");
    } else if (!c->unlocked) {
        text_str(line, "engineer level locked (`unlock KEY` opens it)");
    } else {
        text_str(line, "engineer level unlocked");
        if (relock_ms(c)) {
            uint32_t passed = now_ms() - c->engineer_ms;
            text_str(line, ", locks itself in s ");
            text_u32(line, (relock_ms(c) - passed) / 1000u);
        }
    }
}

bool console_line_is_secret(const char *line)
{
    while (*line == ' ')
        line++;
    return strncmp(line, "unlock", 6) == 0 || strncmp(line, "key", 3) == 0 ||
           strstr(line, "console.key") != NULL;
}

static void refuse_key(struct console *c, enum err err, const char *why, uint32_t wait_ms)
{
    char line[CONSOLE_OUTPUT_MAX];
    struct text t = console_err_on(line, sizeof line, err);
    text_str(&t, why);
    text_str(&t, "; the next try is looked at in s ");
    text_u32(&t, (wait_ms + 999u) / 1000u);
    console_err_line(c, line);
}

void command_unlock(struct console *c, unsigned n, char **word)
{
    uint32_t passed_ms = now_ms() - c->wrong_ms;
    (void)n;
    if (passed_ms < c->wrong_wait_ms) {
        refuse_key(c, ERR_BUSY, "after a wrong key none is looked at",
                   c->wrong_wait_ms - passed_ms);
        return;
    }
    if (settings(c)->console_key[0] && strcmp(word[0], settings(c)->console_key) != 0) {
        uint32_t wait_ms = c->wrong_wait_ms ? 2u * c->wrong_wait_ms : WRONG_KEY_MS;
        c->wrong_wait_ms = wait_ms < WRONG_KEY_MOST_MS ? wait_ms : WRONG_KEY_MOST_MS;
        c->wrong_ms = now_ms();
        service_record_one_more(c->service, EVENT_WRONG_KEY, EVENT_DO_UNLOCK);
        refuse_key(c, ERR_LOCKED, "that is not the key", c->wrong_wait_ms);
        return;
    }
    c->wrong_wait_ms = 0;
    console_engineer_acts(c);
    console_ok(c);
}

void command_lock(struct console *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    if (!settings(c)->console_key[0]) {
        console_err(c, ERR_STATE, "no key is set; `key NEW` sets one");
        return;
    }
    c->unlocked = false;
    console_ok(c);
}

void command_key(struct console *c, unsigned n, char **word)
{
    char name[] = "console.key";
    char *words[] = {name, word[0]};
    (void)n;
    command_set(c, 2, words);
}

/* The two levels of the console: operators look at everything and operate; engineers change it. */
#include <string.h>

#include "hal/clock.h"
#include "service/console.h"

#define WRONG_KEY_MS 2000 /* no other try meanwhile: a key is not found by trying them all */

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

void command_unlock(struct console *c, unsigned n, char **word)
{
    uint32_t now = now_ms();
    (void)n;
    if (c->wrong_key && now - c->wrong_ms < WRONG_KEY_MS) {
        console_err(c, ERR_BUSY, "after a wrong key the next is looked at 2 s later");
        return;
    }
    if (settings(c)->console_key[0] && strcmp(word[0], settings(c)->console_key) != 0) {
        c->wrong_key = true;
        c->wrong_ms = now;
        service_record(c->service, EVENT_WRONG_KEY, NULL, 0.0f, 0);
        console_err(c, ERR_LOCKED, "that is not the key; the next try is looked at 2 s later");
        return;
    }
    c->wrong_key = false;
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

/* Console commands on stored settings: save, load, defaults, dump. */
#include <string.h>

#include "console/console.h"
#include "service/parameters.h"
#include "service/storage.h"

enum { NOTHING, SAVE_ASKED, REPLACE_ASKED, SAVING, LOAD_ASKED };

static void recorded_ok(struct console *c, const char *what)
{
    service_record(c->service, EVENT_DO_STORAGE, what, 0.0f, EVENT_ENGINEER);
    console_ok(c);
}

static void begin_save(struct console *c)
{
    const char *why = "a proposal is on trial: save when it is kept, or after `commission abort`";
    enum err err = ERR_STATE;
    if (!console_commission_on_trial(c))
        err = storage_save(c->service->storage, c->storage == REPLACE_ASKED, &why);
    c->storage = err ? NOTHING : SAVING;
    if (err)
        console_err_about(c, err, "not saved", why);
}

static void finish_save(struct console *c)
{
    const char *why = NULL;
    if (storage_saving(c->service->storage))
        return;
    c->storage = NOTHING;
    enum err err = storage_result(c->service->storage, &why);
    if (err)
        console_err_about(c, err, "not saved", why);
    else
        recorded_ok(c, "save");
}

/* What is in the scratch plan goes into force, or within a transaction waits for `apply`. */
static void take_staged(struct console *c, const char *what)
{
    struct service *s = c->service;
    struct config_fault fault;
    if (s->staging)
        console_ok(c);
    else if (service_apply(s, service_staged(s), &fault) != ERR_OK)
        console_refuse_config(c, &fault);
    else
        recorded_ok(c, what);
}

static struct config *stage(struct console *c)
{
    return c->service->staging ? service_staged(c->service) : service_stage(c->service);
}

static void load(struct console *c)
{
    struct service *s = c->service;
    const char *why = NULL;
    c->storage = NOTHING;
    enum err err = storage_load(s->storage, stage(c), &why);
    if (err)
        console_err_about(c, err, "not loaded", why);
    else
        take_staged(c, "load");
}

bool console_storage_poll(struct console *c)
{
    bool ready = storage_ready(c->service->storage);
    if (c->storage == SAVING)
        finish_save(c);
    else if (ready && (c->storage == SAVE_ASKED || c->storage == REPLACE_ASKED))
        begin_save(c);
    else if (ready && c->storage == LOAD_ASKED)
        load(c);
    return true;
}

void command_save(struct console *c, unsigned n, char **word)
{
    if (n && strcmp(word[0], "replace") != 0) {
        console_err_about(c, ERR_PARSE, word[0], "only `save` or `save replace`");
        return;
    }
    c->storage = n ? REPLACE_ASKED : SAVE_ASKED;
}

void command_load(struct console *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    c->storage = LOAD_ASKED;
}

void command_defaults(struct console *c, unsigned n, char **word)
{
    char key[CHANNEL_NAME_SIZE];
    (void)n;
    (void)word;
    /* The key stays: nobody opens the console to everyone by asking for other settings. */
    struct config *staged = stage(c);
    memcpy(key, staged->console_key, sizeof key);
    parameters_defaults(staged);
    memcpy(staged->console_key, key, sizeof key);
    take_staged(c, "defaults");
}

static bool dump_line(struct console *c, unsigned n, struct text *line)
{
    const struct service *s = c->service;
    const struct config *config =
        s->staging ? &s->plan[s->newest ^ 1u].config : &service_plan(s)->config;
    struct parameter p;
    if (n < 2) {
        text_str(line, n == 0 ? "begin" : "defaults");
        return true;
    }
    n -= 2;
    if (parameter_at(n, &p)) {
        if (!record_wanted(&p, config))
            return true;
        text_str(line, "set ");
        parameter_name(&p, line);
        text_char(line, ' ');
        parameter_value(&p, config, line);
        return true;
    }
    if (!parameter_at(n - 1, &p))
        return false;
    text_str(line, "apply");
    return true;
}

void command_dump(struct console *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    console_list(c, dump_line, "");
}

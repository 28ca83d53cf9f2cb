/* The settings that a client writes before they come into force, who may write them, and settings one by one. */
#include "operate/operate_internal.h"
#include "storage/storage.h"

/* A build without calibration lacks parameters that other builds have. */
#define NO_PARAMETER                                                                               \
    (CONFIG_CALIBRATION ? "no such parameter; `list all` shows them"                               \
                        : "no such parameter in this board's build; `list all` shows them")

const struct config *operate_view(const struct session *session)
{
    struct service *s = session->door->service;
    return s->staging ? service_staged(s) : operate_settings(session);
}

struct config *operate_stage(struct session *session, struct answer *answer)
{
    struct service *s = session->door->service;
    operate_watch_tables(s);
    if (s->staging && session->door->editor == session)
        return service_staged(s);
    /* The last two: the place where settings are written is being saved, or named on a line half printed. */
    if (s->staging || storage_saving(s->storage) || s->telemetry.printing) {
        (void)!operate_refuse(answer, ERR_BUSY, NULL,
                              s->staging ? "another client has opened a transaction"
                                         : "another client reads the settings, try again");
        return NULL;
    }
    return service_stage(s);
}

bool operate_settings_are_free(const struct service *s)
{
    /* An open transaction and a sequence are somebody's work, a save has the scratch plan, and a line of telemetry under
     * way needs the names of its plan. */
    bool read = s->telemetry.printing || storage_saving(s->storage);
    return !s->staging && !read && !operate_sequence_runs(s);
}

bool operate_may_change_settings(const struct operate *door)
{
    const struct service *s = door->service;
    return operate_settings_are_free(s) && !s->supervisor->testing && !operate_start_up_on_trial(s);
}

enum err operate_activate(struct session *session, struct answer *answer)
{
    struct service *s = session->door->service;
    enum err err = operate_keep_acting_loops(s, service_staged(s), &answer->config);
    if (!err)
        err = service_apply(s, service_staged(s), &answer->config);
    if (!err)
        return ERR_OK;
    if (!answer->config.group)
        return operate_refuse(answer, err, NULL, QUEUE_FULL);
    answer->more = ANSWER_CONFIG;
    return err;
}

enum err operate_activate_unless_open(struct session *session, struct answer *answer)
{
    return operate_is_open(session) ? ERR_OK : operate_activate(session, answer);
}

enum err operate_find_parameter(const struct session *session, const char *name,
                                struct parameter *p, struct answer *answer)
{
    enum err err = parameter_find_in(operate_view(session), name, p);
    if (err == ERR_UNSUPPORTED) {
        answer->subject = name;
        answer->more = ANSWER_PLACES;
        answer->value.parameter = *p;
    } else if (CONFIG_BLOCKS && err == ERR_EMPTY) {
        err = operate_refuse(answer, ERR_UNKNOWN, name,
                             "no such parameter: this build lacks the kind of the block");
    } else if (err) {
        (void)!operate_refuse(answer, err, name, NO_PARAMETER);
    }
    return err;
}

static enum err refuse_value(struct answer *answer, enum err err, const struct parameter *p,
                             const char *text)
{
    answer->more = ANSWER_VALUE;
    answer->value.parameter = *p;
    answer->value.text = text;
    return err;
}

static enum err set_in_words(struct session *session, const struct parameter *p, const char *text,
                             struct answer *answer)
{
    struct config *staged = operate_stage(session, answer);
    if (!staged)
        return ERR_BUSY;
    enum err err = parameter_set(p, staged, text);
    if (err == ERR_FULL)
        err = operate_block_figures(p, staged, text, answer);
    return err ? refuse_value(answer, err, p, text) : operate_activate_unless_open(session, answer);
}

/* Within a transaction only operate_apply() does anything. */
static void record_set(const struct session *session, const char *name, float value)
{
    if (!operate_is_open(session))
        operate_record(session, EVENT_DO_SET, name, value);
}

enum err operate_set(struct session *session, const char *name, const char *value,
                     struct answer *answer)
{
    struct parameter p;
    float number;
    enum err err = operate_admit(session, "set", answer);
    if (!err)
        err = operate_find_parameter(session, name, &p, answer);
    if (!err)
        err = set_in_words(session, &p, value, answer);
    if (err)
        return err;
    if (parameter_is_secret(&p) || text_parse_float(value, &number) != ERR_OK)
        number = 0.0f;
    char full[CHANNEL_NAME_SIZE];
    record_set(session, operate_full_name(&p, name, full), number);
    return ERR_OK;
}

enum err operate_set_number(struct session *session, const struct parameter *p, float value,
                            struct answer *answer)
{
    char name[CHANNEL_NAME_SIZE];
    struct text t = text_on(name, sizeof name);
    enum err err = operate_admit(session, "set", answer);
    struct config *staged = err ? NULL : operate_stage(session, answer);
    if (!staged)
        return err ? err : ERR_BUSY;
    err = parameter_set_number(p, staged, value);
    answer->value.needed = 0; /* ERR_FULL can only be a table */
    err = err ? refuse_value(answer, err, p, NULL) : operate_activate_unless_open(session, answer);
    if (err)
        return err;
    parameter_name(p, &t);
    record_set(session, name, value);
    return ERR_OK;
}

enum err operate_key(struct session *session, const char *key, struct answer *answer)
{
    struct parameter p;
    enum err err = operate_admit(session, "key", answer);
    if (!err)
        err = operate_find_parameter(session, "console.key", &p, answer);
    if (!err)
        err = set_in_words(session, &p, key, answer);
    if (!err)
        operate_record(session, EVENT_DO_KEY, NULL, 0.0f);
    return err;
}

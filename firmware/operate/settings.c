/* The transaction, and settings one by one. */
#include "operate/operate_internal.h"

/* A build without calibration lacks parameters that other builds have. */
#define NO_PARAMETER                                                                               \
    (CONFIG_CALIBRATION ? "no such parameter; `list all` shows them"                               \
                        : "no such parameter in this board's build; `list all` shows them")

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

enum err operate_begin(struct session *session, struct answer *answer)
{
    struct service *s = session->door->service;
    enum err err = operate_admit(session, "begin", answer);
    if (err)
        return err;
    if (s->staging)
        return operate_refuse(answer, ERR_STATE, NULL, OPEN_ALREADY);
    if (!operate_stage(session, answer))
        return ERR_BUSY;
    s->staging = true;
    session->door->editor = session;
    return ERR_OK;
}

bool operate_changes(const struct session *session, const struct parameter *p)
{
    return !parameter_equal(p, operate_view(session), operate_settings(session));
}

enum err operate_apply(struct session *session, struct answer *answer)
{
    struct service *s = session->door->service;
    struct parameter p;
    enum err err = operate_admit(session, "apply", answer);
    if (err)
        return err;
    if (!s->staging)
        return operate_refuse(answer, ERR_STATE, NULL, "no transaction is open: begin one first");
    if (!operate_stage(session, answer))
        return ERR_BUSY;
    unsigned changes = 0;
    for (unsigned i = 0; parameter_of(operate_view(session), i, &p); i++)
        changes += operate_changes(session, &p);
    err = operate_activate(session, answer);
    if (err)
        return err; /* it stays open to be mended */
    operate_transaction_over(session->door, true);
    operate_record(session, EVENT_DO_APPLY, NULL, (float)changes);
    return ERR_OK;
}

enum err operate_abandon(struct session *session, struct answer *answer)
{
    struct service *s = session->door->service;
    enum err err = operate_admit(session, "abandon", answer);
    if (err)
        return err;
    if (!s->staging)
        return operate_refuse(answer, ERR_STATE, NULL, "no transaction is open");
    operate_transaction_over(session->door, false);
    return ERR_OK;
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
    record_set(session, name, number);
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

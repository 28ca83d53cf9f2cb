/* The transaction: many settings that come into force together. */
#include "operate/operate_internal.h"

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

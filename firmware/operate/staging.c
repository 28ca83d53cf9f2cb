/* The settings that a client writes before they come into force, and who may write them. */
#include "operate/operate_internal.h"
#include "storage/storage.h"

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

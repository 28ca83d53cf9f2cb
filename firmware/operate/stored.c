/* Settings saved, loaded and replaced by the defaults. */
#include <string.h>

#include "hal/self_check.h"
#include "operate/operate_internal.h"
#include "storage/storage.h"

static enum err recorded(const struct session *session, const char *act)
{
    service_record(session->door->service, EVENT_DO_STORAGE, act, 0.0f, EVENT_ENGINEER);
    return ERR_OK;
}

static enum err wait_for(struct session *session, enum operate_wait what, const char *act,
                         struct answer *answer)
{
    enum err err = operate_admit(session, act, answer);
    if (!err && operate_waits(session))
        err = operate_refuse(answer, ERR_BUSY, NULL, NULL);
    if (!err)
        session->waits_for = (uint8_t)what;
    return err;
}

enum err operate_save(struct session *session, unsigned how, struct answer *answer)
{
    enum err err = operate_admit(session, "save", answer);
    if (BOARD_CHECKS && !err && (how & SAVE_UNSAFE) == 0 && hal_brown_out_off())
        err = operate_refuse(answer, ERR_STATE, "not saved",
                             "the brown-out reset is off, so a supply that falls may spoil what is "
                             "stored: set level 3, or `save unsafe`");
    if (err)
        return err;
    return wait_for(session, how & SAVE_REPLACE ? WAITS_TO_REPLACE : WAITS_TO_SAVE, "save", answer);
}

enum err operate_load(struct session *session, struct answer *answer)
{
    return wait_for(session, WAITS_TO_LOAD, "load", answer);
}

/* Puts staged settings into force; within a transaction they wait. */
static enum err take_staged(struct session *session, const char *act, struct answer *answer)
{
    enum err err = operate_activate_unless_open(session, answer);
    return err || operate_is_open(session) ? err : recorded(session, act);
}

static enum err begin_save(struct session *session, bool replace, struct answer *answer)
{
    const char *reason =
        "a proposal is on trial: save when it is kept, or after `commission abort`";
    enum err err = ERR_STATE;
    if (!operate_start_up_on_trial(session->door->service))
        err = storage_save(session->door->service->storage, replace, &reason);
    if (err)
        return operate_refuse(answer, err, "not saved", reason);
    session->waits_for = WAITS_SAVING;
    return ERR_BUSY;
}

static enum err finish_save(struct session *session, struct answer *answer)
{
    const char *reason = NULL;
    enum err err = storage_result(session->door->service->storage, &reason);
    return err ? operate_refuse(answer, err, "not saved", reason) : recorded(session, "save");
}

static enum err load_stored(struct session *session, struct answer *answer)
{
    const char *reason = NULL;
    struct config *staged = operate_stage(session, answer);
    if (!staged)
        return ERR_BUSY;
    enum err err = storage_load(session->door->service->storage, staged, &reason);
    return err ? operate_refuse(answer, err, "not loaded", reason)
               : take_staged(session, "load", answer);
}

enum err operate_result(struct session *session, struct answer *answer)
{
    const struct service *s = session->door->service;
    enum operate_wait what = (enum operate_wait)session->waits_for;
    if (what == WAITS_FOR_NOTHING)
        return ERR_OK;
    if (what == WAITS_SAVING ? storage_saving(s->storage)
                             : !storage_ready(s->storage) || s->telemetry.printing)
        return ERR_BUSY;
    session->waits_for = WAITS_FOR_NOTHING;
    if (what == WAITS_SAVING)
        return finish_save(session, answer);
    if (what == WAITS_TO_LOAD)
        return load_stored(session, answer);
    return begin_save(session, what == WAITS_TO_REPLACE, answer);
}

enum err operate_defaults(struct session *session, struct answer *answer)
{
    char key[CHANNEL_NAME_SIZE];
    enum err err = operate_admit(session, "defaults", answer);
    struct config *staged = err ? NULL : operate_stage(session, answer);
    if (!staged)
        return err ? err : ERR_BUSY;
    /* The key stays: nobody opens the console to everyone by asking for other settings. */
    memcpy(key, staged->console_key, sizeof key);
    parameters_defaults(staged);
    memcpy(staged->console_key, key, sizeof key);
    return take_staged(session, "defaults", answer);
}

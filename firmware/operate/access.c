/* The two levels: operators see everything and operate; engineers also change settings. Also what the rest of the door needs: a
 * refusal in words, an action in the history. */
#include <string.h>

#include "hal/clock.h"
#include "hal/retained.h"
#include "operate/operate_internal.h"

/* No other try meanwhile, and twice as long after each wrong key in a row: a key is not found by trying them all. */
#define WRONG_KEY_MS      2000u
#define WRONG_KEY_MOST_MS 60000u

#define CHECK 0x53594B52u /* "RKYS" */

/* The wait in memory that survives a reset, which would else be a way around it. */
struct wrong_keys_record {
    uint32_t wait_ms, check;
};

static struct wrong_keys_record *wrong_keys_record(void)
{
    return hal_retained(HAL_RETAINED_KEYS, sizeof(struct wrong_keys_record));
}

/* The low bits of the board's clock: what is compared lies less than 49 days apart. */
static uint32_t board_ms(void)
{
    return (uint32_t)hal_clock_ms();
}

static void begin_wait(struct operate *door, uint32_t wait_ms)
{
    struct wrong_keys_record *record = wrong_keys_record();
    door->wrong_wait_ms = wait_ms;
    door->wrong_ms = board_ms();
    if (record)
        *record = (struct wrong_keys_record){.wait_ms = wait_ms, .check = ~wait_ms ^ CHECK};
}

void operate_init(struct operate *door, struct service *service)
{
    memset(door, 0, sizeof *door);
    door->service = service;
    const struct wrong_keys_record *record = wrong_keys_record();
    if (record && record->check == (~record->wait_ms ^ CHECK) &&
        record->wait_ms <= WRONG_KEY_MOST_MS)
        begin_wait(door, record->wait_ms);
}

void session_init(struct session *session, struct operate *door)
{
    memset(session, 0, sizeof *session);
    session->door = door;
}

enum err operate_refuse(struct answer *answer, enum err code, const char *subject,
                        const char *words)
{
    answer->subject = subject;
    answer->words = words;
    answer->more = ANSWER_PLAIN;
    return code;
}

void operate_record(const struct session *session, enum event_code code, const char *subject,
                    float value)
{
    service_record(session->door->service, code, subject, value,
                   operate_is_engineer(session) ? EVENT_ENGINEER : 0);
}

bool operate_is_engineer(const struct session *session)
{
    return session->engineer || !operate_has_key(session);
}

static void engineer_acts(struct session *session)
{
    session->engineer = true; /* also without a key: whoever sets one is not locked out by it */
    session->engineer_ms = board_ms();
}

enum err operate_admit(struct session *session, const char *act, struct answer *answer)
{
    if (!operate_is_engineer(session))
        return operate_refuse(answer, ERR_LOCKED, act, NULL);
    engineer_acts(session);
    return ERR_OK;
}

static uint32_t relock_ms(const struct session *session)
{
    return (uint32_t)(operate_settings(session)->relock_s * 1000.0f);
}

bool operate_closes_in_s(const struct session *session, uint32_t *left_s)
{
    uint32_t after_ms = relock_ms(session);
    *left_s = (after_ms - (board_ms() - session->engineer_ms)) / 1000u;
    return after_ms != 0;
}

void session_poll(struct session *session)
{
    uint32_t after_ms = relock_ms(session);
    if (!session->engineer || after_ms == 0 || board_ms() - session->engineer_ms < after_ms)
        return;
    session->engineer = false;
    if (operate_has_key(session))
        service_record(session->door->service, EVENT_DO_LOCK, "time", 0.0f, EVENT_ENGINEER);
}

static enum err refuse_key(struct answer *answer, enum err err, uint32_t wait_ms)
{
    answer->subject = NULL;
    answer->words = NULL;
    answer->more = ANSWER_WAIT;
    answer->wait_ms = wait_ms;
    return err;
}

enum err operate_unlock(struct session *session, const char *key, struct answer *answer)
{
    struct operate *door = session->door;
    uint32_t passed_ms = board_ms() - door->wrong_ms;
    const char *right = operate_settings(session)->console_key;
    if (passed_ms < door->wrong_wait_ms)
        return refuse_key(answer, ERR_BUSY, door->wrong_wait_ms - passed_ms);
    if (right[0] && strcmp(key, right) != 0) {
        uint32_t wait_ms = door->wrong_wait_ms ? 2u * door->wrong_wait_ms : WRONG_KEY_MS;
        begin_wait(door, wait_ms < WRONG_KEY_MOST_MS ? wait_ms : WRONG_KEY_MOST_MS);
        service_record_one_more(door->service, EVENT_WRONG_KEY, EVENT_DO_UNLOCK);
        return refuse_key(answer, ERR_LOCKED, door->wrong_wait_ms);
    }
    begin_wait(door, 0);
    engineer_acts(session);
    operate_record(session, EVENT_DO_UNLOCK, NULL, 0.0f);
    return ERR_OK;
}

enum err operate_lock(struct session *session, struct answer *answer)
{
    if (!operate_has_key(session))
        return operate_refuse(answer, ERR_STATE, NULL, "no key is set; `key NEW` sets one");
    operate_record(session, EVENT_DO_LOCK, NULL, 0.0f);
    session->engineer = false;
    return ERR_OK;
}

enum err operate_reboot(struct session *session, struct answer *answer)
{
    enum err err = operate_admit(session, "reboot", answer);
    if (!err)
        operate_record(session, EVENT_DO_REBOOT, NULL, 0.0f);
    return err;
}

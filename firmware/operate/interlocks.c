/* Interlocks that an operator releases. */
#include <string.h>

#include "operate/operate_internal.h"

enum err operate_release(struct session *session, const char *name, struct answer *answer)
{
    struct service *s = session->door->service;
    const struct supervisor *sup = s->supervisor;
    uint32_t number = 0;
    if (strncmp(name, "lock", 4) == 0)
        (void)!text_parse_u32(name + 4, &number);
    if (number < 1 || number > sup->placed[PLACED_INTERLOCKS])
        return operate_refuse(answer, ERR_UNKNOWN, name,
                              "no such interlock; `alarm` lists those that hold");
    const struct interlock_state *state = &sup->interlock[number - 1u];
    if (!state->active)
        return operate_refuse(answer, ERR_STATE, name, "does not hold");
    if (!state->latch.alone)
        return operate_refuse(
            answer, ERR_STATE, name,
            "holds for a reason that is not over; `alarm` shows its reading and limit");
    struct request r = {
        .kind = REQUEST_RELEASE, .loop = PLAN_NONE, .output = (uint8_t)(number - 1u)};
    if (service_request(s, &r) != ERR_OK)
        return operate_refuse(answer, ERR_BUSY, NULL, QUEUE_FULL);
    operate_record(session, EVENT_DO_ALARM, name, 0.0f);
    return ERR_OK;
}

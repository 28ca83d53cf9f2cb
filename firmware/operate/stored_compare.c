/* Settings beside the stored ones. */
#include "operate/operate_internal.h"
#include "storage/storage.h"

enum err operate_may_compare(struct session *session, struct answer *answer)
{
    const char *reason;
    enum err err = storage_may_compare(session->door->service->storage, &reason);
    return err ? operate_refuse(answer, err, NULL, reason) : ERR_OK;
}

bool operate_differs(const struct session *session, const struct parameter *p, struct text *stored)
{
    return storage_differs(session->door->service->storage, p, operate_view(session), stored);
}

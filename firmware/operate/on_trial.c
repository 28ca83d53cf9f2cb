/* Settings that start-up has proposed, on trial. */
#include "exchange/tables.h"
#include "operate/operate_internal.h"

bool operate_start_up_on_trial(const struct service *s)
{
    return commission_is_on_trial(s->commission);
}

const struct config *operate_settings_before_trial(const struct service *s)
{
    return operate_start_up_on_trial(s) ? commission_old(s->commission) : NULL;
}

bool operate_is_in_acceptance(const struct session *session)
{
    return operate_start_up_on_trial(session->door->service);
}

void operate_watch_tables(const struct service *s)
{
    tables_watch(TABLES_TO_GO_BACK_TO, operate_settings_before_trial(s));
}

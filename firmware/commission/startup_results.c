#include "commission/startup_results.h"

#include "commission/commission_state.h"
#include "commission/lease.h"
#include "commission/requests.h"
#include "commission/status.h"

bool commission_has_proposal(const struct commission *c)
{
    return status_phase(&c->status) == COMMISSION_READY && lease_holds(&c->lease) &&
           c->work->analysis.designed;
}

/* Only a new beginning overwrites the results, and only the main loop asks for one. */
bool commission_keeps(const struct commission *c)
{
    return !requests_begin(&c->requests) && lease_holds(&c->lease);
}

bool commission_had_results(const struct commission *c)
{
    return status_has_results(&c->status) && !requests_begin(&c->requests);
}

bool commission_has_results(const struct commission *c)
{
    return commission_had_results(c) && lease_holds(&c->lease);
}

#include "commission/requests.h"

#include "commission/requests_state.h"

bool requests_begin(const struct startup_requests *r)
{
    return r->ask == COMMISSION_ASK_BEGIN || r->ask == COMMISSION_ASK_RELAY;
}

void requests_put_relay(struct startup_requests *r, uint8_t loop, uint32_t serial)
{
    r->relay_loop = loop;
    r->relay_serial = serial;
}

void requests_put_trial(struct startup_requests *r, uint32_t serial)
{
    r->trial_serial = serial;
    r->ask = COMMISSION_ASK_TRIAL;
}

#include "supervise/safe_state.h"

#include <string.h>

#include "supervise/outputs_safe.h"
#include "supervise/sequence.h"

void supervisor_outputs_safe(struct supervisor *s, const char *reason)
{
    sequence_safe(s, reason);
    outputs_take_safe(s, reason);
}

void supervisor_stay_safe(struct supervisor *s)
{
    char reason[CHANNEL_NAME_SIZE];
    memcpy(reason, s->safe_reason, sizeof reason);
    if (s->state != SUPERVISOR_SAFE)
        supervisor_outputs_safe(s, reason);
}

#include "supervise/safe_state.h"

#include <string.h>

#include "supervise/outputs_safe.h"
#include "supervise/sequence.h"

void supervisor_outputs_safe(struct supervisor *s, const char *why)
{
#if CONFIG_STEPS
    sequence_safe(s, why);
#endif
    outputs_take_safe(s, why);
}

void supervisor_stay_safe(struct supervisor *s)
{
    char why[CHANNEL_NAME_SIZE];
    memcpy(why, s->safe_why, sizeof why);
    if (s->state != SUPERVISOR_SAFE)
        supervisor_outputs_safe(s, why);
}

/* The trial of accepted settings: the phase COMMISSION_TRIAL. The trial itself is adoption.h; this is what surrounds it. Tick. */
#ifndef REFLUX_COMMISSION_ACCEPTANCE_H
#define REFLUX_COMMISSION_ACCEPTANCE_H

#include "commission/reasons.h"
#include "num/real.h"
#include "supervise/supervisor.h"

struct commission;

void commission_begin_trial(struct commission *c, struct supervisor *s);
/* A tick of it. */
void commission_acceptance(struct commission *c, struct supervisor *s);
/* Ends the trial because of what the adoption does not judge. True: it is over. */
bool commission_acceptance_is_disturbed(struct commission *c, struct supervisor *s);
/* The loops go to manual and their outputs to where the trial found them; a loop that somebody has taken in hand stays as it
 * is. The main loop puts the old configuration into force. */
void commission_back_to_old(struct commission *c, struct supervisor *s,
                            enum commission_reason reason, const char *subject, real_t value);

#endif

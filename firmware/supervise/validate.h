/* One reading of a tick. Within supervise only. */
#ifndef REFLUX_SUPERVISE_VALIDATE_H
#define REFLUX_SUPERVISE_VALIDATE_H

#include "supervise/supervisor.h"

/* What is to be believed of it, and what stands in for it otherwise. i: a measurement of the plan in force. */
void validate_measurement(struct supervisor *s, uint8_t i, const struct reading *r);

#endif

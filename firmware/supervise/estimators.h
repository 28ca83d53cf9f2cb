/* The stage of estimators: blocks with a number (blockN) that write measurements. Within supervise only. */
#ifndef REFLUX_SUPERVISE_ESTIMATORS_H
#define REFLUX_SUPERVISE_ESTIMATORS_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* After the plant's measurements: steps the estimators. Their points are validated like those. */
void estimators_step(struct supervisor *s);
#else
#define estimators_step(s) ((void)(s))
#endif

#endif

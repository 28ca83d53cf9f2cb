/* What a step still under way says of itself: how far its outputs are from rest, and, by the latest interim fit,
 * whether it has gone on for long enough and is large enough. Decides nothing: experiment.c does. */
#ifndef REFLUX_COMMISSION_PROGRESS_H
#define REFLUX_COMMISSION_PROGRESS_H

#include "commission/experiment_state.h"

enum progress_verdict { PROGRESS_WAIT, PROGRESS_GROW, PROGRESS_TURN };

struct progress_advice {
    enum progress_verdict what;
    real_t amplitude; /* to go on with */
    bool
        small; /* the response does not stand out of the noise as it should, and there is no room for more */
};

/* Does noise hide what is small beside a limit? */
bool progress_is_noisy(const struct experiment *e);
/* With fresh models (e->interim_fit), in the positive half. */
struct progress_advice progress_judge(const struct experiment *e, const real_t *y);

#endif

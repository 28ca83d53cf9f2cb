/* Advice on a step that is still running: by the latest interim fit, whether it has lasted long enough and is large enough.
 * experiment.c decides. Tick. */
#ifndef REFLUX_COMMISSION_PROGRESS_H
#define REFLUX_COMMISSION_PROGRESS_H

#include <stdbool.h>

#include "num/real.h"

struct experiment;

enum progress_verdict { PROGRESS_WAIT, PROGRESS_GROW, PROGRESS_TURN };

struct progress_advice {
    enum progress_verdict verdict;
    real_t amplitude; /* to go on with */
    /* The response does not exceed the noise by enough, and there is no room for a larger step. */
    bool small;
};

/* Noise hides responses that are small beside a limit. */
bool progress_is_noisy(const struct experiment *e);
/* Judges the positive half by fresh models (e->interim_fit). */
struct progress_advice progress_judge(const struct experiment *e, const real_t *y);

#endif

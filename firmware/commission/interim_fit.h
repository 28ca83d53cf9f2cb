/* A fit to a step that is still under way: the first-order model of every output, fitted to all data so far, from which
 * the test tells how long the step must go on, whether it stands out of the noise, and where it will end. */
#ifndef REFLUX_COMMISSION_INTERIM_FIT_H
#define REFLUX_COMMISSION_INTERIM_FIT_H

#include "identify/fopdt_fit.h"
#include "identify/record.h"

struct interim_fit {
    /* Results, once interim_fit_run has said that there is no more */
    struct identified found[CHANNEL_MAX];

    /* Work */
    struct record seen; /* as it was: the record itself goes on */
    struct baseline baseline[CHANNEL_MAX];
    struct fopdt_fit fit;
    uint8_t at;
    bool running;
};

/* Copies the record and what is known of each output apart from its response (record's outputs of them). Tick. */
void interim_fit_begin(struct interim_fit *l, const struct record *record,
                       const struct baseline *baseline);
/* A piece of the fits, in the background. True while there is more. An output whose fit is refused counts as one without
 * a gain. */
bool interim_fit_run(struct interim_fit *l);

/* Is a model found so far to be valid: its gain known within a third? */
bool interim_fit_is_known(const struct identified *f);

#endif

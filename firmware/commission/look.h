/* A look at a step that is still under way: the first-order model of every output, fitted to all data so far, from which
 * the test tells how long the step must go on, whether it stands out of the noise, and where it will end. */
#ifndef REFLUX_COMMISSION_LOOK_H
#define REFLUX_COMMISSION_LOOK_H

#include "identify/fopdt_fit.h"
#include "identify/record.h"

struct look {
    /* Results, once look_run has said that there is no more */
    struct identified found[CHANNEL_MAX];

    /* Work */
    struct record seen; /* as it was: the record itself goes on */
    struct baseline baseline[CHANNEL_MAX];
    struct fopdt_fit fit;
    uint8_t at;
    bool running;
};

/* Copies the record and what is known of each output apart from its response (record's outputs of them). Tick. */
void look_begin(struct look *l, const struct record *record, const struct baseline *baseline);
/* A piece of the fits, in the background. True while there is more. An output whose fit is refused counts as one without
 * a gain. */
bool look_run(struct look *l);

/* Is a model found so far to be believed: its gain known within a third? */
bool look_is_known(const struct identified *f);

#endif

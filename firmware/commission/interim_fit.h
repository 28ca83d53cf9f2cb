/* A fit to a step that is still running: the first-order model of every output, fitted to all data so far. The test decides by it
 * how long the step must last, whether it exceeds the noise and where it will end. Begun in the tick, run in the main loop. */
#ifndef REFLUX_COMMISSION_INTERIM_FIT_H
#define REFLUX_COMMISSION_INTERIM_FIT_H

#include "base/assertion.h"
#include "identify/fopdt_fit.h"
#include "identify/record.h"
#include "identify/shape_fit.h"

struct interim_fit {
    /* Results, once interim_fit_run() has said that there is no more. */
    struct identified found[CHANNEL_MAX];

    /* Work. */
    union {
        struct record seen; /* a copy, because the record itself goes on */
        struct {            /* once the test is over: the memory of its fits */
            struct shape_fit fit;
            struct shape_found found[CHANNEL_MAX];
            struct fopdt_fit_result straight, bent;
        } shape;
    };
    struct baseline baseline[CHANNEL_MAX];
    struct fopdt_fit fit;
    uint8_t output; /* under work */
    bool running;
};

/* Copies the record and the baseline of each of its outputs. Tick. */
void interim_fit_begin(struct interim_fit *l, const struct record *record,
                       const struct baseline *baseline);
/* Does a piece of the fits. True while there is more. An output whose fit is refused counts as one without a gain. Main loop. */
bool interim_fit_run(struct interim_fit *l);

/* The time until the response of a model is over is known within a half. Under a drift the time constant itself must be. */
bool interim_fit_is_timed(const struct identified *f, bool drifts);
/* The gain of a model is known within a third. */
bool interim_fit_is_known(const struct identified *f);

/* The model of output j. */
static inline const struct identified *interim_fit_found(const struct interim_fit *l, unsigned j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return &l->found[j];
}

/* Found shape of output j, by the fits after the test. */
static inline struct shape_found *interim_fit_shape(struct interim_fit *l, unsigned j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return &l->shape.found[j];
}

/* The memory of a fit, free once the test is over. */
static inline struct fopdt_fit *interim_fit_memory(struct interim_fit *l)
{
    return &l->fit;
}

#endif

/* The state of model.c. */
#ifndef REFLUX_COMMISSION_MODEL_STATE_H
#define REFLUX_COMMISSION_MODEL_STATE_H

#include "base/assertion.h"
#include "base/error.h"
#include "exchange/config.h"
#include "identify/identified.h"

/* The fits of the latest test. The main loop's while the task is under way, else the tick's. */
struct model_fits {
    struct identified fitted[CHANNEL_MAX]; /* by output */
    real_t climbs[CHANNEL_MAX];            /* how it went on climbing: test_verdict.h */
    real_t doubt; /* variance of the gain that the fit does not know of, of the output under work */
    real_t sd_least; /* of that gain: its deviation beside a drift that turns */
    enum err error;
    uint8_t output; /* under work */
    uint8_t stage;  /* its fit: model.c */
    /* Gain of the output along the direction, read from the plateaus; valid where has_plateau. */
    real_t plateau;
    bool plateau_read, has_plateau;
};

static inline enum err model_error(const struct model_fits *m)
{
    return m->error;
}

/* The fit of output j. */
static inline const struct identified *model_fitted(const struct model_fits *m, unsigned j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return &m->fitted[j];
}

/* Measure of how output j went on climbing (test_verdict.h); 0 where it came to rest. */
static inline real_t model_climbs(const struct model_fits *m, unsigned j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return m->climbs[j];
}

#endif

/* The state of experiment.c. */
#ifndef REFLUX_COMMISSION_EXPERIMENT_STATE_H
#define REFLUX_COMMISSION_EXPERIMENT_STATE_H

#include "base/assertion.h"
#include "commission/experiment_config.h"
#include "commission/interim_fit.h"
#include "commission/limits_state.h"
#include "identify/moments.h"
#include "identify/record.h"
#include "identify/steady.h"

struct experiment {
    struct experiment_config config;
    enum experiment_phase phase;
    enum experiment_failure failure;
    uint8_t culprit;  /* output for which it failed, or for which the guard cut the step */
    bool begun;       /* there has been a sample */
    bool watched;     /* the rest before the first test has been watched for longer */
    bool cut;         /* the guard ended the positive half */
    bool one_sided;   /* there is no negative half, because a smaller step follows */
    bool pausing;     /* at 0 between the halves: what the reversal would do was not known */
    bool at_longest;  /* half_most ended the positive half before it came to rest */
    bool small;       /* the largest amplitude was not enough for noise_multiple */
    real_t predicted; /* peak that the guard predicted, fraction of span */
    real_t amplitude; /* of the present level or the last one */
    real_t level;     /* of the present test signal, fraction of span */
    uint32_t waited;  /* samples in this phase */
    uint32_t half;    /* samples since the last positive edge, then length of the negative half */
    uint32_t samples; /* since the first edge */
    real_t last[CHANNEL_MAX];        /* sample */
    real_t at_turn[CHANNEL_MAX];     /* deviation from rest where the negative half began */
    real_t rest[CHANNEL_MAX];        /* level before the step */
    real_t drift_per_s[CHANNEL_MAX]; /* slope before the step, where that exceeds the noise */
    struct steady_result before[CHANNEL_MAX], after[CHANNEL_MAX];
    uint8_t
        renewal[CHANNEL_MAX]; /* samples after which a sensor gives a new value; 0 and 1: each */
    real_t coarse_sd[CHANNEL_MAX]; /* of a coarse sensor's steps, fraction of span */
    bool returned;                 /* `after` is from outputs at rest */

    /* The interim fit: experiment_step() begins it, the main loop runs it, experiment_take_interim_fit() takes it. */
    bool interim_fitting;
    bool interim_fitted;       /* there is a model of this step */
    bool fresh;                /* no decision has used that model yet */
    uint32_t next_interim_fit; /* samples since the first edge */
    struct interim_fit interim_fit;

    struct steady steady;
    struct record record;
    struct moments moments;
    struct limits limits;
};

static inline const struct experiment_config *experiment_settings(const struct experiment *e)
{
    return &e->config;
}

static inline enum experiment_phase experiment_phase(const struct experiment *e)
{
    return e->phase;
}

/* The lines of rest after the step are from outputs at rest. */
static inline bool experiment_has_returned(const struct experiment *e)
{
    return e->returned;
}

static inline enum experiment_failure experiment_failure(const struct experiment *e)
{
    return e->failure;
}

/* The output for which it failed, or for which the guard cut the step. */
static inline uint8_t experiment_culprit(const struct experiment *e)
{
    return e->culprit;
}

/* The peak that the guard predicted, fraction of span. */
static inline real_t experiment_predicted(const struct experiment *e)
{
    return e->predicted;
}

/* There has been a sample. */
static inline bool experiment_has_begun(const struct experiment *e)
{
    return e->begun;
}

static inline bool experiment_is_cut(const struct experiment *e)
{
    return e->cut;
}

static inline bool experiment_is_one_sided(const struct experiment *e)
{
    return e->one_sided;
}

/* It is at 0 between the halves. */
static inline bool experiment_is_pausing(const struct experiment *e)
{
    return e->pausing;
}

static inline bool experiment_is_small(const struct experiment *e)
{
    return e->small;
}

/* An interim fit waits for the main loop. */
static inline bool experiment_wants_interim_fit(const struct experiment *e)
{
    return e->interim_fitting;
}

/* There is a model of this step. */
static inline bool experiment_has_model(const struct experiment *e)
{
    return e->interim_fitted;
}

static inline real_t experiment_amplitude(const struct experiment *e)
{
    return e->amplitude;
}

static inline real_t experiment_level(const struct experiment *e)
{
    return e->level;
}

/* Length of a half in samples, and in seconds. */
static inline uint32_t experiment_half(const struct experiment *e)
{
    return e->half;
}

static inline real_t experiment_half_s(const struct experiment *e)
{
    return (real_t)e->half * e->config.h_s;
}

/* Samples since the first edge. */
static inline uint32_t experiment_samples(const struct experiment *e)
{
    return e->samples;
}

/* Samples in this phase. */
static inline uint32_t experiment_waited(const struct experiment *e)
{
    return e->waited;
}

/* The sample before. */
static inline const real_t *experiment_last(const struct experiment *e)
{
    return e->last;
}

/* Rest, slope and deviation at the reversal of output j. */
static inline real_t experiment_rest(const struct experiment *e, unsigned j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return e->rest[j];
}

static inline real_t experiment_slope(const struct experiment *e, unsigned j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return e->drift_per_s[j];
}

/* An output drifted before the step, beyond its noise. */
static inline bool experiment_drifts(const struct experiment *e)
{
    for (unsigned j = 0; j < e->config.outputs; j++)
        if (real_abs(e->drift_per_s[j]) > REAL_C(0.0))
            return true;
    return false;
}

static inline real_t experiment_at_turn(const struct experiment *e, unsigned j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return e->at_turn[j];
}

/* Samples after which the sensor of output j gives a new value; 1: each. */
static inline unsigned experiment_renewal(const struct experiment *e, unsigned j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return e->renewal[j] > 1u ? e->renewal[j] : 1u;
}

/* The lines of rest before the step and after it. */
static inline const struct steady_result *experiment_before(const struct experiment *e, unsigned j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return &e->before[j];
}

static inline const struct steady_result *experiment_after(const struct experiment *e, unsigned j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return &e->after[j];
}

static inline const struct record *experiment_record(const struct experiment *e)
{
    return &e->record;
}

static inline struct record *experiment_record_to_edit(struct experiment *e)
{
    return &e->record;
}

static inline const struct moments *experiment_moments(const struct experiment *e)
{
    return &e->moments;
}

/* The model of output j by the latest interim fit. */
static inline const struct identified *experiment_found(const struct experiment *e, unsigned j)
{
    return interim_fit_found(&e->interim_fit, j);
}

static inline const struct limits *experiment_limits(const struct experiment *e)
{
    return &e->limits;
}

static inline struct interim_fit *experiment_interim_fit(struct experiment *e)
{
    return &e->interim_fit;
}

static inline struct limits *experiment_guards(struct experiment *e)
{
    return &e->limits;
}

#endif

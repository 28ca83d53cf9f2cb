/* The state of adoption.c. */
#ifndef REFLUX_COMMISSION_ADOPTION_STATE_H
#define REFLUX_COMMISSION_ADOPTION_STATE_H

#include "base/assertion.h"
#include "commission/margin_probe_state.h"
#include "commission/trial_records.h"
#include "commission/trial_step_state.h"
#include "exchange/plan.h"

struct adoption {
    uint8_t n;        /* loops with a setpoint to step */
    uint8_t n_inner;  /* inner loops, behind the others in loop[] */
    uint8_t turn;     /* loop under trial */
    uint8_t channels; /* in channel[] */
    uint32_t window;  /* samples over which rest is judged */
    uint32_t back;    /* samples that a response takes to be over */
    struct adoption_channel channel[CHANNEL_MAX];
    struct adoption_loop loop[CONFIG_LOOPS];
    enum adoption_result result;
    enum adoption_result doubt; /* verdict on the step before the rest */
    uint8_t culprit;            /* in channel[] */
    uint8_t stage, repeats, patience;
    bool drifting; /* a measurement has drifted: rest between any two steps */
    bool placed;   /* the setpoints are written */
    uint32_t ticks, stage_ticks;
    uint32_t since;               /* ticks since the lines were fitted */
    real_t asked[CONFIG_LOOPS];   /* setpoints, as written */
    struct trial_step trial_step; /* of the loop under trial */
    struct margin_probe probe;    /* of the loop under trial */
    struct steady *steady;        /* work */
    struct origin *origin;
};

/* Samples of a setpoint step, 20 to 1e6. */
static inline uint32_t adoption_step_samples(const struct adoption_loop *l, real_t tick_s)
{
    real_t ticks = l->duration_s / tick_s;
    return ticks < REAL_C(20.0) ? 20u : ticks > REAL_C(1e6) ? 1000000u : (uint32_t)ticks;
}

/* The setpoint step of loop k becomes another. */
static inline void adoption_set_step(struct adoption *a, unsigned k, real_t step)
{
    REFLUX_ASSERT(k < a->n);
    a->loop[k].step = step;
}

/* Predictions for the ways back with a raised gain, one for each loop; they must stay until the trial ends. */
static inline void adoption_probe_with(struct adoption *a, const struct trial_probe *probe)
{
    margin_probe_with(&a->probe, probe);
}

/* The loop, an index in the plan, that is to have its gain raised now; PLAN_NONE: none. */
static inline uint8_t adoption_raised(const struct adoption *a)
{
    REFLUX_ASSERT(a->turn <= a->n);
    return margin_probe_is_raised(&a->probe) ? a->loop[a->turn].loop : PLAN_NONE;
}

/* Number of loops with a setpoint to step. */
static inline uint8_t adoption_loops(const struct adoption *a)
{
    return a->n;
}

/* The loop under trial. */
static inline uint8_t adoption_turn(const struct adoption *a)
{
    return a->turn;
}

static inline const struct adoption_loop *adoption_loop(const struct adoption *a, unsigned k)
{
    REFLUX_ASSERT(k < CONFIG_LOOPS);
    return &a->loop[k];
}

/* Channel k is that of loop k; there are as many as outputs were tested. */
static inline const struct adoption_channel *adoption_channel(const struct adoption *a, unsigned k)
{
    REFLUX_ASSERT(k < CHANNEL_MAX);
    return &a->channel[k];
}

static inline uint8_t adoption_channels(const struct adoption *a)
{
    return a->channels;
}

#endif

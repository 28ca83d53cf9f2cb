/* The state of a block of the kind `gmv`, for the files that make up the kind. */
#ifndef REFLUX_GMV_GMV_BLOCK_H
#define REFLUX_GMV_GMV_BLOCK_H

#include "kinds/gmv/gmv_settings.h"

#if CONFIG_BLOCKS

#include "kinds/gmv/gmv_detune.h"
#include "signal/pid.h"

struct gmv_block {
    struct gmv_supervise watch;
    struct pid pi[GMV_LOOPS];
    uint8_t loops, disturbances;
    float lambda[GMV_LOOPS], times, detune; /* as set; times which it is in use; the most of that */
    bool relative;
    float margin, excite;
    struct gmv_trial_pi trial_pi[GMV_LOOPS];
    num_t speed, gain_least;
    float start[GMV_LOOPS][GMV_PARAMETERS]; /* theta of the settings */
    /* Of the last step, or of what followed it. */
    bool begun; /* the data has */
    num_t in[GMV_LOOPS], setpoint[GMV_LOOPS], told[GMV_LOOPS];
    num_t given[GMV_LOOPS]; /* before limits */
    uint8_t acting;
    uint8_t fading_in; /* steps since the law has begun to compute */
    bool singular;
    /* Limits of the MVs, as far as they have shown; what the law asked for. */
    num_t lo[GMV_LOOPS], hi[GMV_LOOPS], asked[GMV_LOOPS];
    bool has_asked;
    /* Proposals. */
    bool proposes, waits;
    uint8_t proposed; /* values that are in the settings */
    float adopted[GMV_LOOPS][GMV_PARAMETERS];
    bool on_trial,
        trial_wanted;         /* what is worked on will be looked at; another trial is to begin */
    struct gmv_trial trial;   /* the work's own while it is wanted */
    struct gmv_detune search; /* likewise */
};

static inline struct gmv *gmv_of(struct gmv_block *s)
{
    return (struct gmv *)(void *)((char *)s + ((sizeof *s + 7u) & ~(size_t)7u));
}

static inline const struct gmv *gmv_of_const(const struct gmv_block *s)
{
    return (const struct gmv *)(const void *)((const char *)s + ((sizeof *s + 7u) & ~(size_t)7u));
}

/* ---- moves (gmv_moves.c) ---- */

/* g_ii,0 of the law with the parameters in use. */
float gmv_own_gain(const struct gmv *g, unsigned i);
/* lambda as a multiple of it, where the settings want that, and as much larger as a trial has found. */
void gmv_set_weights(struct gmv_block *s);
/* What came of the last outputs shows where the limits are: an MV that was asked to move and did not is at one. */
void gmv_learn_limits(struct gmv_block *s, const struct gmv_sample *sample);
void gmv_forget_limits(struct gmv_block *s);
/* The law computes from now on. */
void gmv_begin_law(struct gmv_block *s);
/* Outputs of the members that act. False: there is no number. */
bool gmv_step_law(struct gmv_block *s, const struct gmv_sample *sample, struct block_io *io);

/* Estimates and parameters in use are the settings' theta, the covariance p0. */
void gmv_start_again(struct gmv_block *s);

/* Parameters that were adopted become settings of the block. Returns enum gmv_wish, as gmv_supervise_accepted. */
void gmv_propose(struct gmv_block *s);
uint8_t gmv_proposals_step(struct gmv_block *s, struct block_proposal *room);

const char *gmv_describe(const void *state, size_t i, float *value);

#define GMV_VERBS 5
extern const struct block_verb gmv_verb_rows[GMV_VERBS];

#endif
#endif

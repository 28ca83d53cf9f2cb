/* Settings of a block of the kind `ff_tune`: the rows of parameters, the checks, and what follows from the settings. */
#ifndef REFLUX_FF_TUNE_TUNE_SETTINGS_H
#define REFLUX_FF_TUNE_TUNE_SETTINGS_H

#include "identify/high_order.h"
#include "kinds/ff_tune/feedforward_tune.h"
#include "kinds/ff_tune/loop_shadow.h"

/* Parts of a test. */
#define TUNE_PARTS 8u

/* The kind sets it when the block is configured; the parts of the block read it. */
struct tune_context {
    struct tune_settings s;
    struct block_signal y_signal, d_signal;
    /* Orders of the models: [0] of the loop, nothing for A; [1] of the disturbance, for A of both. */
    struct high_order_shape shape[2];
    /* Interval of a sample, of a step. */
    real_t h_s, tick_s;
    /* Steps of a sample; pieces of work between two steps. */
    uint16_t ticks, pieces;
};

/* Samples of so many seconds, at least one. */
uint32_t tune_samples_in(const struct tune_context *c, float seconds);

/* Methods B, C, D have a stage for the loop. */
static inline bool tune_is_staged(const struct tune_context *c)
{
    return c->s.method != TUNE_JOINT;
}

/* A response is known where it is larger than its doubt. */
bool tune_is_known(const struct tune_context *c, const struct high_order_point *p);

/* Dead time that a shadow can have, s. */
real_t tune_dead_reach(const struct tune_context *c);

#define TUNE_PARAMETERS 42
extern const struct block_parameter tune_parameter_rows[TUNE_PARAMETERS];
#define TUNE_ID_BLOCK 38
/* The id of k; those of lead, lag and dead follow. */
#define TUNE_ID_K 60

MUST_CHECK enum err tune_check(const struct block_setup *setup, struct block_fault *fault);
void tune_context_take(struct tune_context *c, const struct block_setup *setup);
void tune_shapes(const struct tune_settings *s, struct high_order_shape shape[2]);
/* Bytes of the estimator that the larger of both stages needs. */
uint32_t tune_model_bytes(const struct tune_settings *s);
struct high_order_settings tune_rules(const struct tune_settings *s);

#endif

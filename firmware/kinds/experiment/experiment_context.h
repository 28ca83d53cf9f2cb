/* Settings of a block of the kind `experiment` and what follows from them. The kind sets them when the block is configured; the parts of the block
 * read them. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_CONTEXT_H
#define REFLUX_EXPERIMENT_EXPERIMENT_CONTEXT_H

#include "base/assertion.h"
#include "kinds/experiment/plant_experiment.h"

struct polynomial_settings;
struct state_law_settings;

struct experiment_context {
    /* Settings of the block that keeps the law, or of the decoupler in its place; NULL: none. They stand elsewhere after every apply. */
    const struct state_law_settings *law;
    const struct polynomial_settings *decoupler;
    struct experiment_settings s;
    /* n measurements, then n MVs. */
    struct block_signal input[2 * EXPERIMENT_MOST];
    /* Interval of the block's steps. */
    float step_s;
    /* Steps of a sample; samples of the record; pieces of work between two steps. */
    uint16_t ticks, wanted, pieces;
    uint8_t n;
};

static inline float experiment_span(const struct experiment_context *c, unsigned k)
{
    REFLUX_ASSERT(k < 2u * c->n);
    return c->input[k].hi - c->input[k].lo;
}

#endif

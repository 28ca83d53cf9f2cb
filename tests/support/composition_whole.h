/* The estimator `composition` without its kind: what the kind does with the parts of its state. */
#ifndef REFLUX_TESTS_COMPOSITION_WHOLE_H
#define REFLUX_TESTS_COMPOSITION_WHOLE_H

#include "kinds/composition/composition_block.h"
#include "kinds/composition/composition_filter.h"
#include "kinds/composition/composition_judge.h"

static inline struct composition_parts whole_parts(struct composition_block *b)
{
    return (struct composition_parts){.settings = &b->s,
                                      .model = &b->model,
                                      .sensors = &b->sensors,
                                      .watch = &b->watch,
                                      .analyses = &b->analyses,
                                      .filter = &b->filter,
                                      .judge = &b->judge,
                                      .gains = (real_t *)(void *)(b + 1),
                                      .inputs = b->inputs,
                                      .points = b->points};
}

static inline void whole_begin(struct composition_block *b)
{
    composition_model_begin(&b->model);
    composition_sensors_begin(&b->sensors);
    composition_watch_begin(&b->watch, &b->sensors);
}

/* A step to the readings t[sensors], K. */
static inline enum err whole_step(struct composition_block *b, const real_t *t)
{
    return composition_sensors_step(&b->sensors, &b->model, b->filter.gain, t,
                                    (real_t)b->watch.steps * b->model.h);
}

static inline unsigned whole_odd(const struct composition_block *b, real_t most)
{
    return composition_watch_odd(&b->watch, &b->sensors, b->model.table.config.feed_stage, most);
}

static inline real_t *whole_gains(struct composition_block *b)
{
    return (real_t *)(void *)(b + 1);
}

#endif

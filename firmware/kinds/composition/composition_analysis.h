/* Late analyses of compositions: the model's error at the place of each is taken off its points. For this folder alone.
 *
 * An analysis y of a sample that was taken a seconds ago is compared with the estimate of that time, and a share of the difference
 * moves the correction:
 *
 *     c <- c + g (y - (x(t - a) + c)),   estimate = x + c, within 0..1
 *
 * so that after n samples (1 - g)^n of a constant error is left. The model itself stays as it is: temperatures say how fast a composition
 * moves, analyses where it is. Ours. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_ANALYSIS_H
#define REFLUX_COMPOSITION_COMPOSITION_ANALYSIS_H

#include "kinds/composition/composition_model.h"

#if CONFIG_BLOCKS

struct composition_analysis;
struct composition_analyses;

/* A reading of an analyser. */
struct composition_sample {
    real_t y;     /* mole fraction */
    real_t age_s; /* s, since the sample was taken */
    real_t most;  /* mole fraction; what is farther off is rejected; 0: all is believed */
    bool usable;  /* it shows something valid */
};

/* ---- one analysis ---- */

/* Returns every how many steps the estimate is kept. h: s, of a step; reach: s, age of the oldest sample that counts. */
uint16_t composition_analysis_every(real_t h, real_t reach);

/* Forgets all samples. h, reach: as above. */
void composition_analysis_begin(struct composition_analysis *a, real_t h, real_t reach);

/* Takes a step of h seconds to the estimate x. True: a sample has come that is older than the reach. */
bool composition_analysis_step(struct composition_analysis *a, real_t h, real_t x,
                               const struct composition_sample *sample);

/* ---- those of a block ---- */

/* keep: they are those that there were, and keep their past. */
void composition_analyses_set(struct composition_analyses *all, struct composition_model *model,
                              const struct block_setup *setup, bool keep);
void composition_analyses_begin(struct composition_analyses *all, struct composition_model *model,
                                real_t reach);
/* Takes a step of analysis i. filtered: the filter finds the corrections. True: the sample is too old, or rejected. */
bool composition_analyses_step(struct composition_analyses *all, struct composition_model *model,
                               unsigned i, const struct composition_sample *sample, bool filtered);

unsigned composition_analyses_count(const struct composition_analyses *all);
/* Returns the index of the input. */
unsigned composition_analyses_input(const struct composition_analyses *all, unsigned i);
real_t composition_analyses_correction(const struct composition_analyses *all, unsigned i);
/* True: analysis i is of the component on the stage. */
bool composition_analyses_is_at(const struct composition_analyses *all, unsigned i, size_t stage,
                                size_t component);
/* Returns the number of the first such, from 0; ANALYSES_MAX: there is none. */
unsigned composition_analyses_find(const struct composition_analyses *all, size_t stage,
                                   size_t component);
/* True: one is above the feed, or below. */
bool composition_analyses_in_section(const struct composition_analyses *all, size_t feed_stage,
                                     bool above);
size_t composition_analyses_stage(const struct composition_analyses *all, unsigned i);
size_t composition_analyses_component(const struct composition_analyses *all, unsigned i);

/* Takes the last sample of analysis i for the filter. False: there is none that it has not taken yet. */
bool composition_analyses_take(struct composition_analyses *all, unsigned i, real_t *surprise,
                               real_t *moved);

#endif
#endif

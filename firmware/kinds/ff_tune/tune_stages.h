/* The stages of a block of the kind `ff_tune`: what follows what, a sample at a time. They move the other parts of the block. */
#ifndef REFLUX_FF_TUNE_TUNE_STAGES_H
#define REFLUX_FF_TUNE_TUNE_STAGES_H

#include "kinds/ff_tune/tune_settings.h"
#include "kinds/ff_tune/tune_stage.h"

/* The parts of a block. Each has its file. */
struct tune_parts {
    const struct tune_context *context;
    struct tune_stages *stages;
    struct tune_samples *samples;
    struct tune_disturbance *disturbance;
    struct tune_learner *learner;
    struct high_order *estimator;
    struct tune_responses *responses;
    struct tune_paths *paths;
    struct tune_search *search;
    struct tune_shadows *shadows;
    struct tune_test *test;
    struct tune_watch *watch;
    struct tune_signals *signals;
    struct tune_proposals *proposals;
    struct tune_events *events;
};

/* The block begins without a past. */
void tune_stages_reset(const struct tune_parts *p);
/* The element has other numbers; is_candidate: those that were proposed. */
void tune_stages_element(const struct tune_parts *p, bool is_candidate);
/* The block was not called for a while: the past of the models has a gap. */
void tune_stages_gap(const struct tune_parts *p);
/* Goes on by a sample, which is whole. */
void tune_stages_sample(const struct tune_parts *p);
/* A step. */
void tune_stages_step(const struct tune_parts *p, struct block_io *io);

/* Verbs: NULL, or why not, in a word. */
const char *tune_stages_tune(const struct tune_parts *p);
const char *tune_stages_stop(const struct tune_parts *p);

enum tune_stage tune_stages_stage(const struct tune_stages *s);
enum tune_verdict tune_stages_verdict(const struct tune_stages *s);
/* Samples since the stage began. */
uint32_t tune_stages_samples(const struct tune_stages *s);
/* Times that the element was switched off. */
unsigned tune_stages_times_off(const struct tune_stages *s);
/* The element has a gain. */
bool tune_stages_element_acts(const struct tune_stages *s);
/* The disturbance rests, and the stage needs it to move: nothing is learnt, and no test signal moves the plant. */
bool tune_waits_for_disturbance(const struct tune_parts *p);
/* `step` that the last identification lacked, EU; 0: its test signal was large enough, or not the reason. */
float tune_step_wanted(const struct tune_parts *p);
/* The part that the element takes off the squares of the loop, %, while it acts; 0 before anything is known. */
float tune_does(const struct tune_parts *p);

#endif

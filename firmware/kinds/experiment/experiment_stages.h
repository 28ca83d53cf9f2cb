/* The stages of a block of the kind `experiment`: what follows what, and what it reports. They move the other parts of the block. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_STAGES_H
#define REFLUX_EXPERIMENT_EXPERIMENT_STAGES_H

#include "kinds/experiment/experiment_context.h"
#include "kinds/experiment/experiment_stage.h"

/* The parts of a block. Each has its file. */
struct experiment_parts {
    const struct experiment_context *context;
    struct experiment_stages *stages;
    struct experiment_record *record;
    struct experiment_lease *lease;
    struct experiment_model *model;
    /* Behind the state; experiment_model.h says where each stands. */
    float *coefficients;
    struct experiment_proposals *proposals;
    struct experiment_law *law;
    struct experiment_loops *loops;
};

enum experiment_event {
    EVENT_MODEL,
    EVENT_NO_MODEL,
    EVENT_ABORTED,
    EVENT_LAW,
    EVENT_NO_LAW,
    EXPERIMENT_EVENTS
};

bool experiment_runs(const struct experiment_stages *s);
/* Before the block gets other settings than those that an experiment under way goes by. */
void experiment_stages_settings(const struct experiment_parts *p);
/* Before it gets other settings than those that a design goes by. */
void experiment_stages_law_settings(const struct experiment_parts *p);
/* The block was not called for a while. */
void experiment_stages_gap(const struct experiment_parts *p);
/* A step. */
void experiment_stages_step(const struct experiment_parts *p, struct block_io *io);
/* A piece of work, between ticks. */
bool experiment_stages_work(const struct experiment_parts *p);

/* Verbs: NULL, or why not, in a word. */
const char *experiment_stages_start(const struct experiment_parts *p);
const char *experiment_stages_stop(const struct experiment_parts *p);
const char *experiment_stages_design(const struct experiment_parts *p);

enum experiment_stage experiment_stages_stage(const struct experiment_stages *s);
enum experiment_reason experiment_stages_reason(const struct experiment_stages *s);
unsigned experiment_stages_verdict(const struct experiment_stages *s);
/* The input of the block that is to blame, from 1 on; 0: none. */
unsigned experiment_stages_at_fault(const struct experiment_stages *s);

#endif

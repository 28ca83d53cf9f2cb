/* The job that finds the law of state feedback for a plant of fractions of span, in pieces, in a leased workspace: the kind
 * `state_law` for a column's table, the kind `experiment` for its model. */
#ifndef REFLUX_LAW_STATE_LAW_JOB_H
#define REFLUX_LAW_STATE_LAW_JOB_H

#include "design/state_decoupler.h"
#include "law/state_law_found.h"

#if CONFIG_BLOCKS

enum state_law_phase {
    STATE_LAW_PHASE_SAMPLE,
    STATE_LAW_PHASE_DESIGN,
    STATE_LAW_PHASE_INPUTS, /* from states to inputs */
    STATE_LAW_PHASE_LOOP,   /* with the inputs alone */
    STATE_LAW_PHASE_OVER
};

struct state_law_job {
    uint8_t phase; /* enum state_law_phase */
    uint8_t inputs, loops;
    bool is_mv[BLOCK_INPUTS_MAX], of_stage[BLOCK_INPUTS_MAX];
    float left; /* %, allowed */
    /* Per second; states are what they are, inputs and outputs fractions of span. */
    struct state_model plant;
    /* the inputs that are states, by the plant's states; a row for each */
    struct matrix seen;
    struct state_model sampled;
    struct state_decoupler_goal goal;
    struct state_decoupler_config config;
    struct state_decoupler_work work;
    struct state_decoupler law;
    /* of the inputs that are states; F as these have it */
    struct matrix weights, from_inputs;
    struct state_law_found found;
};

/* Begins for a plant and `seen` that the caller puts in place before the first piece. */
void state_law_job_begin(struct state_law_job *job, const struct state_law_settings *s,
                         unsigned loops);
/* Adds an input of the block. */
void state_law_job_add_input(struct state_law_job *job, bool is_mv, bool of_stage);
struct state_model *state_law_job_plant(struct state_law_job *job);
struct matrix *state_law_job_seen(struct state_law_job *job);

/* Begins for a model that is sampled already, of fractions of span, whose states are its outputs in the order of the inputs; as many inputs
 * as outputs. It is put into job->sampled afterwards. */
void state_law_job_of_model(struct state_law_job *job, const struct state_law_settings *s,
                            unsigned loops);

/* Ends with a refusal. */
void state_law_job_refuse(struct state_law_job *job, const char *field, const char *wanted,
                          unsigned loop);
/* Does a piece; false: it is over, see `found`. */
bool state_law_job_piece(struct state_law_job *job);
bool state_law_job_is_over(const struct state_law_job *job);
const struct state_law_found *state_law_job_found(const struct state_law_job *job);

/* "no law: left must be ...; loop" of one that was refused. */
void state_law_words(const struct state_law_found *found, char *text, size_t size);

#endif
#endif

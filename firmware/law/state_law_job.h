/* The job that finds the law of state feedback for a plant of fractions of span, in pieces, in a leased workspace: the kind
 * `state_law` for a column's table, the kind `experiment` for its model. */
#ifndef REFLUX_LAW_STATE_LAW_JOB_H
#define REFLUX_LAW_STATE_LAW_JOB_H

#include "law/state_law_found.h"
#include "lti/state_model.h"

#if CONFIG_BLOCKS

struct state_law_job;

/* Begins for a plant and `seen` that the caller puts in place before the first piece. */
void state_law_job_begin(struct state_law_job *job, const struct state_law_settings *s,
                         unsigned loops);
/* Adds an input of the block. */
void state_law_job_add_input(struct state_law_job *job, bool is_mv, bool of_stage);
struct state_model *state_law_job_plant(struct state_law_job *job);
struct matrix *state_law_job_seen(struct state_law_job *job);

/* Begins for a model that is sampled already, of fractions of span, whose states are its outputs in the order of the inputs; as many inputs
 * as outputs. It is put into state_law_job_sampled() afterwards. */
void state_law_job_of_model(struct state_law_job *job, const struct state_law_settings *s,
                            unsigned loops);
struct state_model *state_law_job_sampled(struct state_law_job *job);

/* Ends with a refusal. */
void state_law_job_refuse(struct state_law_job *job, const char *field, const char *wanted,
                          unsigned loop);
/* Does a piece; false: it is over, see state_law_job_found(). */
bool state_law_job_piece(struct state_law_job *job);
bool state_law_job_is_over(const struct state_law_job *job);
const struct state_law_found *state_law_job_found(const struct state_law_job *job);

/* "no law: left must be ...; loop" of one that was refused. */
void state_law_words(const struct state_law_found *found, char *text, size_t size);

#endif
#endif

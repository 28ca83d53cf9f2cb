/* The law of the kind `state_law`, found in pieces: in the workspace, by whoever leased it (`state_law` itself from a column's table, the kind
 * `experiment` from its model). */
#ifndef REFLUX_STATE_LAW_STATE_LAW_JOB_H
#define REFLUX_STATE_LAW_STATE_LAW_JOB_H

#include "design/state_decoupler.h"
#include "kinds/state_law/state_law_linear.h"

#if CONFIG_BLOCKS

enum state_law_phase {
    STATE_LAW_PHASE_TABLE,
    STATE_LAW_PHASE_LINEAR,
    STATE_LAW_PHASE_SAMPLE,
    STATE_LAW_PHASE_DESIGN,
    STATE_LAW_PHASE_INPUTS, /* from states to inputs */
    STATE_LAW_PHASE_LOOP,   /* with what these tell alone */
    STATE_LAW_PHASE_OVER
};

#define STATE_LAW_WORDS 128 /* a refusal, in words */

/* What was found; numbers are those of fractions of span. */
struct state_law_found {
    float f[STATE_LAW_LOOPS][STATE_FEEDBACK_INPUTS], g[STATE_LAW_LOOPS][STATE_LAW_LOOPS];
    float k_star[STATE_LAW_LOOPS];
    float condition; /* of B* */
    float zero;      /* largest magnitude of the modes that are hidden */
    float radius,
        inputs_radius; /* of the loop with all states, and with what the inputs tell of them */
    float left;        /* %, of F */
    uint8_t index[STATE_LAW_LOOPS], zeros;
    /* Refused: which, what it must be, in words; of which loop, from 1 on. "": it is not. */
    const char *field, *wanted;
    uint8_t loop;
};

struct state_law_job {
    uint8_t phase; /* enum state_law_phase */
    const struct column_record *record;
    float left; /* %, allowed */
    struct state_law_linear linear;
    struct state_model sampled;
    struct state_decoupler_goal goal;
    struct state_decoupler_config config;
    struct state_decoupler_work work;
    struct state_decoupler law;
    struct matrix weights, told; /* of the inputs that are states; F as these tell it */
    struct state_law_found found;
};

/* From a table. input: signals of the block. */
void state_law_job_of_column(struct state_law_job *job, const struct state_law_settings *s,
                             const struct block_signal *input, unsigned inputs,
                             const struct column_record *record);

/* From a model that is sampled already, of fractions of span, whose states are its outputs in the order of the inputs; as many inputs
 * as outputs. It is put into job->sampled afterwards. */
void state_law_job_of_model(struct state_law_job *job, const struct state_law_settings *s,
                            unsigned loops);

/* "no law: left must be ...; loop" of one that was refused. */
void state_law_words(const struct state_law_found *found, char *text, size_t size);

/* A piece; false: it is over, and found tells. */
bool state_law_job_piece(struct state_law_job *job);

/* Of a law that is there as `is` the values that differ from `wanted`, made_s included. block: index of the one with the law,
 * PROPOSED_SELF of its own. */
void state_law_put_values(const struct state_law_settings *is, const struct state_law_found *wanted,
                          float made_s, unsigned loops, uint8_t block, struct block_proposal *room);
/* How many of the inputs are MVs. */
unsigned state_law_loops(const struct block_signal *input, unsigned inputs);

#endif
#endif

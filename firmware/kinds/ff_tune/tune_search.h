/* The work of a block of the kind `ff_tune` between ticks: a look at the responses, and where a candidate is wanted all that follows: ratio, models,
 * rule, and the search for an element. */
#ifndef REFLUX_FF_TUNE_TUNE_SEARCH_H
#define REFLUX_FF_TUNE_TUNE_SEARCH_H

#include "kinds/ff_tune/tune_paths.h"
#include "kinds/ff_tune/tune_responses.h"

struct tune_search;

/* Asks for a look at the responses, or for a candidate. */
void tune_search_ask(struct tune_search *s, bool look_only);
/* Nobody waits for the result any longer. A piece that is under way still ends. */
void tune_search_cancel(struct tune_search *s);
/* In every step of the block: has the pieces done that are wanted. Returns true when the work is over, once. */
bool tune_search_step(struct tune_search *s, const struct tune_context *c, struct block_io *io);
/* A piece, between ticks. True while there is more. */
bool tune_search_piece(struct tune_search *s, const struct tune_context *c,
                       struct tune_responses *r, struct tune_paths *paths,
                       const struct high_order *estimator, bool of_loop);

/* The work was asked for, and its result was not taken. */
bool tune_search_computes(const struct tune_search *s);
/* No piece is under way: estimator and responses may begin anew. */
bool tune_search_is_idle(const struct tune_search *s);
/* A piece may read the estimator: nothing is learnt. */
bool tune_search_reads(const struct tune_search *s);
/* The work that is over was a look alone; its verdict, TUNE_NONE where all went well. */
bool tune_search_was_look(const struct tune_search *s);
enum tune_verdict tune_search_outcome(const struct tune_search *s);

const struct feedforward_shape *tune_candidate(const struct tune_search *s);
/* The candidate is the rule's. */
bool tune_candidate_is_rule(const struct tune_search *s);
/* Doubt of the ratio, weighted, over its size. */
real_t tune_search_spread(const struct tune_search *s);
/* The search itself, with the least J and that of no feedforward. */
const struct feedforward_search *tune_search_result(const struct tune_search *s);

/* The rule can take the place of what is not good enough. */
bool tune_search_falls_back(const struct tune_search *s, const struct tune_context *c,
                            const struct tune_rule *rule);
void tune_search_take_rule(struct tune_search *s, const struct tune_rule *rule);

#endif

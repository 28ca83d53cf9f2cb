/* `design`: from the model that is kept to what other blocks compute with: a decoupler and controllers for its loops (experiment_loops.h), or the
 * law of state feedback that a block of the kind `state_law` keeps. For that law, of a model of first order without dead time,
 * A y(k) = B u(k), the outputs are all there is to its state:
 *
 *     y(k + 1) = -diag(a) y(k) + B u(k)
 *
 * so F and G are for the measurements themselves. Of higher orders states would be samples of the past, which no measurement is: refused. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_LAW_H
#define REFLUX_EXPERIMENT_EXPERIMENT_LAW_H

#include "kinds/experiment/experiment_context.h"

struct experiment_law;
struct experiment_loops;

enum experiment_law_end { LAW_GOES_ON, LAW_FOUND, LAW_REFUSED };

bool experiment_law_runs(const struct experiment_law *l);
/* NULL, or why not, in a word. */
const char *experiment_law_begin(struct experiment_law *l, const struct experiment_context *c);
/* Ends a design that runs. Returns true when there was one, which is refused. */
bool experiment_law_stop(struct experiment_law *l, const char *field, const char *wanted);
/* A piece, between ticks. */
bool experiment_law_work(struct experiment_law *l, const struct experiment_context *c);
/* In every step. */
enum experiment_law_end experiment_law_step(struct experiment_law *l,
                                            struct experiment_loops *loops,
                                            const struct experiment_context *c,
                                            struct block_io *io);

/* There is more to propose. */
bool experiment_law_proposes(const struct experiment_law *l);
void experiment_law_withdraw(struct experiment_law *l);
/* The largest pole of the loops; the loop that is concerned, from 1 on. */
float experiment_law_radius(const struct experiment_law *l);
float experiment_law_loop(const struct experiment_law *l);
/* Why the last design was refused; NULL: it was not. */
const char *experiment_law_words(const struct experiment_law *l);

#endif

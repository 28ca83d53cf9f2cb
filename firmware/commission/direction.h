/* The test of a direction: all inputs are moved together, input k by share_k of the level, where they act nearly alike. The
 * direction is the one that the outputs answer least, so that what the inputs do not have in common is measured by itself, with
 * steps far larger than those of one input. It is a test like that of an input, behind them in the order of turns: the slot
 * inputs_count() of test_inputs, and the same column of commission_work.element. A plant of CHANNEL_MAX inputs has no slot free, and
 * no such test. Tick. */
#ifndef REFLUX_COMMISSION_DIRECTION_H
#define REFLUX_COMMISSION_DIRECTION_H

#include "commission/experiment_config.h"
#include "supervise/supervisor.h"

#define DIRECTION_NAME "direction" /* in events and listings, where an input has its name */

struct analysis;
struct commission;

/* A pair has a relative gain from which inputs act nearly alike. */
bool direction_gains_are_large(const struct analysis *a);
/* The analysis leaves the determinant's sign open, or gives relative gains from DIRECTION_LAMBDA up no settings, and there has been
 * no such test yet. */
bool direction_is_wanted(const struct commission *c);
/* Lines it up behind the inputs; its turn is next. The analysis that asked for it is still there. */
void direction_line_up(struct commission *c);

/* Its next test: amplitude by the room of all inputs and by the response that the gains predict. */
void direction_config(const struct commission *c, const struct supervisor *s,
                      struct experiment_config *x);
/* Samples of a half that shows the end of what the inputs do not have in common: direction_sum.h. */
uint32_t direction_half(const struct commission *c, const struct supervisor *s);
/* Moves all of its inputs: level in fractions of span for a share of 1. */
void direction_excite(const struct commission *c, struct supervisor *s, real_t level);

/* Puts what the direction has found into the gains of the analysis: interact/direction.h. Rows whose responses, or whose sum, are not
 * those of lags seen to their end stay as they are. */
void direction_condition(struct commission *c, real_t floor);

#endif

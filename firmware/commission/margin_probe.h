/* The margin probe of a trial (adoption.h): a loop makes the way back of its setpoint step with its gain raised. Where a drift has
 * spoilt a probe, the loop repeats it as a step away. Tick. */
#ifndef REFLUX_COMMISSION_MARGIN_PROBE_H
#define REFLUX_COMMISSION_MARGIN_PROBE_H

#include "commission/trial_step.h"

struct margin_probe;

/* A stage of the trial begins: a rest, a way back, or neither. The gain stays raised for a way back, and is raised for a probe that
 * is repeated. */
void margin_probe_enter(struct margin_probe *p, bool is_rest, bool is_return);
/* Raises the gain of loop k for its way back, where a probe of it is planned. */
void margin_probe_raise(struct margin_probe *p, uint8_t k);
/* At the end of the step of loop k, there or back, with the raised gain: it is not at rest as predicted. step: of the setpoint,
 * fraction of span, signed. */
bool margin_probe_is_restless(const struct margin_probe *p, const struct trial_step *t,
                              const struct adoption_loop *loop,
                              const struct adoption_channel *channel, uint8_t k, real_t step);

#endif

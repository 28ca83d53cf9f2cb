/* Signs of a mistake in the wiring or of a sensor. They are reported, and change no control. Within supervise only. */
#ifndef REFLUX_SUPERVISE_WATCH_H
#define REFLUX_SUPERVISE_WATCH_H

#include "exchange/state.h"

#if CONFIG_CALIBRATION
/* Returns true if the first valid reading of measurement i since the plant came was not one of the process, but a
 * default of its sensor. value, before: this reading and the one before it, EU. too_fast: it is too far from the
 * first. */
bool watch_first_is_wrong(struct supervisor *s, uint8_t i, float value, float before,
                          bool too_fast);
/* After each judgement, before the reading is taken: counts readings since the first valid one. */
void watch_age(struct measurement_state *m, float value);
/* Once a tick, when all readings have been judged: looks for measurements that send the same numbers. */
void watch_twins(struct supervisor *s);
#else
#define watch_first_is_wrong(s, i, value, before, too_fast) ((void)(before), false)
#define watch_age(m, value)                                 ((void)(m))
#define watch_twins(s)                                      ((void)(s))
#endif

#endif

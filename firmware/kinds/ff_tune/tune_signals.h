/* Test signals of a block of the kind `ff_tune`: square waves on the setpoint of the loop and on the disturbance, where that is an MV. */
#ifndef REFLUX_FF_TUNE_TUNE_SIGNALS_H
#define REFLUX_FF_TUNE_TUNE_SIGNALS_H

#include "kinds/ff_tune/tune_settings.h"

struct tune_signals;

/* A stage begins, and with it the square waves. */
void tune_signals_begin(struct tune_signals *s);
void tune_signals_sample(struct tune_signals *s);
/* In every step: asks for a signal on the setpoint, on the disturbance. */
void tune_signals_ask(struct tune_signals *s, const struct tune_context *c, struct block_io *io,
                      bool on_setpoint, bool on_disturbance);
/* The block asks for no signal any longer. */
void tune_signals_stop(struct tune_signals *s);
/* Settings have come into force, which end a signal: it may begin again a step later. */
void tune_signals_pause(struct tune_signals *s);
/* The signal of the last step was refused, or others have ended it. */
bool tune_signals_failed(const struct tune_signals *s, const struct block_io *io);

#endif

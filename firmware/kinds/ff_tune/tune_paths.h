/* First-order models of the process and of the path of the disturbance, and Shinskey's rule from both. In pieces, between ticks. */
#ifndef REFLUX_FF_TUNE_TUNE_PATHS_H
#define REFLUX_FF_TUNE_TUNE_PATHS_H

#include "kinds/ff_tune/tune_results.h"
#include "kinds/ff_tune/tune_settings.h"
#include "kinds/ff_tune/tune_stage.h"

struct tune_paths;

void tune_paths_begin(struct tune_paths *p);
/* A piece each. The first is for the model of the process: TUNE_NO_MODEL where there is none. The second is for that of the path, and the rule.
 * *more: another piece is to follow. */
enum tune_verdict tune_process_piece(struct tune_paths *p, const struct tune_context *c,
                                     const struct tune_band *band, bool *more);
void tune_path_piece(struct tune_paths *p, const struct tune_context *c,
                     const struct tune_band *band, const struct feedforward_wanted *wanted,
                     bool *more);
/* Model of the process that was found last. */
const struct tune_model *tune_process_model(const struct tune_paths *p);
const struct tune_rule *tune_paths_rule(const struct tune_paths *p);

#endif

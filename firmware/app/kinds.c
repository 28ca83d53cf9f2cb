/* The kinds of blocks this board has: the only place that names them all. A board leaves a family out by leaving its folder
 * out of the build (firmware/CMakeLists.txt). */
#include "adapt/feedforward_tune.h"
#include "adapt/gmv_kind.h"
#include "adapt/plant_experiment.h"
#include "block/block.h"
#include "compensate/decoupler.h"
#include "compensate/polynomial.h"
#include "compensate/ratio.h"
#include "control/column_ahead.h"
#include "control/inferential.h"
#include "control/pid.h"
#include "control/rst.h"
#include "control/state_feedback.h"
#include "control/state_law.h"
#include "control/two_position.h"
#include "estimate/column.h"
#include "estimate/composition_settings.h"
#include "feedforward/feedforward.h"
#include "feedforward/leadlag.h"

const struct block_kind *const block_kinds[] = {
    &pid_kind,
    &two_position_kind,
    &decoupler_kind,
    &feedforward_kind,
#if CONFIG_BLOCKS
    &column_kind,
    &gmv_kind,
    &inferential_kind,
    &ratio_kind,
    &composition_kind,
    &polynomial_kind,
    &rst_kind,
    &state_feedback_kind,
    &ahead_kind,
    &leadlag_kind,
    &state_law_kind,
#endif
#if CONFIG_EXPERIMENT
    &experiment_kind,
#endif
#if CONFIG_FEEDFORWARD_TUNE
    &feedforward_tune_kind,
#endif
};

const uint8_t block_kind_count = sizeof block_kinds / sizeof block_kinds[0];

/* The kinds of blocks that this board has: the only place that names them all. A board leaves a family out by
 * leaving its folder out of the build (firmware/kinds/CMakeLists.txt). */
#include "block/block.h"
#include "exchange/rows.h"
#include "kinds/ahead/column_ahead.h"
#include "kinds/column/column.h"
#include "kinds/composition/composition_settings.h"
#include "kinds/decoupler/decoupler.h"
#include "kinds/derived/derived.h"
#include "kinds/experiment/plant_experiment.h"
#include "kinds/feedforward/feedforward.h"
#include "kinds/ff_tune/feedforward_tune.h"
#include "kinds/gmv/gmv_kind.h"
#include "kinds/inferential/inferential.h"
#include "kinds/leadlag/leadlag.h"
#include "kinds/pid/pid.h"
#include "kinds/polynomial/polynomial.h"
#include "kinds/ratio/ratio.h"
#include "kinds/rst/rst.h"
#include "kinds/state/state_feedback.h"
#include "kinds/state_law/state_law.h"
#include "kinds/two_position/two_position.h"

#if CONFIG_EXPERIMENT
#define EXPERIMENT_ROWS ROWS_HERE
#else
#define EXPERIMENT_ROWS ROWS_NOWHERE
#endif
#if CONFIG_FEEDFORWARD_TUNE
#define FEEDFORWARD_TUNE_ROWS ROWS_HERE
#else
#define FEEDFORWARD_TUNE_ROWS ROWS_NOWHERE
#endif

/* clang-format off */
const struct block_kind *const block_kinds[] = {
    &pid_kind,
    &two_position_kind,
    &decoupler_kind,
    &feedforward_kind,
    BLOCK_ROWS(
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
        &state_law_kind)
    EXPERIMENT_ROWS(&experiment_kind)
    FEEDFORWARD_TUNE_ROWS(&feedforward_tune_kind)
    BLOCK_ROWS(&derived_kind)
};
/* clang-format on */

const uint8_t block_kind_count = sizeof block_kinds / sizeof block_kinds[0];

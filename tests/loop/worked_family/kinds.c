/* In place of firmware/app/kinds.c: the kinds of the product, in its order, and the two of this folder. */
#include "kinds.h"

#include "kinds/decoupler/decoupler.h"
#include "kinds/feedforward/feedforward.h"
#include "kinds/pid/pid.h"
#include "kinds/two_position/two_position.h"

const struct block_kind *const block_kinds[] = {
    &pid_kind,         &two_position_kind, &decoupler_kind,
    &feedforward_kind, &observer_kind,     &state_feedback_kind,
};

const uint8_t block_kind_count = sizeof block_kinds / sizeof block_kinds[0];

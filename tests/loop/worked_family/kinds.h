/* Two kinds of blocks that no product has: the worked example of docs/inside/adding-a-controller.md. */
#ifndef REFLUX_TESTS_WORKED_FAMILY_KINDS_H
#define REFLUX_TESTS_WORKED_FAMILY_KINDS_H

#include "block/block.h"

extern const struct block_kind observer_kind, state_feedback_kind;

#endif

/* The kind `feedforward`, a feedforward element (block/feedforward.h): ffN of the configuration. Its settings are a struct feedforward_settings; it has
 * one member, whose `in` is the disturbance. */
#ifndef REFLUX_FEEDFORWARD_FEEDFORWARD_H
#define REFLUX_FEEDFORWARD_FEEDFORWARD_H

#include "block/block.h"

extern const struct block_kind feedforward_kind;

#endif

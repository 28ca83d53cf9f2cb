/* Kind `state_law`: finds on the board what the kind `state` computes with, F, G and Tf of design/state_decoupler.h for two loops, and keeps it as
 * settings of its own, which `state` takes when it names the block (its parameter law). It moves nothing itself.
 *
 * The law comes from the equations of the column whose table the block names, linear around the table's profile (`block N design`). Where it
 * names no table, another block that has identified the plant puts the law there (the kind `experiment`). docs/methods/state-decoupling.md
 *
 * Inputs: first the measurements of the loops, one for each, then what else `state` is given, in its order; behind them the MVs of the loops.
 *
 * The law comes as proposals (block/proposal.h), as many as it takes; `made` is 0 until all of it is there, and as long as it is
 * `state` goes on with what it had. */
#ifndef REFLUX_STATE_LAW_STATE_LAW_H
#define REFLUX_STATE_LAW_STATE_LAW_H

#include "law/state_law_settings.h"

#if CONFIG_BLOCKS

extern const struct block_kind state_law_kind;

#endif
#endif

/* The state of analysis_structure.c. */
#ifndef REFLUX_COMMISSION_ANALYSIS_STRUCTURE_STATE_H
#define REFLUX_COMMISSION_ANALYSIS_STRUCTURE_STATE_H

#include <stddef.h>

#include "base/assertion.h"
#include "design/tuning.h"
#include "interact/cascade.h"
#include "interact/structure.h"

/* Verdict of gains over residence times (interact/measure.h) on the pairing by gains alone. */
enum analysis_second { SECOND_NONE, SECOND_AGREES, SECOND_DIFFERS };

struct plant_layout {
    uint8_t n_cascades;
    bool has_structure;
    bool hidden_cascade; /* one might be used if gains that may be there were known to be none */
    enum analysis_second second; /* SECOND_NONE: no pairs, or no such gains */
    uint16_t inner_outputs;      /* of the cascades that are used: bits of outputs without a pair */
    struct cascade cascade[INTERACT_MAX];
    struct structure structure;               /* where there are pairs */
    struct tuning inner_tuning[INTERACT_MAX]; /* of the loop below pair k, where there is one */
    real_t pair_phi[INTERACT_MAX];
};

static inline uint8_t layout_cascades(const struct plant_layout *l)
{
    return l->n_cascades;
}

static inline const struct cascade *layout_cascade(const struct plant_layout *l, unsigned n)
{
    REFLUX_ASSERT(n < INTERACT_MAX);
    return &l->cascade[n];
}

/* Bits of the measurements that have an inner loop. */
static inline uint16_t layout_inner_outputs(const struct plant_layout *l)
{
    return l->inner_outputs;
}

/* Parts and blocks of the plant; NULL: not known. */
static inline const struct structure *layout_structure(const struct plant_layout *l)
{
    return l->has_structure ? &l->structure : NULL;
}

/* Numbers of blocks and parts, 0 where they are not known. */
static inline unsigned layout_blocks(const struct plant_layout *l)
{
    return l->structure.blocks;
}

static inline unsigned layout_parts(const struct plant_layout *l)
{
    return l->structure.parts;
}

/* Settings of the inner loop below pair k. */
static inline const struct tuning *layout_inner_tuning(const struct plant_layout *l, unsigned k)
{
    REFLUX_ASSERT(k < INTERACT_MAX);
    return &l->inner_tuning[k];
}

static inline enum analysis_second layout_second(const struct plant_layout *l)
{
    return l->second;
}

/* Gain over residence time of pair k, as a relative gain. */
static inline real_t layout_phi(const struct plant_layout *l, unsigned k)
{
    REFLUX_ASSERT(k < INTERACT_MAX);
    return l->pair_phi[k];
}

#endif

/* One channel of the kind `derived`: its past, its step. For this folder alone. Equations: derived.h.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_DERIVED_DERIVED_POINT_H
#define REFLUX_DERIVED_DERIVED_POINT_H

#include "kinds/derived/derived.h"
#include "num/real.h"

#if CONFIG_BLOCKS

struct derived_point;

/* A step of a block. */
struct derived_turn {
    const struct derived_settings *settings;
    uint8_t inputs;
    uint8_t quality[DERIVED_INPUTS]; /* enum quality */
    real_t value[DERIVED_INPUTS];    /* EU */
    /* Plant time since the last step, ms; not known in the first step, and in the first one after an absence of the plant. */
    bool passed_known;
    uint32_t passed_ms;
    uint32_t bridge_ms; /* longest time without a flow that is no gap */
};

/* Steps channel k, with settings that derived_check() accepts. Returns its quality; writes its value in EU, which is finite. */
enum quality derived_point_step(struct derived_point *p, const struct derived_turn *t, unsigned k,
                                real_t *value);

/* Puts a total to 0, from which it counts on from the last step. */
void derived_point_reset(struct derived_point *p);

/* Of a total: returns true if it has missed something since its reset; EU; s. */
bool derived_point_has_gap(const struct derived_point *p);
real_t derived_point_total(const struct derived_point *p);
real_t derived_point_missed_s(const struct derived_point *p);

#endif
#endif

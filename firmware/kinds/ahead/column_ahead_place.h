/* Signals of the kind `ahead` in the model's units, and the column's state from what they measure. For this folder alone. */
#ifndef REFLUX_AHEAD_COLUMN_AHEAD_PLACE_H
#define REFLUX_AHEAD_COLUMN_AHEAD_PLACE_H

#include "kinds/ahead/column_ahead_model.h"

#if CONFIG_BLOCKS

struct ahead_places;

/* Takes the settings. True: signals mean what they meant. */
bool ahead_places_set(struct ahead_places *p, const struct block_setup *setup);
unsigned ahead_places_loops(const struct ahead_places *p);
/* Returns the input that is the MV of loop j. */
unsigned ahead_places_mv(const struct ahead_places *p, unsigned j);
/* Returns the span of the PV of loop i, SI. */
real_t ahead_places_span(const struct ahead_places *p, unsigned i);
/* Returns a value of the PV of loop i: K, or a mole fraction. */
real_t ahead_places_pv_si(const struct ahead_places *p, const struct ahead_model *m, unsigned i,
                          num_t fraction);
/* Returns the PV of loop i by the model, at states x that were looked at last; SI. */
real_t ahead_places_target(const struct ahead_places *p, const struct ahead_model *m, unsigned i,
                           const real_t *x);
/* Returns the column's inputs with the MVs of the loops where u[loops] has them, fractions of span. */
void ahead_places_drive(const struct ahead_places *p, struct ahead_model *m, const real_t *u,
                        struct column_inputs *inputs);
/* Finds the state of the column an interval after the last time. trust: part of the difference to the readings that is corrected. */
MUST_CHECK enum err ahead_places_observe(const struct ahead_places *p, struct ahead_model *m,
                                         const struct block_io *io, real_t trust);
/* The same, from wherever the model was. */
MUST_CHECK enum err ahead_places_find(const struct ahead_places *p, struct ahead_model *m,
                                      const struct block_io *io);

#endif
#endif

/* Gate of the learner: which loops may learn from a step. A loop whose samples carry no information is quiet, and rests. */
#ifndef REFLUX_GMV_GMV_GATE_H
#define REFLUX_GMV_GMV_GATE_H

#include "kinds/gmv/gmv_watched.h"

struct gmv_gate;

/* Starts anew; a freeze stays. */
void gmv_gate_begin(struct gmv_gate *g);
/* Looks at a step before the regressions. rest: enum gmv_rest of each loop. Returns the loops that may learn, a bit each. */
uint8_t gmv_gate_look(struct gmv_gate *g, const struct gmv_supervise_config *c,
                      const struct gmv_observation *seen, uint8_t *rest);
/* Weighs the information of loop i's sample after its regression. */
void gmv_gate_weigh(struct gmv_gate *g, const struct gmv_supervise_config *c,
                    const struct gmv_result *result, unsigned i);
/* Lets frozen and quiet loops learn. */
void gmv_gate_thaw(struct gmv_gate *g);

#endif

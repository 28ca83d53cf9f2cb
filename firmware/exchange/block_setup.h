/* What a block is told of itself before it starts or gets new settings: made from the plan, by the main loop to have the block's kind
 * check it, and by the tick to start the block. */
#ifndef REFLUX_EXCHANGE_BLOCK_SETUP_H
#define REFLUX_EXCHANGE_BLOCK_SETUP_H

#include "exchange/plan.h"

/* A block's setup, with room for what it points to. */
struct block_instance {
    struct block_setup setup;
    union {
        struct matrix_settings matrix;
        struct element_settings element;
    } settings;
};

/* Makes the setup of the block in a slot; *instance must stay while it is used. Channels are resolved already. */
void plan_block_setup(const struct plan *plan, uint8_t slot, struct block_instance *instance);
/* The same for a loop's own controller, the static decoupler, and a feedforward element alone: each takes the stack of its
 * settings only. */
void plan_setup_own(const struct plan *plan, uint8_t loop, struct block_instance *instance);
void plan_setup_matrix(const struct plan *plan, struct block_setup *setup,
                       struct matrix_settings *matrix);
void plan_setup_element(const struct plan *plan, uint8_t element, struct block_instance *instance);

/* Span of what feedforward element i looks at, EU. Its source is resolved already. */
void plan_feedforward_span(const struct plan *plan, uint8_t element, float *lo, float *hi);

#endif

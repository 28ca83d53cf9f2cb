/* The setup of a block: its properties before it starts or gets new settings. The main loop makes it from the plan
 * to have the block's kind check it, and the tick makes it to start the block. */
#ifndef REFLUX_EXCHANGE_BLOCK_SETUP_H
#define REFLUX_EXCHANGE_BLOCK_SETUP_H

#include "exchange/plan.h"

#if COMMISSION_CHANNELS
/* Settings of a loop's own controller that differ from those of the plan. */
struct raised_settings {
    struct loop_settings loop;
};
#else
struct raised_settings {
};
#endif

/* A block's setup, with memory for the settings it points to. */
struct block_instance {
    struct block_setup setup;
    union {
        struct matrix_settings matrix;
        struct feedforward_settings element;
        struct raised_settings raised;
    } settings;
};

/* Makes the setup of a block of the plan; *instance must stay while the setup is used. Channels must be resolved
 * already. */
void plan_block_setup(const struct plan *plan, uint8_t block, struct block_instance *instance);
/* Make the setup of a loop's own controller, of the static decoupler, and of a feedforward element. Each function
 * takes the stack of its own settings only. */
void plan_setup_own(const struct plan *plan, uint8_t loop, struct block_instance *instance);
void plan_setup_matrix(const struct plan *plan, struct block_setup *setup,
                       struct matrix_settings *matrix);
void plan_setup_feedforward(const struct plan *plan, uint8_t element,
                            struct block_instance *instance);

/* Returns the span of the source of a feedforward element ffN, EU. The source must be resolved already. */
void plan_feedforward_span(const struct plan *plan, uint8_t element, float *lo, float *hi);

#endif

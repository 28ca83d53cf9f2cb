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
/* The largest |MV - feedforward| of the MV of loop i, fraction of span. */
float plan_own_reach(const struct plan *plan, uint8_t i);

#if CONFIG_BLOCKS
void plan_setup_record(const struct plan *plan, uint8_t n, struct block_setup *setup);
/* Base ticks of a step of the block with record n. */
uint16_t plan_record_divisor(const struct plan *plan, uint8_t n);
/* The kind of block n is known, and runs in that stage. */
bool plan_has_stage(const struct plan *plan, uint8_t n, enum block_stage stage);
/* The most that elements with a record add to an MV, either way. */
float plan_added_reach(const struct plan *plan, uint8_t output);
/* The largest |MV - feedforward| of the MV of loop i behind compensator n, fraction of span. */
float plan_member_reach(const struct plan *plan, uint8_t n, uint8_t i);
/* The parameter with which a block of that kind names another, or NULL. */
const struct block_parameter *plan_names_with(const struct block_kind *kind);
/* The number of the block that block n names; 0: it names none. */
uint16_t plan_number_named(const struct plan *plan, uint8_t n);
/* Settings of the block that block n names, or NULL. */
const void *plan_named(const struct plan *plan, uint8_t n);
/* Block n names one of that kind; one of the second kind that its own kind can use. */
bool plan_names_a(const struct plan *plan, uint8_t n, const char *kind);
bool plan_names_other(const struct plan *plan, uint8_t n);
#else
static inline void plan_setup_record(const struct plan *plan, uint8_t n, struct block_setup *setup)
{
    (void)plan;
    (void)n;
    (void)setup;
}
static inline float plan_added_reach(const struct plan *plan, uint8_t output)
{
    (void)plan;
    (void)output;
    return 0.0f;
}
#endif

#endif

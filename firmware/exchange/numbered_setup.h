/* The setup of a block with a number, blockN: whom it serves, what it reads and writes, whom it names. */
#ifndef REFLUX_EXCHANGE_NUMBERED_SETUP_H
#define REFLUX_EXCHANGE_NUMBERED_SETUP_H

#include "exchange/plan.h"

#if CONFIG_BLOCKS
void plan_setup_record(const struct plan *plan, uint8_t n, struct block_setup *setup);
/* Base ticks of a step of the block with record n. */
uint16_t plan_record_divisor(const struct plan *plan, uint8_t n);
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
#endif

#endif

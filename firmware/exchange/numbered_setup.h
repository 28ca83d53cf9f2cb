/* The setup of a block with a number, blockN: its members, the channels it reads and writes, the block it names. */
#ifndef REFLUX_EXCHANGE_NUMBERED_SETUP_H
#define REFLUX_EXCHANGE_NUMBERED_SETUP_H

#include "exchange/plan.h"

#if CONFIG_BLOCKS
void plan_setup_numbered(const struct plan *plan, uint8_t n, struct block_setup *setup);
/* Returns the base ticks of a step of blockN. */
uint16_t plan_divisor(const struct plan *plan, uint8_t n);
/* Returns the parameter with which a block of that kind names another, or NULL. */
const struct block_parameter *plan_names_with(const struct block_kind *kind);
/* Returns the number of the block that block n names; 0 if it names none. */
uint16_t plan_number_named(const struct plan *plan, uint8_t n);
/* Returns the settings of the block that block n names, or NULL. */
const void *plan_named(const struct plan *plan, uint8_t n);
/* Return true if block n names a block of that kind, or one of the second kind that its own kind can use. */
bool plan_names_a(const struct plan *plan, uint8_t n, const char *kind);
bool plan_names_other(const struct plan *plan, uint8_t n);
#else
static inline void plan_setup_numbered(const struct plan *plan, uint8_t n,
                                       struct block_setup *setup)
{
    (void)plan;
    (void)n;
    (void)setup;
}
#endif

#endif

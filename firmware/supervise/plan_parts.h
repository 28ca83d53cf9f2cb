/* What plan.c shares with the file of one kind of block. */
#ifndef REFLUX_SUPERVISE_PLAN_PARTS_H
#define REFLUX_SUPERVISE_PLAN_PARTS_H

#include "supervise/plan.h"

/* Fills *fault, and returns `code`. */
enum err plan_refuse(struct config_fault *fault, enum err code, const char *group, unsigned index,
                     const char *field, const char *subject, const char *wanted);
/* plan_feedforward.c: what each looks at. The loops are resolved already. */
enum err plan_resolve_feedforwards(struct plan *plan, struct config_fault *fault);

/* plan_blocks.c: which kind a loop's own controller, the decoupler, a feedforward element is, and whether that accepts its
 * settings. Their channels are resolved already. */
enum err plan_check_own(struct plan *plan, uint8_t loop, struct config_fault *fault);
enum err plan_check_matrix(struct plan *plan, struct config_fault *fault);
enum err plan_check_element(struct plan *plan, uint8_t element, struct config_fault *fault);
/* plan_records.c: blocks with a record. Channels and loops are resolved already, their order is not. */
enum err plan_resolve_records(struct plan *plan, struct config_fault *fault);
/* ... now it is, and the kinds look at their settings. */
enum err plan_check_records(struct plan *plan, struct config_fault *fault);
#if CONFIG_BLOCKS
/* An entry of the alarms on `blockN.CODE`. */
enum err plan_resolve_block_alarm(struct plan *plan, uint8_t alarm, struct config_fault *fault);
#endif
/* May loop i be put in order: is everything there that its setpoint comes from? */
bool plan_setpoint_ready(const struct plan *plan, uint8_t i, const bool *taken);
/* Settings of the block that block n names, or NULL. */
const void *plan_named(const struct plan *plan, uint8_t n);
void plan_setup_record(const struct plan *plan, uint8_t n, struct block_setup *setup);
/* Base ticks of a step of the block with record n. */
uint16_t plan_record_divisor(const struct plan *plan, uint8_t n);
/* The next of names with blanks between them; returns where the one after it begins, or NULL: there was none. */
const char *plan_next_name(const char *list, char name[CHANNEL_NAME_SIZE]);
/* plan_record_stages.c: of a feedforward element the MVs it adds to; that a compensator or an element has what it needs; that
 * none moves an MV it looks at, once all feedforwards are resolved. */
enum err plan_resolve_added(struct plan *plan, uint8_t n, struct config_fault *fault);
enum err plan_check_stage(const struct plan *plan, uint8_t n, struct config_fault *fault);
enum err plan_check_rings(const struct plan *plan, struct config_fault *fault);
/* The largest |MV - feedforward| of the MV of loop i, fraction of span; of what compensator n gives for it. */
float plan_own_reach(const struct plan *plan, uint8_t i);
float plan_member_reach(const struct plan *plan, uint8_t n, uint8_t i);
/* The most that elements with a record add to an MV, either way. */
float plan_added_reach(const struct plan *plan, uint8_t output);
/* Grains in the arena behind the state of the block: of a compensator one for each member (compensate_blocks.c). */
uint32_t plan_grains_behind(const struct plan *plan, uint8_t slot);
/* Their places in the arena, when all have been checked. */
enum err plan_place_blocks(struct plan *plan, struct config_fault *fault);

#endif

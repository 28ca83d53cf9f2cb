/* What plan.c shares with the file of one kind of block. */
#ifndef REFLUX_PLAN_PLAN_PARTS_H
#define REFLUX_PLAN_PLAN_PARTS_H

#include "exchange/plan.h"

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
/* An entry of the alarms on `blockN.CODE`. */
enum err plan_resolve_block_alarm(struct plan *plan, uint8_t alarm, struct config_fault *fault);
#if COMMISSION_CHANNELS
enum err plan_check_tests(const struct plan *plan, struct config_fault *fault);
#else
#define plan_check_tests(plan, fault) ERR_OK
#endif
#if CONFIG_ANALYSERS
enum err plan_check_sampling(const struct plan *plan, struct config_fault *fault);
#else
#define plan_check_sampling(plan, fault) ERR_OK
#endif
#if CONFIG_CALIBRATION
enum err plan_check_calibration(const struct plan *plan, struct config_fault *fault);
#else
#define plan_check_calibration(plan, fault) ERR_OK
#endif
/* May loop i be put in order: is everything there that its setpoint comes from? */
bool plan_setpoint_ready(const struct plan *plan, uint8_t i, const bool *taken);
/* The next of names with blanks between them; returns where the one after it begins, or NULL: there was none. */
const char *plan_next_name(const char *list, char name[CHANNEL_NAME_SIZE]);
#if CONFIG_BLOCKS
/* plan_records.c: blocks with a record. Channels and loops are resolved already, their order is not. */
enum err plan_resolve_records(struct plan *plan, struct config_fault *fault);
/* ... now it is, and the kinds look at their settings. */
enum err plan_check_records(struct plan *plan, struct config_fault *fault);
/* plan_record_stages.c: of a feedforward element the MVs it adds to; that a compensator or an element has what it needs; that
 * none moves an MV it looks at, once all feedforwards are resolved. */
enum err plan_resolve_added(struct plan *plan, uint8_t n, struct config_fault *fault);
enum err plan_check_stage(const struct plan *plan, uint8_t n, struct config_fault *fault);
enum err plan_check_rings(const struct plan *plan, struct config_fault *fault);
/* Grains in the arena behind the state of the block: of a compensator one for each member (compensate_blocks.c). */
uint32_t plan_grains_behind(const struct plan *plan, uint8_t slot);
/* How deep that of each MV is, and whether there is memory for them behind the blocks: `at`, in grains. Kinds have accepted
 * their settings already. */
enum err plan_resolve_histories(struct plan *plan, uint32_t at, struct config_fault *fault);
#else
#define plan_resolve_records(plan, fault)       ERR_OK
#define plan_check_records(plan, fault)         ERR_OK
#define plan_check_rings(plan, fault)           ERR_OK
#define plan_grains_behind(plan, slot)          0u
#define plan_resolve_histories(plan, at, fault) ERR_OK
#endif
/* Their places in the arena, when all have been checked. */
enum err plan_place_blocks(struct plan *plan, struct config_fault *fault);

#endif

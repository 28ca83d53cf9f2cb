/* Functions that plan_build.c shares with the files of the parts of a plan. */
#ifndef REFLUX_PLAN_PLAN_PARTS_H
#define REFLUX_PLAN_PLAN_PARTS_H

#include "exchange/plan.h"

/* Fills *fault, and returns `code`. */
enum err plan_refuse(struct config_fault *fault, enum err code, const char *group, unsigned index,
                     const char *field, const char *subject, const char *wanted);
/* plan_feedforward.c: resolves the source of each ffN. The loops must be resolved already. */
enum err plan_resolve_feedforwards(struct plan *plan, struct config_fault *fault);

/* plan_blocks.c: find the kind of a loop's own controller, of the decoupler or of a feedforward element ffN, and
 * have it check the settings. Their channels must be resolved already. */
enum err plan_check_own(struct plan *plan, uint8_t loop, struct config_fault *fault);
enum err plan_check_matrix(struct plan *plan, struct config_fault *fault);
enum err plan_check_feedforward(struct plan *plan, uint8_t element, struct config_fault *fault);
/* Resolves an alarm on `blockN.CODE`. */
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
/* Returns true if loop i may be put in order: its setpoint has no source, or its source has been taken. */
bool plan_setpoint_ready(const struct plan *plan, uint8_t i, const bool *taken);
/* Loop i has just been taken. Puts its own controller, and a blockN all of whose members are taken by now, behind the n
 * controllers listed so far. Returns how many there are then. */
uint8_t plan_list_controllers(struct plan *plan, uint8_t i, const bool *taken, uint8_t n);
/* Copies the next name of a list with blanks between the names. Returns where the name after it begins, or NULL if
 * there was none. */
const char *plan_next_name(const char *list, char name[CHANNEL_NAME_SIZE]);
#if CONFIG_BLOCKS
/* plan_numbered.c: resolves the blocks with a number (blockN). Channels and loops must be resolved already, but not
 * the order of the loops. */
enum err plan_resolve_numbered(struct plan *plan, struct config_fault *fault);
/* Has the kinds check the settings of blocks with a number; the loops must be in order. */
enum err plan_check_numbered(struct plan *plan, struct config_fault *fault);
/* plan_numbered_stages.c: resolve the MVs that a feedforward element adds to; check that a compensator or feedforward
 * element has what it needs; and check that none moves an MV that it looks at, after all feedforward elements have been
 * resolved. */
enum err plan_resolve_added(struct plan *plan, uint8_t n, struct config_fault *fault);
enum err plan_check_stage(const struct plan *plan, uint8_t n, struct config_fault *fault);
enum err plan_check_rings(const struct plan *plan, struct config_fault *fault);
/* Finds the depth of each MV's history, and checks that they fit behind the blocks, from grain `at` on. The kinds
 * must have accepted their settings already. */
enum err plan_resolve_histories(struct plan *plan, uint32_t at, struct config_fault *fault);
#else
#define plan_resolve_numbered(plan, fault)      ERR_OK
#define plan_check_numbered(plan, fault)        ERR_OK
#define plan_check_rings(plan, fault)           ERR_OK
#define plan_resolve_histories(plan, at, fault) ERR_OK
#endif
/* Gives the blocks their places in the arena, after all checks. */
enum err plan_place_blocks(struct plan *plan, struct config_fault *fault);

#endif

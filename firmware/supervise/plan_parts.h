/* What plan.c shares with the file of one kind of block. */
#ifndef REFLUX_SUPERVISE_PLAN_PARTS_H
#define REFLUX_SUPERVISE_PLAN_PARTS_H

#include "supervise/plan.h"

/* Fills *fault, and returns `code`. */
enum err plan_refuse(struct config_fault *fault, enum err code, const char *group, unsigned index,
                     const char *field, const char *subject, const char *wanted);
/* Blocks name the fields of their own settings; people know the parameters. */
const char *plan_parameter_field(const char *field);

/* plan_feedforward.c. The loops are resolved already. */
enum err plan_resolve_feedforwards(struct plan *plan, struct config_fault *fault);

#endif

/* Profile of a column: every stage from the reboiler up, onto standard output. */
#ifndef REFLUX_HOST_SIM_COLUMN_PROFILE_H
#define REFLUX_HOST_SIM_COLUMN_PROFILE_H

#include "plants/plant.h"

/* Prints a plant whose class is a column's (class->column), at its present state and inputs. As JSON, else as CSV. */
void column_profile_print(const struct plant_class *class, const struct plant *p, bool json);

#endif

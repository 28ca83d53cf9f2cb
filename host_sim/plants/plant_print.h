/* Prints the description of a plant onto stdout: for --list, --steady, --linearise and --step. */
#ifndef REFLUX_HOST_SIM_PLANT_PRINT_H
#define REFLUX_HOST_SIM_PLANT_PRINT_H

#include "linear/linearise.h"
#include "plants/plant.h"

void plant_print_line(const struct plant_class *class, const char *error); /* one of a list */
void plant_print_full(const struct plant_class *class);
void plant_print_values(const struct plant_class *class, const struct plant *p);
void plant_print_matrices(const struct plant_class *class, const struct linearised *l, bool json);
/* Responses to a step of every input in turn, each from the point that `begin` makes. */
bool plant_print_steps(const struct plant_class *class,
                       struct plant *(*begin)(char *err, size_t err_size), double tick_s,
                       size_t ticks, double percent, char *err, size_t err_size);

#endif

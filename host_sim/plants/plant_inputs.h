/* Several inputs of a plant that change at one time. */
#ifndef REFLUX_HOST_SIM_PLANT_INPUTS_H
#define REFLUX_HOST_SIM_PLANT_INPUTS_H

#include "plants/plant.h"

#define PLANT_CHANGES_MAX ((size_t)1056)

struct plant_change {
    size_t channel; /* as set_input of the class takes it */
    double value;
};

/* Sets them all. What they are together counts: one that is refused because of what another still is, a fraction of the
 * feed that leaves too little for the rest, is set after the others. Of one channel the last counts. False with the reason
 * where one is refused whatever the order; some may have been set then. n: at most PLANT_CHANGES_MAX. */
bool plant_set_inputs(const struct plant_class *class, struct plant *p,
                      const struct plant_change *change, size_t n, char *err, size_t err_size);

/* Reads NAME=NUMBER, an input of the class. option: as the line says in front of what is wrong. */
bool plant_read_input(const char *option, const struct plant_class *class, const char *text,
                      struct plant_change *change, char *err, size_t err_size);

/* The class with the truths of these names as measurements behind its others, without lag and noise; NULL with the reason.
 * It lives as long as the program. */
const struct plant_class *plant_measuring(const struct plant_class *class, const char *const *name,
                                          size_t n, char *err, size_t err_size);

/* A plant at the steady state of these inputs, time 0; NULL on error. *bad_input: it is the inputs that are wrong. */
struct plant *plant_create_at(const struct plant_class *class, const struct plant_change *change,
                              size_t n, bool *bad_input, char *err, size_t err_size);

#endif

/* Every plant there is: those written in C (plant_classes), those in host_sim/plants/NAME.json, which are built in,
 * and those in the folder that REFLUX_PLANTS names. */
#ifndef REFLUX_HOST_SIM_PLANT_LIBRARY_H
#define REFLUX_HOST_SIM_PLANT_LIBRARY_H

#include "plants/plant.h"

/* Built-in texts, made at build time from host_sim/plants; ends with name NULL. */
struct plant_text {
    const char *name; /* the file's, without .json */
    const unsigned char *text;
    size_t length;
};
extern const struct plant_text plant_texts[];

/* A plant by name, or from a file when the name ends in .json or has a slash. NULL with the reason in err. It
 * lives until plant_library_free(). */
const struct plant_class *plant_open(const char *name, char *err, size_t err_size);

/* Calls visit for every plant in turn; one that cannot be read is handed over as NULL with the reason in error. */
void plant_library_each(void (*visit)(const struct plant_class *class, const char *error));

void plant_library_free(void);

#endif

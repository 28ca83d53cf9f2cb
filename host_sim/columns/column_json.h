/* Reads a column from its file (docs/use/columns.md): the JSON that has the key `column`. */
#ifndef REFLUX_HOST_SIM_COLUMN_JSON_H
#define REFLUX_HOST_SIM_COLUMN_JSON_H

#include "plants/json_walk.h"
#include "plants/plant.h"

/* Fills the class from the file's root; what it points at lives as long as root and the walk's memory. What is
 * wrong is kept in w. */
void column_json_read(struct json_walk *w, const json_t *root, struct plant_class *class);

#endif

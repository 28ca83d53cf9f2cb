/* Reads a linear plant from a JSON text (docs/use/linear-plants.md). Errors are one line: the name of the file,
 * then line and column when the text is not JSON, or the key's path when its meaning is wrong. */
#ifndef REFLUX_HOST_SIM_PLANT_JSON_H
#define REFLUX_HOST_SIM_PLANT_JSON_H

#include "plants/plant.h"

/* file: how errors name it. The class lives until plant_json_free(). NULL on error. */
struct plant_class *plant_json_read(const char *file, const char *text, size_t length, char *err,
                                    size_t err_size);
void plant_json_free(struct plant_class *class);

#endif

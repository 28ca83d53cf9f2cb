/* Units of plant files, in the characters that the plant link, the console and the logs carry. */
#ifndef REFLUX_HOST_SIM_PLANT_UNIT_H
#define REFLUX_HOST_SIM_PLANT_UNIT_H

#include "plants/json_walk.h"

#define PLANT_UNIT_MAX ((size_t)11)

/* Returns the text of the key "unit", "-" where there is none. Signs such as the degree sign are transliterated; a unit that is
 * not printable ASCII without blanks and commas after that, or too long, fails. */
const char *plant_read_unit(struct json_walk *w, const json_t *object);

#endif

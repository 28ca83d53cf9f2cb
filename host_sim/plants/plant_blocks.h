/* Blocks of a linear plant from the model part of its file: transfer functions, matrices or polynomials. */
#ifndef REFLUX_HOST_SIM_PLANT_BLOCKS_H
#define REFLUX_HOST_SIM_PLANT_BLOCKS_H

#include "linear/linear_plant.h"
#include "plants/json_walk.h"

/* model->channels and the counts are set. unit_s: seconds of the file's time unit. Fills period and blocks. */
bool plant_blocks_read(struct json_walk *w, const json_t *root, double unit_s,
                       struct linear_model *model);

#endif

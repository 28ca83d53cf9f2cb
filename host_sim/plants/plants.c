#include "plants/plant.h"

#include <stddef.h>

extern const struct plant_class plant_pilot_cold;

const struct plant_class *const plant_classes[] = {
    &plant_pilot_cold,
    NULL,
};

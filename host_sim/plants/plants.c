#include "plant.h"

#include <string.h>

extern const struct plant_class plant_pilot;

const struct plant_class *const plant_classes[] = {
    &plant_pilot,
    NULL,
};

const struct plant_class *plant_find(const char *name)
{
    for (const struct plant_class *const *p = plant_classes; *p; p++)
        if (strcmp((*p)->name, name) == 0)
            return *p;
    return NULL;
}

#include "plant.h"

#include <string.h>

extern const struct plant_class plant_pilot;
extern const struct plant_class plant_splitter;

const struct plant_class *const plant_classes[] = {
    &plant_pilot,
    &plant_splitter,
    NULL,
};

const struct plant_class *plant_find(const char *name)
{
    for (const struct plant_class *const *p = plant_classes; *p; p++)
        if (strcmp((*p)->name, name) == 0)
            return *p;
    return NULL;
}

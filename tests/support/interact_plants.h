/* Reads tests/reference/interact_plants.csv: the plants, reduced to first order with dead time, and what numpy says of
 * them. The meaning of `what` stands in tests/reference/interact_plants.py. */
#ifndef REFLUX_TESTS_INTERACT_PLANTS_H
#define REFLUX_TESTS_INTERACT_PLANTS_H

#include <string.h>

#include "csv.h"
#include "interact/plant.h"

enum {
    PLANT_AIR_COMPRESSOR = 1,
    PLANT_COLUMN_9001,
    PLANT_FOLAMI,
    PLANT_FURNACE,
    PLANT_KOTYK,
    PLANT_LIME_KILN,
    PLANT_LUYBEN_4X4,
    PLANT_LUYBEN_VINANTE,
    PLANT_PACKED_BED,
    PLANT_PAPER_MACHINE,
    PLANT_SHELL,
    PLANT_WOOD_BERRY,
    PLANTS = PLANT_WOOD_BERRY
};

enum { DYNAMIC = 3 };

struct known_plant {
    struct interact_plant plant; /* gain_sd 0 */
    struct pairs pairs;          /* the committed pairing, outputs ascending; n = 0: none */
    unsigned rank;
    double gain[INTERACT_MAX][INTERACT_MAX], lambda[INTERACT_MAX][INTERACT_MAX];
    double singular[INTERACT_MAX], condition, least_condition, niederlinski;
    double pair_lambda[INTERACT_MAX], omega[DYNAMIC], probability;
    double dynamic_modulus[DYNAMIC][INTERACT_MAX][INTERACT_MAX];
    double dynamic_real[DYNAMIC][INTERACT_MAX][INTERACT_MAX];
    double rnga[INTERACT_MAX][INTERACT_MAX], rarta[INTERACT_MAX][INTERACT_MAX];
};

static inline void known_plant_row(struct known_plant *k, unsigned what, unsigned i, unsigned j,
                                   double value)
{
    switch (what) {
    case 0:
        k->plant.outputs = (uint8_t)i;
        k->plant.inputs = (uint8_t)j;
        break;
    case 1:
        k->gain[i][j] = value;
        k->plant.element[i][j].gain = (real_t)value;
        break;
    case 2:
        k->plant.element[i][j].dead_time_s = (real_t)value;
        break;
    case 3:
        k->plant.element[i][j].time_constant_s = (real_t)value;
        break;
    case 4:
        k->lambda[i][j] = value;
        break;
    case 5:
        k->singular[i] = value;
        break;
    case 6:
        k->condition = value;
        break;
    case 7:
        k->least_condition = value;
        break;
    case 8:
        k->niederlinski = value;
        break;
    case 9:
        k->pairs.output[k->pairs.n] = (uint8_t)i;
        k->pairs.input[k->pairs.n] = (uint8_t)j;
        k->pair_lambda[k->pairs.n++] = value;
        break;
    case 10:
        k->rank = (unsigned)value;
        break;
    case 11:
        k->omega[i] = value;
        break;
    case 12:
        k->probability = value;
        break;
    case 40:
        k->rnga[i][j] = value;
        break;
    case 41:
        k->rarta[i][j] = value;
        break;
    default:
        if (what >= 20 && what < 20 + DYNAMIC)
            k->dynamic_modulus[what - 20][i][j] = value;
        if (what >= 30 && what < 30 + DYNAMIC)
            k->dynamic_real[what - 30][i][j] = value;
        break;
    }
}

/* number: one of the PLANT_ above. */
static inline void known_plant(unsigned number, struct known_plant *k)
{
    memset(k, 0, sizeof *k);
    FILE *f = csv_open("reference/interact_plants.csv");
    double v[5];
    while (csv_row(f, v, 5))
        if ((unsigned)v[0] == number)
            known_plant_row(k, (unsigned)v[1], (unsigned)v[2], (unsigned)v[3], v[4]);
    fclose(f);
    if (k->plant.outputs == 0) {
        fprintf(stderr, "no plant %u in the reference table\n", number);
        exit(2);
    }
}

#endif

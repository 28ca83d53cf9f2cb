/* Channels of a column in the column's own terms (model/column.h): a table that binds every input, and what
 * stands for an input that is none, to a quantity and a unit, and every other channel to a value of the column.
 * Which quantities there are, with their units: docs/reference/plant-files.md.
 *
 * Pure functions on real_t. The table holds doubles and no real_t, so that builds of the model in several
 * precisions read the same one. */
#ifndef REFLUX_HOST_SIM_COLUMN_TERMS_H
#define REFLUX_HOST_SIM_COLUMN_TERMS_H

#include "columns/column_units.h"
#include "model/column.h"

/* Quantities that drive a column. */
enum column_drive {
    DRIVE_REFLUX,
    DRIVE_HEAT,
    DRIVE_BOILUP,
    DRIVE_FEED,
    DRIVE_FEED_FRACTION,
    DRIVE_FEED_TEMPERATURE,
    DRIVE_FEED_QUALITY,
    DRIVE_REFLUX_SUBCOOLING,
    DRIVE_HEAT_LOSS,
    DRIVE_PRESSURE,
    DRIVE_DISTILLATE,
    DRIVE_BOTTOMS,
    DRIVE_COUNT
};

/* Values that can be seen of a column. */
enum column_sight {
    SIGHT_TEMPERATURE,
    SIGHT_TEMPERATURE_DIFFERENCE,
    SIGHT_FRACTION,
    SIGHT_LOG_FRACTION,
    SIGHT_VAPOUR_FRACTION,
    SIGHT_LEVEL,
    SIGHT_DISTILLATE,
    SIGHT_BOTTOMS,
    SIGHT_REFLUX,
    SIGHT_BOILUP,
    SIGHT_LIQUID_FLOW,
    SIGHT_VAPOUR_FLOW,
    SIGHT_HEAT,
    SIGHT_FEED,
    SIGHT_FEED_TEMPERATURE,
    SIGHT_PRESSURE,
    SIGHT_COUNT
};

/* Every quantity once, and one fraction for each component. */
#define COLUMN_DRIVES_MAX (DRIVE_COUNT - 1 + COLUMN_COMPONENTS_MAX)

#ifdef MODEL_SYMBOL /* a suffix for each precision (model/double_symbols.h) */
#define column_terms_inputs MODEL_SYMBOL(column_terms_inputs)
#define column_terms_value  MODEL_SYMBOL(column_terms_value)
#define column_terms_holdup MODEL_SYMBOL(column_terms_holdup)
#endif

struct column_driven {
    enum column_drive drive;
    size_t component; /* index, of a fraction of the feed */
    const struct column_unit *unit;
    double value; /* of a constant */
};

struct column_seen {
    enum column_sight sight;
    const struct column_unit *unit;
    const size_t *stage; /* [n_stages] indices, 0 = reboiler */
    size_t n_stages;
    const size_t *component; /* [n_components] indices */
    size_t n_components;
};

struct column_terms {
    size_t n_inputs, n_driven; /* the first n_inputs are channels, the others constants */
    struct column_driven driven[COLUMN_DRIVES_MAX];
    bool every_fraction;            /* the feed's are given of every component */
    size_t rest;                    /* else: the component that has what is left */
    const struct column_seen *seen; /* [n_seen] the channels behind the inputs */
    size_t n_seen;
};

/* Inputs in the column's terms from the values u[n_inputs] of its input channels. NULL, or what is wrong, as a text
 * that follows "NAME = VALUE ": then *in is of no use. config: for the components' molar masses. */
const char *column_terms_inputs(const struct column_terms *terms,
                                const struct column_config *config, const real_t *u,
                                struct column_inputs *in);

/* Value of the channel seen[k], in its unit, of a column evaluated at the state x. */
real_t column_terms_value(const struct column_terms *terms, const struct column *column,
                          const real_t *x, size_t k);

/* Holdup of a stage, mol, of a column evaluated at the state x. An empty vessel is empty here, though the balances count
 * a little as its holdup. */
real_t column_terms_holdup(const struct column *column, const real_t *x, size_t s);

/* The lowest sum of the feed's fractions that is divided by, as a share of the whole. */
#define COLUMN_FRACTIONS_MIN 0.1
/* By so much, relative to the whole, those that leave nothing for the rest may be more than it: 0.2 and 0.8 are, when their
 * doubles are added in a longer type. */
#define COLUMN_FRACTIONS_ROUNDING 1e-12

/* Smallest argument of logarithms of a fraction and of 1 less it, near 0 and 1. */
#define COLUMN_LOG_MARGIN 1e-12

#endif

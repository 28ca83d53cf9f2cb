/* Places in the compact table of a column (docs/methods/column-table.md), in SI units. Nothing but numbers of places, because
 * maker and reader of a table may have different real_t. */
#ifndef REFLUX_MODEL_COLUMN_TABLE_FORM_H
#define REFLUX_MODEL_COLUMN_TABLE_FORM_H

#define COLUMN_TABLE_VERSION 1
/* The most that a board takes. */
#define COLUMN_TABLE_STAGES     40
#define COLUMN_TABLE_COMPONENTS 4

/* Names have up to 15 letters, digits and underscores: four values of four characters each, six bits a character, the first
 * one lowest. 0 is none, 1 and up the characters of COLUMN_TABLE_LETTERS. */
#define COLUMN_TABLE_NAME        4
#define COLUMN_TABLE_NAME_SIZE   16
#define COLUMN_TABLE_LETTERS     "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ_abcdefghijklmnopqrstuvwxyz"
#define COLUMN_TABLE_WORD_STAGES 24 /* stages of a value of COLUMN_TABLE_TRUNCATED, a bit each */

enum column_table_place {
    COLUMN_TABLE_TITLE = 0,
    COLUMN_TABLE_N_STAGES = COLUMN_TABLE_TITLE + COLUMN_TABLE_NAME,
    COLUMN_TABLE_N_COMPONENTS,
    COLUMN_TABLE_FEED_STAGE,
    COLUMN_TABLE_EFFICIENCY,
    COLUMN_TABLE_PRESSURE_DROP,   /* Pa */
    COLUMN_TABLE_HOLDUP,          /* 0 molar, 1 volumetric, 2 conservative */
    COLUMN_TABLE_HOLDUP_REBOILER, /* mol or m3, as the two after it */
    COLUMN_TABLE_HOLDUP_TRAY,
    COLUMN_TABLE_HOLDUP_CONDENSER,
    COLUMN_TABLE_HOLDUP_BOTTOM_K, /* temperatures at which volumes count */
    COLUMN_TABLE_HOLDUP_TOP_K,
    COLUMN_TABLE_LOWEST_K,
    COLUMN_TABLE_HIGHEST_K,
    COLUMN_TABLE_SOFTNESS,
    COLUMN_TABLE_ACTIVITY,   /* 0 ideal, 1 Wilson, 2 NRTL */
    COLUMN_TABLE_FEED_BASIS, /* 0 mol/s, 1 kg/s, 2 m3/s */
    COLUMN_TABLE_FEED,
    COLUMN_TABLE_FEED_BY, /* 0 temperature in K, 1 quality */
    COLUMN_TABLE_FEED_STATE,
    COLUMN_TABLE_REFLUX_BASIS,
    COLUMN_TABLE_REFLUX,
    COLUMN_TABLE_SUBCOOLING,   /* K */
    COLUMN_TABLE_BOILUP_GIVEN, /* 0: heat in W, 1: boil-up in mol/s */
    COLUMN_TABLE_HEAT,         /* what boils, the loss taken off */
    COLUMN_TABLE_HEAT_LOSS,    /* W */
    COLUMN_TABLE_PRESSURE,     /* Pa */
    COLUMN_TABLE_TRUNCATED,    /* stages 1 to 24; those behind them in the next */
    COLUMN_TABLE_FIXED = COLUMN_TABLE_TRUNCATED + 2
};

/* Behind them each component, the closing one last. */
enum column_table_component {
    COLUMN_TABLE_C_NAME = 0,
    COLUMN_TABLE_C_ANTOINE = COLUMN_TABLE_C_NAME + COLUMN_TABLE_NAME,
    COLUMN_TABLE_C_MASS = COLUMN_TABLE_C_ANTOINE + 7,
    COLUMN_TABLE_C_DENSITY,
    COLUMN_TABLE_C_HEAT = COLUMN_TABLE_C_DENSITY + 2,
    COLUMN_TABLE_C_BOILING,
    COLUMN_TABLE_C_CRITICAL,
    COLUMN_TABLE_C_CAPACITY,
    COLUMN_TABLE_C_FEED, /* fraction of the feed; 0 of another property: not given */
    COLUMN_TABLE_C_VALUES
};

/* Then, with an activity model, its tables a and b, of NRTL alpha too, row by row; then the mole fractions of all components
 * but the last, stage by stage from the reboiler. */
#define COLUMN_TABLE_ACTIVITY_VALUES(model, components)                                            \
    ((model) ? ((model) + 1u) * (components) * (components) : 0u)
#define COLUMN_TABLE_VALUES(stages, components, model)                                             \
    (COLUMN_TABLE_FIXED + (components)*COLUMN_TABLE_C_VALUES +                                     \
     COLUMN_TABLE_ACTIVITY_VALUES(model, components) + (stages) * ((components)-1u))

/* Values of a line. */
#define COLUMN_TABLE_COLS 8u
#define COLUMN_TABLE_ROWS                                                                          \
    ((COLUMN_TABLE_VALUES(COLUMN_TABLE_STAGES, COLUMN_TABLE_COMPONENTS, 2u) + COLUMN_TABLE_COLS -  \
      1u) /                                                                                        \
     COLUMN_TABLE_COLS)
#define COLUMN_TABLE_MOST (COLUMN_TABLE_ROWS * COLUMN_TABLE_COLS)

#endif

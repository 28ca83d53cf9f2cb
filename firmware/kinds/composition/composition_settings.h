/* Settings of the kind `composition` (docs/composition-estimation.md), as its parameters fill them. Row k: input k of the block, or
 * its point k. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_SETTINGS_H
#define REFLUX_COMPOSITION_COMPOSITION_SETTINGS_H

#include "block/block.h"

#if CONFIG_BLOCKS

enum composition_method {
    METHOD_GEOMETRIC,
    METHOD_REKF,
    METHOD_EKF,   /* complete innovation, the model as it is */
    METHOD_KALMAN /* likewise, the model linear around the table's profile */
};

/* In which form the covariance of complete innovation is kept. */
enum composition_covariance {
    COVARIANCE_FULL,  /* whole, as UD factors */
    COVARIANCE_BAND,  /* of stages near one another */
    COVARIANCE_STEADY /* none: gains of its steady state, found once */
};

/* What a point is of. */
enum composition_point_of { OF_STAGE, OF_FEED_FRACTION, OF_FEED_FLOW };

/* Fractions of the points. */
enum composition_basis { BASIS_MOLE, BASIS_MASS };

/* What an alarm makes of the estimates. */
enum composition_doubt { DOUBT_BAD, DOUBT_UNCERTAIN };

/* What an input is of the column. */
enum composition_input {
    IS_TEMPERATURE,
    IS_FEED,
    IS_FEED_TEMPERATURE,
    IS_FEED_QUALITY,
    IS_REFLUX,
    IS_HEAT,
    IS_BOILUP,
    IS_PRESSURE,
    IS_ANALYSIS,
    IS_KINDS
};

enum { AT_STAGE, OF_COMPONENT, PLACE_COLS }; /* columns of place and of point */
enum { TUNE_LAMBDA, TUNE_ZETA, TUNE_COLS };  /* 1/h, - */
enum { UNIT_FACTOR, UNIT_ZERO, UNIT_COLS };  /* SI = factor * value + zero */

/* What a block keeps of its settings. */
struct composition_settings {
    float si[BLOCK_INPUTS_MAX][UNIT_COLS];
    float show[BLOCK_POINTS_MAX][UNIT_COLS]; /* value = factor * SI + zero */
    float pull;                              /* K/h, alarm; 0: none */
    float watch_s;                           /* s, of the means of the monitor */
    float nis;                               /* alarm; 0: none */
    float nis_full;                          /* the same, with gains of complete innovation */
    float apart;                             /* K/h, alarm; 0: none */
    float far;                               /* mole fraction, of an analysis; 0: none */
    float late_s;                            /* s, after which an analysis is missed; 0: never */
    float reach_s;                           /* s, the oldest sample of an analyser that counts */
    float alone_s;                           /* s, without any temperature */
    float cycle_s;                           /* s, between two gains; 0: a tick */
    float
        feed_z; /* mole fraction, standard deviation of the feed's that nobody measures; 0: none */
    float feed_f;   /* part of the feed flow, likewise */
    float feed_s;   /* s, that they keep */
    float analyser; /* mole fraction, standard deviation of an analysis */
    float sure; /* mole fraction, standard deviation above which a point is uncertain; 0: none */
    float sure_part; /* the same, part of the impurity; 0: none */
    float lasting; /* part of the impurity that the model is off by for good, standard deviation */
    float offset;  /* mole fraction, of the model at the place of an analysis, likewise; 0: none */
    uint16_t column; /* block */
    uint16_t place[BLOCK_INPUTS_MAX]
                  [PLACE_COLS]; /* stage, component that is moved; 0: only compared */
    uint16_t point[BLOCK_POINTS_MAX]
                  [PLACE_COLS];   /* stage, component; 0: the temperature. Of the feed no stage */
    uint8_t is[BLOCK_INPUTS_MAX]; /* enum composition_input */
    uint8_t of[BLOCK_POINTS_MAX]; /* enum composition_point_of */
    uint8_t method;               /* enum composition_method */
    uint8_t between;              /* enum column_between */
    uint8_t doubt;                /* enum composition_doubt */
    uint8_t basis;                /* enum composition_basis */
    uint8_t covariance;           /* enum composition_covariance */
};

/* All of them. */
struct composition_record {
    struct composition_settings s;
    float tune[BLOCK_INPUTS_MAX][TUNE_COLS];
    float noise; /* K, standard deviation of a reading */
    float
        model; /* of the model's rates: standard deviation that a mole fraction gathers in an hour */
    float gate;                                 /* K; 0: none */
    float gate_s;                               /* s, after which what is outside it is believed */
    struct block_return back[BLOCK_POINTS_MAX]; /* of the loop below one on this point */
};

extern const struct block_kind composition_kind;

#endif
#endif

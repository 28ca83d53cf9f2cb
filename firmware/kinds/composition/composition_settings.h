/* Settings of the kind `composition` (docs/methods/composition-estimation.md), as its parameters fill them. Row k belongs to input k of the
 * block, or to its point k. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_SETTINGS_H
#define REFLUX_COMPOSITION_COMPOSITION_SETTINGS_H

#include "block/block.h"
#include "num/real.h"

#if CONFIG_BLOCKS

enum composition_method {
    METHOD_GEOMETRIC,
    METHOD_REKF,
    METHOD_EKF,   /* complete innovation, the nonlinear model */
    METHOD_KALMAN /* complete innovation, the model linear around the table's profile */
};

/* Form in which the covariance of complete innovation is kept. */
enum composition_covariance {
    COVARIANCE_FULL,  /* whole, as UD factors */
    COVARIANCE_BAND,  /* blocks of neighbouring stages */
    COVARIANCE_STEADY /* none: gains of the steady state, computed once */
};

/* Quantity that a point shows. */
enum composition_quantity { OF_STAGE, OF_FEED_FRACTION, OF_FEED_FLOW };

/* Fractions of the points. */
enum composition_basis { BASIS_MOLE, BASIS_MASS };

/* Quality of the estimates while an alarm is on. */
enum composition_doubt { DOUBT_BAD, DOUBT_UNCERTAIN };

/* Quantity of the column that an input measures. */
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

/* Columns of place and of point. */
enum { AT_STAGE, OF_COMPONENT, PLACE_COLS };
/* Columns of tune: 1/h, -. */
enum { TUNE_LAMBDA, TUNE_ZETA, TUNE_COLS };
/* Columns of si and of show: SI = factor * value + zero. */
enum { UNIT_FACTOR, UNIT_ZERO, UNIT_COLS };

#define SENSORS_MAX  BLOCK_INPUTS_MAX
#define ANALYSES_MAX 2

/* Settings that a block keeps. */
struct composition_settings {
    float si[BLOCK_INPUTS_MAX][UNIT_COLS];
    /* value = factor * SI + zero */
    float show[BLOCK_POINTS_MAX][UNIT_COLS];
    /* K/h, alarm; 0: none */
    float pull;
    /* s, averaging time of the monitor */
    float watch_s;
    /* alarm; 0: none. With gains of complete innovation `nis_full` counts instead. */
    float nis;
    float nis_full;
    /* K/h, alarm; 0: none */
    float apart;
    /* mole fraction by which an analysis may differ; 0: any */
    float analysis_gate;
    /* s, after which an analysis is missed; 0: never */
    float late_s;
    /* s, age of the oldest sample of an analyser that counts */
    float reach_s;
    /* s, without any temperature */
    float alone_s;
    /* s, between two gains; 0: a tick */
    float cycle_s;
    /* Standard deviations of the unmeasured feed: mole fraction, 0: none; part of the flow. */
    float feed_z;
    float feed_f;
    /* s, correlation time of both */
    float feed_s;
    /* mole fraction, standard deviation of an analysis */
    float analyser;
    /* Standard deviation above which a point is uncertain, 0: none: mole fraction; part of the impurity. */
    float sure;
    float sure_part;
    /* part of the impurity, standard deviation of the model's lasting error */
    float lasting;
    /* mole fraction, standard deviation of the model's offset at the place of an analysis; 0: none */
    float offset;
    /* block with the table */
    uint16_t column;
    /* stage, component that the temperature moves; 0: it is only compared */
    uint16_t place[BLOCK_INPUTS_MAX][PLACE_COLS];
    /* stage, 0 for the feed; component, 0 for the temperature */
    uint16_t point[BLOCK_POINTS_MAX][PLACE_COLS];
    /* enum composition_input */
    uint8_t role[BLOCK_INPUTS_MAX];
    /* enum composition_quantity */
    uint8_t quantity[BLOCK_POINTS_MAX];
    uint8_t method;     /* enum composition_method */
    uint8_t between;    /* enum column_between */
    uint8_t doubt;      /* enum composition_doubt */
    uint8_t basis;      /* enum composition_basis */
    uint8_t covariance; /* enum composition_covariance */
};

/* All settings. */
struct composition_record {
    struct composition_settings s;
    float tune[BLOCK_INPUTS_MAX][TUNE_COLS];
    /* K, standard deviation of a reading */
    float noise;
    /* standard deviation that a mole fraction gathers in an hour by errors of the model's rates */
    float model;
    /* K; 0: none */
    float gate;
    /* s, after which a reading outside the gate is used */
    float gate_s;
    /* setpoint of the loop below one on this point */
    struct block_return back[BLOCK_POINTS_MAX];
};

/* True: the model follows the column, and the covariance is complete. */
bool composition_follows_model(const struct composition_settings *s);
/* True: a temperature moves all mole fractions, once there are gains. */
bool composition_is_complete(const struct composition_settings *s);
bool composition_is_sensor(const struct composition_settings *s, unsigned k);
/* Returns the standard deviation of the feed's flow, part of it; 0: the flow is taken as exact. */
real_t composition_feed_f(const struct composition_settings *s, unsigned inputs);
/* Returns the number of extra states (kinds/composition/covariance.h) for a number of inputs and m mole fractions of a stage. */
size_t composition_extras(const struct composition_settings *s, unsigned inputs, size_t m);

static inline bool composition_is_banded(const struct composition_settings *s)
{
    return s->covariance == COVARIANCE_BAND;
}

extern const struct block_kind composition_kind;

#endif
#endif

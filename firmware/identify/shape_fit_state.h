/* The state of a fit of shapes, for the search (shape_search.h), for its course (shape_fit.h) and for the choice
 * (shape_choice.h). Times in samples, gains as of the record. */
#ifndef REFLUX_IDENTIFY_SHAPE_FIT_STATE_H
#define REFLUX_IDENTIFY_SHAPE_FIT_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "identify/excitation.h"
#include "identify/fit_line.h"
#include "num/real.h"

/* The formulas that are fitted. */
enum shape_formula {
    SHAPE_FORMULA_ONE,         /* one lag */
    SHAPE_FORMULA_TWO,         /* two lags, or damped */
    SHAPE_FORMULA_ZERO,        /* the same with a zero */
    SHAPE_FORMULA_INTEGRATING, /* an integrator with a lag */
    SHAPE_FORMULAS
};

/* Parameters that are searched for. */
struct shape_place {
    real_t dead;
    real_t time;  /* the lag; the sum of two */
    real_t ratio; /* their product over the square of their sum; of formulas TWO and ZERO */
};

/* The place that a search has found for a formula, and how sure it is of it. */
struct shape_candidate {
    struct shape_place place;
    real_t gain, gain_zero; /* of the integrator: of the lag that stands for it */
    real_t squares;         /* sum that is left; negative: not fitted */
    real_t correlation;     /* lag one, of the residuals */
    /* Covariance of gain, dead time, residence time, square and zero, in units of the record and seconds: lower triangle by rows. */
    real_t covariance[15];
    real_t lag_variance;
};

/* A slow tail beside a formula (shape_tail.h): what gain and residence time change by, and their covariance with it. */
struct shape_tail {
    real_t gain, residence_s;
    real_t gain_variance, residence_variance;
    real_t squares; /* sum that is left */
    real_t odds;    /* of there being one, by how well the record would show it; 0: none could be */
};

#define SHAPE_TAILS       3
#define SHAPE_TAIL_COLUMN 1 /* free with the formulas that have no zero */

#define SHAPE_CURVES 3

#define SHAPE_STARTS  5 /* of formula TWO, three of ZERO, of INTEGRATING */
#define SHAPE_COLUMNS 5 /* model, its derivative by time; derivatives by dead time, time, ratio */

struct shape_fit {
    struct excitation input;
    struct fit_line line;
    real_t h_s, noise_variance; /* of one point, as far as it is known */
    uint32_t block, points;
    /* The longest level: samples, its first one, and its height. */
    real_t level, level_height;
    uint32_t level_from;
    real_t integrator; /* lag that stands for one */
    real_t peak;       /* of the input */
    real_t total;      /* sum of squares without a response */
    real_t time_max, dead_max;
    /* the course */
    uint8_t phase, formula, run, part; /* formula and number of the search under way */
    uint32_t next, tries, evaluations;
    struct shape_place start[SHAPE_STARTS];
    real_t start_squares[SHAPE_STARTS];
    struct shape_place one; /* the lag that was given */
    /* the search under way: best so far, and the damped step from it */
    struct shape_place place;
    real_t gain, gain_zero, squares, damping;
    real_t triangle[15]; /* upper, by columns, of the orthogonal factors */
    real_t right[SHAPE_COLUMNS];
    struct shape_candidate candidate[SHAPE_FORMULAS];
    struct shape_tail tail[SHAPE_TAILS];
    uint8_t tail_base; /* formula that they are beside */
    /* what the choice looks at besides */
    real_t rough_variance;       /* of a point, by second differences */
    real_t plain_gain, plain_sd; /* of a response within a quarter of the level */
    bool ramp_agrees;            /* the slope of the integrator holds to the end of the level */
    real_t y[FIT_LINE_SIZE];     /* without line and even part */
    /* The curved part (shape_curve.h): bits of its terms, what they were in y, and their columns of length 1. */
    uint8_t curve_terms;
    real_t curve_part[SHAPE_CURVES];
    real_t curve[SHAPE_CURVES][FIT_LINE_SIZE];
    real_t column[SHAPE_COLUMNS][FIT_LINE_SIZE];
};

#endif

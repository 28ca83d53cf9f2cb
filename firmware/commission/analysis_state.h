/* What an analysis (analysis.h) keeps, finds and is told. */
#ifndef REFLUX_COMMISSION_ANALYSIS_STATE_H
#define REFLUX_COMMISSION_ANALYSIS_STATE_H

#include "design/detune.h"
#include "design/static_decoupler.h"
#include "design/trial.h"
#include "exchange/config.h"
#include "identify/steady.h"
#include "interact/cascade.h"
#include "interact/gains.h"
#include "interact/measure.h"
#include "interact/pairing.h"
#include "interact/structure.h"

enum analysis_stage {
    ANALYSIS_GAINS,
    ANALYSIS_CASCADES,
    ANALYSIS_PAIRING,
    ANALYSIS_SECOND,
    ANALYSIS_STRUCTURE,
    ANALYSIS_DECOUPLER,
    ANALYSIS_SETTINGS,
    ANALYSIS_PREDICTION,
    ANALYSIS_ALTERNATIVE, /* with and without a decoupler: the better of the two */
    ANALYSIS_DONE
};

struct analysis_config {
    real_t h_s;        /* sample interval of the loops, s */
    real_t confidence; /* 0.5 to 1: a pairing less probable is not determined */
    real_t floor;      /* relative standard deviation of a gain at least */
    real_t step;       /* setpoint step of the prediction, fraction of span */
    uint8_t loops_max; /* that the board can run */
    const real_t *
        noise_sd; /* of every output, fraction of span; NULL: none. It must live as long as the analysis */
};

/* Why there is no decoupler. */
enum analysis_decoupler {
    DECOUPLER_USED,
    DECOUPLER_NOT_NEEDED,
    DECOUPLER_TOO_MANY, /* loops: more than STATIC_DECOUPLER_LOOPS */
    DECOUPLER_ILL,      /* the inverse would amplify the errors of the gains */
    DECOUPLER_NO_BETTER /* than single loops, by what is predicted of both */
};

/* Integrals of |e| of all loops together after a step of one, the mean over the loops: for a step of one at a setpoint, s,
 * and at an input, s times spans of outputs over spans of inputs. 0: not predicted. */
struct analysis_figures {
    real_t setpoints, loads;
};

/* Settings and what is predicted of them. */
struct analysis_design {
    struct loops loops;
    real_t factor, factor_least, log_modulus_db, horizon_s;
    struct trial_loop predicted[INTERACT_MAX];
    struct trial_mark tried[INTERACT_MAX];
    struct matrix d;
};

/* What gains and residence times together (interact/measure.h) make of the pairing by gains alone. */
enum analysis_second { SECOND_NONE, SECOND_AGREES, SECOND_DIFFERS };

/* What speaks against a pairing: certainty.h. */
enum analysis_doubt {
    DOUBT_DRAWS = 1 << 0,       /* gains drawn about the estimates give others too often */
    DOUBT_DETERMINANT = 1 << 1, /* its sign is not sure */
    DOUBT_RANK = 1 << 2,        /* fewer directions than pairs stand out of the errors */
    DOUBT_SIGN = 1 << 3,        /* ... of the gain of a pair */
    DOUBT_SHAPE = 1 << 4,       /* a response was not seen to its end */
    DOUBT_SHAPE_FINAL = 1 << 5, /* one that a pair uses is no lag's: more tests do not help */
    DOUBT_SECOND = 1 << 6,      /* gains over residence times would pair otherwise */
    DOUBT_INTEGRITY =
        1 << 7 /* with some loops in manual the others may run away, for all that is known */
};

/* How an element begins where that is not as it goes on; time constant 0: it is. */
struct beginning {
    real_t time_constant_s, dead_time_s;
};

struct analysis {
    struct interact_plant
        plant; /* these four first: what follows begins anew with every analysis */
    struct beginning beginning[INTERACT_MAX][INTERACT_MAX]; /* settings are for this */
    /* Of each element what is unresolved: enum identified_flag. A loop is made of none with certainty.h's flags. */
    uint16_t flags[INTERACT_MAX][INTERACT_MAX];
    uint8_t given[INTERACT_MAX]; /* input + 1 that is output i's pair; 0: to be found */
    bool begins;                 /* plant and beginning have changed places, for the settings */
    struct analysis_config config;
    enum analysis_stage stage;

    /* gains */
    real_t singular[INTERACT_MAX], condition, condition_scaled;
    uint8_t rank, rank_exact, n_null;
    real_t null_input[INTERACT_MAX], null_output[INTERACT_MAX]; /* the first of them */
    struct matrix lambda; /* relative gains; valid where `has_lambda` */
    bool has_lambda;

    /* pairing */
    enum pairing_verdict verdict;
    struct pairs pairs;
    real_t pair_lambda[INTERACT_MAX], niederlinski, probability;
    real_t share[INTERACT_MAX];
    uint8_t rival[INTERACT_MAX];
    uint16_t ambiguous_outputs;
    enum analysis_second second; /* SECOND_NONE: no pairs, or no such gains */
    uint8_t doubts;              /* bits of enum analysis_doubt: any, and it is not determined */
    uint16_t
        used[INTERACT_MAX]; /* output j: bit i, a pair, or the inner loop below one, uses input i */
    uint16_t unsettled;     /* bit i: longer tests of input i may resolve a flag */
    real_t determinant;     /* in its own standard deviations */
    real_t integrity;       /* share of draws in which every subset of the loops holds */
    uint16_t negative;      /* pairs that run away without the others: struct pairing */
    real_t negative_index;
    real_t pair_phi[INTERACT_MAX];

    uint8_t n_cascades;
    struct cascade cascade[INTERACT_MAX];
    uint16_t inner_outputs; /* of the cascades that are used: bits of outputs without a pair */

    struct structure structure; /* where there are pairs */
    bool has_structure;

    /* design; only of a determined pairing */
    struct tuning inner_tuning[INTERACT_MAX]; /* of the loop below pair k, where there is one */
    bool designed;                            /* the settings below are to be used */
    enum err design_error;                    /* why not */
    enum analysis_decoupler decoupler;
    struct matrix d; /* identity where there is none */
    struct loops loops;
    real_t factor, factor_least, log_modulus_db; /* of the parts of the plant: struct detune */
    struct trial_loop
        predicted[INTERACT_MAX];           /* loop k after its own setpoint step of config.step */
    struct trial_mark tried[INTERACT_MAX]; /* ... after horizon_s of it */
    real_t horizon_s; /* five times the slowest loop's integral time and dead time */
    struct analysis_figures
        figures[2]; /* where there was a choice: with the decoupler, and without */
    struct analysis_design decoupled;   /* while the one without is made */
    bool has_decoupled, compares, load; /* the last: its load, not its setpoint, is stepped now */
    bool bounded;
    uint8_t at;       /* loop under prediction */
    uint8_t extended; /* times its prediction was made longer */

    union {
        struct gains gains;
        struct {
            struct rga_work work;
            struct matrix gains;
        } rga;
        struct pairing pairing;
        struct structure_work structure;
        struct {
            struct interact_plant plant;
            struct measure result;
            struct measure_work work;
            struct assignment assignment;
        } second;
        struct {
            struct static_decoupler_work work;
            struct static_decoupler_result result;
        } decoupler;
        struct detune detune;
        struct trial trial;
        /* Not of the analysis: of the trial on the plant that comes after it. */
        struct {
            struct steady rest;
            struct config old; /* what it returns to where it fails */
        } after;
    } work;
};

#endif

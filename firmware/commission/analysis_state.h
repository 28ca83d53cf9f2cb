/* Settings, state and results of an analysis. analysis.c writes it, others read the results;
 * two parts belong to certainty.c and to analysis_structure.c. */
#ifndef REFLUX_COMMISSION_ANALYSIS_STATE_H
#define REFLUX_COMMISSION_ANALYSIS_STATE_H

#include "commission/analysis_choice_state.h"
#include "commission/analysis_structure_state.h"
#include "commission/certainty_state.h"
#include "commission/kept_watch_state.h"
#include "commission/trial_records.h"
#include "design/detune.h"
#include "design/robust.h"
#include "design/static_decoupler.h"
#include "design/trial.h"
#include "exchange/config.h"
#include "identify/steady.h"
#include "interact/gains.h"
#include "interact/measure.h"
#include "interact/pairing.h"
#include "interact/rga.h"
#include "interact/structure.h"

enum analysis_stage {
    ANALYSIS_GAINS,
    ANALYSIS_CASCADES,
    ANALYSIS_PAIRING,
    ANALYSIS_CANDIDATES,
    ANALYSIS_CHOICE,
    ANALYSIS_SECOND,
    ANALYSIS_STRUCTURE,
    ANALYSIS_DECOUPLER,
    ANALYSIS_SETTINGS,
    ANALYSIS_ROBUST,
    ANALYSIS_PREDICTION,
    ANALYSIS_ALTERNATIVE, /* with and without a decoupler: the better of the two */
    ANALYSIS_CROSSOVER,   /* relative gains where the loops act */
    ANALYSIS_PROBES,      /* each loop's setpoint step again, with its gain raised */
    ANALYSIS_DONE
};

struct analysis_config {
    real_t h_s;        /* sample interval of the loops, s */
    real_t confidence; /* least probability of a determined pairing, 0.5 to 1 */
    real_t floor;      /* least relative standard deviation of a gain */
    real_t step;       /* setpoint step of the prediction, fraction of span */
    real_t probe;      /* factor on the gain of a loop that is probed; 0: no loop is */
    uint8_t loops_max; /* number of loops that the board can run */
    bool last; /* there are no more rounds: doubts that only more tests could mend do not count */
    /* Plants that the true one may be: struct robust_config. The context must live as long as the analysis. */
    uint16_t members;
    void (*draw)(const void *context, uint16_t member, uint8_t output,
                 struct interact_plant *plant);
    const void *context;
    /* Noise of every output, fraction of span; NULL: none. It must live as long as the analysis. */
    const real_t *noise_sd;
};

/* Use of the decoupler, or the reason why there is none. */
enum analysis_decoupler {
    DECOUPLER_USED,
    DECOUPLER_NOT_NEEDED,
    DECOUPLER_TOO_MANY, /* loops: more than STATIC_DECOUPLER_LOOPS */
    DECOUPLER_ILL,      /* the inverse would amplify the errors of the gains */
    DECOUPLER_NO_BETTER /* than single loops, by the predictions for both */
};

/* Integrals of |e| of all loops together after a unit step of one, mean over the loops: of a setpoint, s, and of an input, s times
 * spans of outputs over spans of inputs. 0: not predicted. */
struct analysis_figures {
    real_t setpoints, loads;
};

/* Largest sensitivities of the loops, each broken with the others closed: struct robust. */
struct analysis_sensitivity {
    real_t s_nominal, t_nominal, s_worst, t_worst;
    real_t factor; /* by which gains had to be lowered in the end; 1: by none */
};

/* Settings and their predictions. */
struct analysis_design {
    struct loops loops;
    struct analysis_sensitivity sensitivity;
    real_t horizon_s;
    struct trial_loop predicted[INTERACT_MAX];
    struct trial_mark tried[INTERACT_MAX];
    struct matrix d;
};

/* Frequencies between which a loop's gain falls below 1, rad/s. */
struct crossover_search {
    real_t lo, hi;
    uint8_t steps, halves; /* of the way up; of its last step */
    bool between;          /* the way up is over */
};

struct analysis {
    /* Input of the analysis: these three stay, all that follows is cleared when an analysis begins. */
    struct interact_plant plant;
    uint16_t flags[INTERACT_MAX][INTERACT_MAX]; /* of elements: enum identified_flag */
    uint8_t given[INTERACT_MAX]; /* input + 1 that the settings pair with output i; 0: none */
    struct analysis_config config;
    enum analysis_stage stage;

    /* gains */
    real_t singular[INTERACT_MAX], condition, condition_scaled;
    uint8_t rank, rank_exact, n_null;
    real_t null_input[INTERACT_MAX], null_output[INTERACT_MAX]; /* the first null directions */
    real_t weakest[INTERACT_MAX]; /* direction of the inputs that the outputs answer least */
    struct matrix lambda;         /* relative gains; valid where `has_lambda` */
    bool has_lambda;

    /* pairing */
    enum pairing_verdict verdict;
    struct pairs pairs;
    real_t pair_lambda[INTERACT_MAX], niederlinski, probability;
    real_t share[INTERACT_MAX];
    uint8_t rival[INTERACT_MAX];
    real_t determinant; /* in its own standard deviations */
    real_t channels;    /* share of draws that keep the same channels */
    uint16_t negative;  /* pairs that are unstable without the others: struct candidate */
    real_t negative_index;
    struct pairing_choice choice;
    struct certainty certainty;
    struct plant_layout layout;

    /* design; only of a determined pairing */
    bool designed;         /* the settings below are valid */
    enum err design_error; /* the reason why they are not */
    enum analysis_decoupler decoupler;
    struct matrix d; /* identity where there is none */
    struct loops loops;
    struct analysis_sensitivity sensitivity;
    uint16_t left_out; /* plant drawn that is left out of the search, plus 1; 0: none */
    /* Loop k by itself: where its gain is 1, rad/s, and the magnitude of its relative gain there; 0: there is none. */
    real_t crossover[INTERACT_MAX], crossover_lambda[INTERACT_MAX];
    /* Loop k after its own setpoint step of config.step */
    struct trial_loop predicted[INTERACT_MAX];
    struct trial_mark tried[INTERACT_MAX]; /* the same after horizon_s */
    real_t horizon_s; /* five times the slowest loop's integral time and dead time */
    /* With the decoupler, and without, where there was a choice. */
    struct analysis_figures figures[2];
    struct analysis_design decoupled; /* kept while the design without decoupler is made */
    bool has_decoupled, compares;
    bool load; /* the prediction steps the load, not the setpoint */
    bool bounded;
    struct trial_probe probe[INTERACT_MAX];
    uint8_t turn;     /* loop under prediction */
    uint8_t extended; /* how often its prediction was made longer */

    union {
        struct gains gains;
        struct {
            struct rga_work work;
            struct matrix gains, lambda;
        } rga;
        struct pairing pairing;
        struct candidates candidates;
        struct structure_work structure;
        struct {
            real_t gain[INTERACT_MAX]
                       [INTERACT_MAX]; /* of the plant, while small ones are left out */
            struct measure result;
            struct measure_work work;
            struct assignment assignment;
        } second;
        struct {
            struct static_decoupler_work work;
            struct static_decoupler_result result;
        } decoupler;
        struct detune detune;
        struct robust robust;
        struct trial trial;
        struct {
            struct rga_pair_work pair;
            struct crossover_search search;
        } crossover;
        /* For the trial on the plant after the analysis. */
        struct {
            struct steady rest;
            struct config old; /* settings before the trial */
            struct kept_watch watch;
        } after;
    } work;
};

#endif

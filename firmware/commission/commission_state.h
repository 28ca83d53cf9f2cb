/* What automatic start-up (commission.h) keeps, finds and is told. */
#ifndef REFLUX_COMMISSION_COMMISSION_STATE_H
#define REFLUX_COMMISSION_COMMISSION_STATE_H

#include "base/job.h"
#include "base/workspace.h"
#include "commission/adoption.h"
#include "commission/analysis_state.h"
#include "commission/by_relay_state.h"
#include "commission/experiment_state.h"
#include "identify/fopdt_fit.h"
#include "supervise/supervisor.h"

#define TEST_LIMIT_DEFAULT REAL_C(0.2) /* of span, where test_limit is 0 */

enum commission_phase {
    COMMISSION_IDLE,
    COMMISSION_TESTING,
    COMMISSION_RELAY, /* one loop, by a relay test: by_relay.h */
    COMMISSION_FITTING,
    COMMISSION_ANALYSING,
    COMMISSION_PAUSED,
    COMMISSION_READY, /* analysed: a proposal, or the reason why there is none */
    COMMISSION_TRIAL, /* the accepted set is in force and on trial */
    COMMISSION_KEPT,
    COMMISSION_RETURNED, /* the old set is, or is about to be, back in force */
    COMMISSION_ENDED     /* before its end: `reason` */
};

/* Why it ended, or the trial failed. Words: commission_why_text(). */
enum commission_reason {
    REASON_NOT,
    REASON_ASKED, /* the operator */
    REASON_SAFE,  /* safe state */
    REASON_LOST,  /* measurement not valid */
    REASON_INTERLOCK,
    REASON_ACTUATOR, /* does not follow */
    REASON_HAND,     /* output moved, or loop put into automatic */
    REASON_CONFIG,   /* another configuration */
    REASON_RESTLESS,
    REASON_LIMIT,
    REASON_AWAY,
    REASON_INTEGRATES,
    REASON_NO_INPUT, /* every input was skipped */
    REASON_NUMBERS,  /* refused by the analysis: a fault of ours */
    REASON_SAMPLES,  /* more samples missing than a test can do without */
    REASON_RESET,    /* of the board */
    REASON_TRIAL_LIMIT,
    REASON_TRIAL_SLOW, /* integral of the error beyond what was predicted */
    REASON_TRIAL_PEAK, /* overshoot beyond what was predicted */
    REASON_TRIAL_REST, /* does not come to rest */
    REASON_SEQUENCE,
    REASON_NO_ANSWER, /* to a relay */
    REASON_NO_CYCLE,
    REASON_TRIAL_ROOM,   /* an output stood at its limit */
    REASON_LEFT,         /* farther from the operating point than its drift explains */
    REASON_SPAN,         /* reads an end of its span */
    REASON_REVERSAL,     /* no double step is small enough */
    REASON_TOO_SLOW,     /* for test.longest */
    REASON_TRIAL_SWINGS, /* an oscillation that does not decay */
    REASON_EXCITED,      /* a block excites the plant */
    REASON_ACTION,       /* of the loop under a relay: the wrong one */
    REASON_COUNT
};

enum commission_ask {
    COMMISSION_ASK_NONE,
    COMMISSION_ASK_BEGIN,
    COMMISSION_ASK_RELAY, /* of loop `relay_asked` */
    COMMISSION_ASK_PAUSE,
    COMMISSION_ASK_RESUME,
    COMMISSION_ASK_SKIP,
    COMMISSION_ASK_REPEAT,
    COMMISSION_ASK_ABORT,
    COMMISSION_ASK_TRIAL, /* the plan with the proposal is on its way: serial `trial_serial` */
    COMMISSION_ASK_REJECT
};

#define ASYMMETRY_UNIT REAL_C(1000.0)

/* One way from an input to an output, all rounds together. */
struct element {
    struct identified fit; /* least squares, weighted over the rounds; used */
    struct fopdt moments;  /* of the last round: a second opinion */
    uint16_t moments_flags;
    int16_t
        asymmetry; /* gain up less gain down, in ASYMMETRY_UNITs of their mean, last round; 0: none that is sure */
    /* How the response begins, where it is not that of one lag; last such round; slope 0: none. The slope of the response
     * to a step of 1, 1/s, magnitude, and its dead time with one standard deviation. */
    real_t early_slope, early_dead_s;
    real_t plateau_gain; /* of the last round; 0: none */
    real_t misfit; /* standard deviation of the gain by what is not noise, weighted likewise */
};

struct tested_input {
    uint8_t output;   /* index of the manipulated variable in the configuration */
    real_t test_base; /* fraction of span, before the tests */
    real_t amplitude; /* of the last test */
    real_t half_s;
    uint8_t rounds; /* tests that count */
    uint8_t
        longer; /* tests done again, with longer halves, because an output had not come to rest */
    uint32_t half_wanted;    /* samples: least half of the next test, 0 = no wish */
    real_t amplitude_wanted; /* fraction of span: the next test begins with it, 0 = no wish */
    real_t amplitude_most; /* fraction of span: the next test makes no larger step, 0 = no bound */
    uint8_t smaller; /* tests done again, with smaller steps, because an output is not linear */
    uint8_t gentler; /* ... because the guard has cut them */
    bool skipped, cut, small;
    bool
        unsettled; /* the latest analysis wants a longer test: a response was not seen to its end */
    uint8_t cut_by;       /* index in measurement[] */
    real_t cut_predicted; /* fraction of span */
    real_t worst;         /* largest share of a limit reached */
};

/* What is being worked out. */
enum model_job { JOB_LOOK, JOB_FIT, JOB_ANALYSE };

struct commission_work;

struct commission {
    struct event_queue *events;
    struct job job;
    struct workspace *workspace;
    struct commission_work *work; /* its memory */
    bool lost;                    /* ... was another's since, and what is there now is nothing */
    bool unseen;                  /* nobody has looked at what was found */
    enum commission_phase phase;
    enum commission_reason reason;
    char subject[CHANNEL_NAME_SIZE]; /* what `reason` is about */
    real_t value;                    /* ... and its number, fraction of span */
    volatile uint8_t ask; /* enum commission_ask; the main loop writes it under hal_tick_lock */
    volatile uint8_t relay_asked;   /* loop; likewise */
    volatile uint32_t relay_serial; /* ... of this plan */

    volatile bool analysed; /* work.analysis holds a result */
    uint32_t plan_serial;   /* the tests belong to this plan */
    uint32_t channels;      /* ... to these channels and spans: commission_channels() */
    uint32_t safe_count;    /* ... and to the time since the safe state was last taken */
    uint8_t outputs, inputs;
    uint8_t measurement[CHANNEL_MAX]; /* configuration index of test channel */
    struct tested_input input[CHANNEL_MAX];
    uint8_t order[CHANNEL_MAX];            /* inputs in the order of their tests */
    uint8_t column[CHANNEL_MAX];           /* input of the analysis -> index in input[] */
    uint8_t at;                            /* in order[] */
    uint8_t round;                         /* from 1 */
    bool only_unsettled;                   /* this round is for inputs that want longer tests */
    uint16_t tests;                        /* that are over, those made again as well */
    real_t tested_s;                       /* ... and took so long together, with their rests */
    uint64_t began_ms, ended_ms, phase_ms; /* plant time */
    uint64_t sample_ms;                    /* ... of the last sample a test has seen */
    uint32_t half_least;                   /* samples: from the inputs before */
    struct origin origin;                  /* from before the first test to the end of the trial */
    /* Bit j: measurement[j] reads an end of its span; and did so in the sample before, too. */
    uint32_t at_end, at_end_again;
    real_t noise_sd[CHANNEL_MAX];

    /* The background's part; its while the job is asked for and not done. */
    volatile uint8_t doing; /* enum model_job */
    enum err job_error;
    struct identified fitted[CHANNEL_MAX]; /* of the latest test, by output */
    real_t misfit[CHANNEL_MAX];            /* ... and of its gain, by what is not noise */
    real_t climbs[CHANNEL_MAX];            /* ... and how it went on climbing: test_verdict.h */
    uint8_t fit_at;                        /* output under work */
    bool fit_running, fit_bent, analysis_begun;
    real_t fit_squares, fit_misfit, fit_share; /* of the fit without a bend: its residual */
    struct analysis_config settings;           /* of the analysis */
    struct by_relay by_relay;

    struct adoption adoption;
    uint32_t trial_serial;
    volatile bool wants_old; /* the main loop is to put commission_old() into force */
};

/* In the workspace, leased from the beginning until the proposal is kept, rolled back or rejected. What is left stays readable
 * until the workspace is leased for something else: commission_keeps(). Then the trial's figures are still there, in
 * struct commission, and how it ended. */
#define COMMISSION_HOLDER "start-up"

struct commission_work {
    struct element element[CHANNEL_MAX][CHANNEL_MAX]; /* [measurement][input] */
    union {
        struct {
            struct experiment experiment;
        } test;
        struct relay_test relay;
        struct analysis analysis;
    };
};

/* The settings before the trial, from accepting on. */
static inline struct config *commission_old(struct commission *c)
{
    return &c->work->analysis.work.after.old;
}

#endif

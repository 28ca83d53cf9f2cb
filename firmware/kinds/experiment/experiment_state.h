/* The state of a block of the kind `experiment`, for the files that make up the kind. */
#ifndef REFLUX_EXPERIMENT_PLANT_EXPERIMENT_BLOCK_H
#define REFLUX_EXPERIMENT_PLANT_EXPERIMENT_BLOCK_H

#include "kinds/experiment/plant_experiment.h"

#if CONFIG_EXPERIMENT

#include "block/polynomial_settings.h"
#include "block/rst_settings.h"
#include "identify/decimate.h"
#include "identify/prbs.h"
#include "identify/rls.h"
#include "kinds/experiment/plant_model.h"
#include "kinds/state_law/state_law_job.h"

/* In the order in which they come; the value of `stage`. */
enum experiment_stage {
    EXPERIMENT_IDLE,
    EXPERIMENT_ASKED,   /* for the workspace */
    EXPERIMENT_SETTLES, /* nothing moves; the operating point */
    EXPERIMENT_EXCITES,
    EXPERIMENT_COMPUTES,
    EXPERIMENT_DONE,
    EXPERIMENT_ABORTED
};

/* Why it was aborted; the value of `reason`. Those of the test signal come behind, in the order of enum excite_reason. */
enum experiment_reason {
    REASON_NONE,
    REASON_STOPPED,
    REASON_BAND,        /* a measurement has left it */
    REASON_MEASUREMENT, /* missing */
    REASON_UNSTEADY,    /* before anything moved */
    REASON_WORKSPACE,
    REASON_SETTINGS,
    REASON_PLANT, /* was away */
    REASON_EXCITE = 10
};

/* What became of the model. Verdicts of its outputs: enum plant_verdict; this comes behind them. */
#define VERDICT_LOOPS 10 /* loops have moved the MVs */

enum experiment_law_stage {
    EXPERIMENT_LAW_NONE,
    EXPERIMENT_LAW_ASKED, /* for the workspace */
    EXPERIMENT_LAW_WORKS,
    EXPERIMENT_LAW_DONE,
    EXPERIMENT_LAW_REFUSED
};

/* Of an MV about its operating point, sums of squares over the samples. */
struct experiment_sum {
    real_t all, others; /* others: what the signal has not made */
};

/* A decoupler and controllers for it, as their blocks have them. */
struct experiment_loops {
    float g[EXPERIMENT_KEPT * EXPERIMENT_KEPT][POLYNOMIAL_TAPS];
    float rst[EXPERIMENT_KEPT][3][RST_COEFFICIENTS]; /* p, q, r */
    float period_s;
    uint8_t limits; /* enum polynomial_limits */
    uint8_t part;   /* controllers that were proposed */
    uint8_t left;   /* values of the decoupler that differed when it was proposed */
};

struct experiment {
    struct experiment_settings s;
    struct block_signal input[2 * EXPERIMENT_MOST];
    uint8_t n, stage, reason, at_fault; /* at_fault: which input of the block, from 1 on */
    uint8_t verdict;
    bool asked_signal; /* in the last step */
    uint16_t ticks;    /* of a sample */
    uint16_t pieces;   /* of work until the next step */
    uint16_t piece_most;
    uint32_t samples, wanted; /* of the record, or while it settles */
    uint32_t settled;         /* ticks */
    uint32_t lease;
    struct experiment_job *job; /* in the workspace, while leased */
    real_t interval_s;
    /* The measurements. */
    struct decimator filter[EXPERIMENT_MOST];
    real_t held[EXPERIMENT_MOST];  /* last good reading, fraction */
    real_t level[EXPERIMENT_MOST]; /* operating point, and while it settles the sum */
    real_t lowest[EXPERIMENT_MOST], highest[EXPERIMENT_MOST];
    uint32_t gap[EXPERIMENT_MOST],
        gaps[EXPERIMENT_MOST];    /* ticks without a good reading: in a row, all */
    uint8_t out[EXPERIMENT_MOST]; /* readings in a row outside the band */
    /* The MVs. */
    struct prbs prbs;
    real_t signal[EXPERIMENT_MOST]; /* of this sample, fraction */
    real_t rest[EXPERIMENT_MOST];   /* operating point, and while it settles the sum */
    real_t least[EXPERIMENT_MOST], most[EXPERIMENT_MOST]; /* while it settles */
    real_t applied[EXPERIMENT_MOST];                      /* sum over the sample */
    struct experiment_sum sum[EXPERIMENT_MOST];
    /* What was found, EU. */
    struct experiment_found {
        uint8_t na, nb, verdict;
        float one_step, fit, apart; /* % */
    } found[EXPERIMENT_MOST];
    float live_error[EXPERIMENT_MOST]; /* % of the measurement's span */
    uint8_t proposed;                  /* what it was when it proposed */
    bool proposes, waits;
    uint8_t tells; /* enum experiment_event + 1, in the next step */
    float step_s;  /* of the block */
    struct experiment_law {
        const struct state_law_settings *to;         /* of the block that keeps it; NULL: none */
        const struct polynomial_settings *decoupler; /* of that block, in its place; NULL: none */
        uint8_t goal[offsetof(struct state_law_settings, si)]; /* of it when the job began */
        uint8_t stage;
        bool proposes, waits;
        uint32_t lease;
        void *job; /* in the workspace, while leased: struct state_law_job, or that of loops */
        struct state_law_found found;
        struct experiment_loops loops;
        char words[STATE_LAW_WORDS];
    } law;
    float model[]; /* [n][A], then [n][n][B] */
};

/* What is in the workspace; behind it the record, y then u, and the recursive estimators. */
struct experiment_job {
    struct plant_finding finding;
    struct arx_orders live;
    struct arx_history history[EXPERIMENT_MOST];
    real_t *y, *u;
    struct rls *rls[EXPERIMENT_MOST];
    bool begun, over; /* the work's own */
};

static inline float *experiment_a(struct experiment *e, unsigned i)
{
    return &e->model[(size_t)i * DIFFERENCE_A_MOST];
}

static inline float *experiment_b(struct experiment *e, unsigned i, unsigned j)
{
    return &e->model[(size_t)e->n * DIFFERENCE_A_MOST + ((size_t)i * e->n + j) * DIFFERENCE_B_MOST];
}

static inline bool experiment_runs(const struct experiment *e)
{
    return e->stage >= EXPERIMENT_ASKED && e->stage <= EXPERIMENT_COMPUTES;
}

/* Ends it; what it moved returns, since it asks no more. */
void experiment_abort(struct experiment *e, enum experiment_reason reason);

enum experiment_event {
    EVENT_MODEL,
    EVENT_NO_MODEL,
    EVENT_ABORTED,
    EVENT_LAW,
    EVENT_NO_LAW,
    EXPERIMENT_EVENTS
};

/* ---- settings (plant_experiment_settings.c) ---- */

#define EXPERIMENT_PARAMETERS                                                                      \
    (21 + EXPERIMENT_KEPT * (DIFFERENCE_A_MOST + EXPERIMENT_KEPT * DIFFERENCE_B_MOST))
extern const struct block_parameter experiment_parameter_rows[EXPERIMENT_PARAMETERS];
#define EXPERIMENT_ID_KNOWN 16
#define EXPERIMENT_ID_A     20 /* by outputs */
#define EXPERIMENT_ID_B     30 /* by outputs and inputs */

MUST_CHECK enum err experiment_check(const struct block_setup *setup, struct block_fault *fault);
uint32_t experiment_ticks(const struct block_setup *setup);
/* Samples of the record. */
uint32_t experiment_samples(const struct experiment_settings *s);
/* Bytes of the workspace. */
uint32_t experiment_job_bytes(unsigned n, uint32_t samples);

/* ---- the record (plant_experiment_record.c) ---- */

/* The workspace as experiment_job_bytes has it; nothing in it yet. */
void experiment_record_begin(struct experiment *e, struct experiment_job *job);
/* A tick of settling; true when it is over. */
bool experiment_settle(struct experiment *e, const struct block_io *io);
/* A tick of the experiment; true when the record is whole. */
bool experiment_record(struct experiment *e, const struct block_io *io);
/* Readings of a tick. Returns why it must end, at_fault set, or REASON_NONE. */
enum experiment_reason experiment_read(struct experiment *e, const struct block_io *io);
void experiment_ask_signal(struct experiment *e, struct block_io *io);
/* Part of the movement of MV j that the signal has not made. */
real_t experiment_others(const struct experiment *e, unsigned j);
/* Gain at rest of the recursive estimate, EU per EU. */
float experiment_live_gain(const struct experiment *e, unsigned i, unsigned j);

/* ---- the model (plant_experiment_job.c) ---- */

bool experiment_work(void *state);
void experiment_end_lease(struct experiment *e);
/* What was found, out of the workspace. */
void experiment_take_model(struct experiment *e);

/* ---- the law (plant_experiment_law.c) ---- */

bool experiment_law_runs(const struct experiment *e);
/* NULL, or why not, in a word. */
const char *experiment_law_begin(struct experiment *e);
void experiment_law_stop(struct experiment *e, const char *field, const char *wanted);
bool experiment_law_work(struct experiment *e);
void experiment_law_step(struct experiment *e, struct block_io *io);

/* ---- decoupler and controllers (plant_experiment_loops.c) ---- */

extern const uint32_t experiment_loops_bytes; /* of law.job */
void experiment_loops_begin(struct experiment *e);
/* The next design. */
void experiment_loops_piece(struct experiment *e);
/* All of it is there, or it is refused. */
bool experiment_loops_are_found(const struct experiment *e);
/* To law.loops and law.found. */
void experiment_loops_take(struct experiment *e);
void experiment_loops_propose(struct experiment *e, struct block_proposal *room);

/* ---- proposals (plant_experiment_proposals.c) ---- */

void experiment_propose(struct experiment *e);
void experiment_proposals_step(struct experiment *e, struct block_proposal *room);

const char *experiment_describe(const void *state, size_t i, float *value);

#endif
#endif

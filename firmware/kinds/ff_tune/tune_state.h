/* The state of a block of the kind `ff_tune`, for the files that make up the kind. */
#ifndef REFLUX_FF_TUNE_FEEDFORWARD_TUNE_BLOCK_H
#define REFLUX_FF_TUNE_FEEDFORWARD_TUNE_BLOCK_H

#include "kinds/ff_tune/feedforward_tune.h"

#if CONFIG_FEEDFORWARD_TUNE

#include "design/response_fit.h"
#include "identify/disturbance_ratio.h"
#include "kinds/ff_tune/feedforward_search.h"
#include "kinds/ff_tune/loop_shadow.h"
#include "signal/washout.h"

/* The value of `stage`. */
enum tune_stage {
    TUNE_IDLE,
    TUNE_SILENCES,    /* waits until the feedforward is off */
    TUNE_LOOP,        /* identifies the loop: B, C, D */
    TUNE_DISTURBANCE, /* identifies the disturbance; A: both */
    TUNE_COMPUTES,
    TUNE_TESTS, /* the candidate on fresh data, in the shadow */
    TUNE_PROPOSES,
    TUNE_RUNS /* watches; with `every` it goes on learning */
};

/* Why it does not tune, or what became of it; the value of `verdict`. */
enum tune_verdict {
    TUNE_NONE,
    TUNE_ADOPTED,
    TUNE_STILL,      /* the disturbance does not move */
    TUNE_LOOP_STILL, /* nothing moves the loop: no test signal, no setpoints */
    TUNE_SLOW,       /* the responses have not settled in twice the time */
    TUNE_NO_BAND,    /* no frequency at which it could help */
    TUNE_UNSURE,     /* the ratio is not known well enough in the band */
    TUNE_NO_MODEL,   /* no first-order model, or its loop is unstable */
    TUNE_NO_BETTER,  /* on fresh data it would not do better */
    TUNE_UNTESTED,   /* too little came to test it with */
    TUNE_REJECTED,   /* the proposal */
    TUNE_WORSE,      /* the loop was worse than it would have been without; it was switched off */
    TUNE_STOPPED,
    TUNE_SIGNAL /* the test signal: reason behind, in the order of enum excite_reason */
};

enum tune_event {
    TUNE_SAYS_ADOPTED,
    TUNE_SAYS_NOT,
    TUNE_SAYS_WORSE,
    TUNE_SAYS_CHANGED,
    TUNE_SAYS_STILL,
    TUNE_SAYS_SENSOR,
    TUNE_SAYS_WEAK,
    TUNE_EVENTS
};

#define TUNE_PARTS 8u /* of a test */

/* Signals of a sample, high-passed, in the order of the filters. */
enum tune_signal { SIGNAL_Y, SIGNAL_R, SIGNAL_D, SIGNAL_U, SIGNAL_ADDED, TUNE_SIGNALS };

/* What a response was when last looked at, at each point of the grid. */
struct tune_responses {
    struct high_order_point at[FEEDFORWARD_POINTS];
};

/* The work between ticks. */
enum tune_work { WORK_NONE, WORK_RESPONSES, WORK_RATIO, WORK_PROCESS, WORK_PATH, WORK_SEARCH };

/* A first-order model, and how far off it is. */
struct tune_model {
    struct fopdt is;
    real_t off; /* r.m.s. of the distance to the response, over its size */
};

/* What the rules say, from first-order models of both paths. */
struct tune_rule {
    bool there;
    uint8_t which; /* of the nine cases: 10, 20, 30 for I, II, III, and 1, 2, 3 for a, b, c */
    struct tune_model path;
    struct feedforward_shape shape;
    real_t j;
};

struct tune {
    struct tune_settings s;
    struct block_signal y_signal, d_signal;
    bool d_is_mv;
    real_t h_s, tick_s; /* of a sample, of a step */
    uint16_t ticks, piece_most, pieces;
    uint8_t stage, verdict, tells, told_verdict;
    uint8_t tried;        /* times it was switched off */
    uint8_t changes;      /* times in a row that it was identified anew for doing too little */
    uint32_t sensor_away; /* steps */
    float worse_by, changed_to; /* what `worse` and `changed` tell, % */
    bool running;               /* the element has a gain */
    bool asked_signal, let_pass;
    uint8_t asks; /* bit 0: for the setpoint, bit 1: for the disturbance */

    /* Of a sample that is under way. */
    struct {
        real_t y, r, d, u, added;
        uint16_t ticks;
        bool good;
    } sum;
    struct {
        num_t y, r, d, u_fb;
        bool there, good;
    } last; /* of the step before, whose u is known now */
    num_t held_y, held_d;
    struct washout high_pass[TUNE_SIGNALS];
    num_t now[TUNE_SIGNALS];        /* after it */
    real_t smooth[TUNE_SIGNALS][2]; /* two lags behind it, for the models alone */
    bool begun;                     /* the filters are at a first sample */
    bool is_good;                   /* this sample */
    real_t last_mean_d;
    real_t last_r;           /* not filtered */
    uint16_t setpoint_rests; /* samples since the setpoint moved */
    uint16_t d_rests;        /* since the disturbance moved much */
    uint16_t bad_rests;      /* since a reading was missing */
    uint32_t stage_samples;  /* since the stage began */
    uint32_t signal_samples; /* of the test signal */
    uint32_t since_look;
    uint32_t since_tuned; /* while it runs */

    /* Learning. */
    struct high_order_shape shape[2]; /* of the loop, of the disturbance; A: the second */
    uint8_t settled_looks;
    real_t change;      /* of the response looked at last, in the band */
    real_t move_square; /* mean squares, of d and of what moves the loop */
    real_t loop_square;
    uint32_t squared; /* samples in them */
    bool learns;
    real_t d_square;  /* mean square of the disturbance of late, in any stage */
    real_t d_most;    /* the largest there was in the last hours */
    real_t d_learnt;  /* the one that the element in force was learnt from; 0: none was */
    real_t d_noise;   /* mean square of a reading of the disturbance when it rested last */
    uint32_t d_still; /* samples since the disturbance moved last; 0: it moves */
    bool d_moved;     /* it has in this stage */
    bool by_itself;   /* nobody has asked for what is identified */

    /* On the grid. */
    uint8_t points, band_from, band_to; /* band_to: behind the last */
    uint8_t work, work_at;              /* enum tune_work: the work's own while it is wanted */
    bool computing;                     /* asked for, and its result not taken */
    bool free;          /* the work is not under way: what it looks at may be begun anew */
    bool anew;          /* the model is to be */
    bool reading;       /* it may look at the estimator: nothing is learnt */
    bool look_only;     /* the responses, and no more */
    real_t moved, size; /* of the response that is looked at, weighted sums */
    uint8_t outcome;    /* of the work: enum tune_verdict, TUNE_NONE: a candidate */
    bool has_loop;      /* the loop's responses are there */
    real_t omega[FEEDFORWARD_POINTS];
    struct tune_responses loop, disturbance, ratio;
    struct high_order_point process[FEEDFORWARD_POINTS];
    struct feedforward_wanted wanted;
    struct feedforward_search search;
    struct tune_model model, found; /* that the shadows use; that the work has found */
    struct response_fit fit;
    struct tune_rule rule;
    bool fitting; /* a fit is under way */
    bool unsure;  /* the ratio is in too much doubt for a search */
    bool by_rule; /* the candidate is the rule's */
    bool has_model;
    real_t spread; /* weighted, over the ratio's size */
    struct feedforward_shape candidate;

    /* Shadows: what the loop did because of the feedforward, and would do because of the candidate. */
    struct loop_shadow without, with;
    real_t integral;              /* of the loop's controller, from the filtered signals */
    real_t lead_lag, last_d;      /* of the candidate */
    real_t delayed[SHADOW_REACH]; /* d, newest first */
    uint16_t warm, test_warm;     /* samples since they began */
    struct tune_errors {
        real_t now, without,
            then;   /* of this sample: as it is, without feedforward, with the candidate */
        bool count; /* they are whole, and no setpoint is under way */
    } errors;
    /* The test. */
    uint8_t parts, better_parts;
    uint32_t part_samples, part_at;
    real_t part_now, part_then, part_without, all_now, all_then, all_without, part_d;
    real_t all_d;    /* squares of the disturbance in it */
    real_t promised; /* what was tested: 1 - candidate/without, of squares */
    real_t tested;   /* mean square of the error under feedback alone, as it was then */
    real_t alone;    /* the same over that of the disturbance */
    /* While it runs: decaying sums of squares. */
    real_t watch_with, watch_without, watch_d, watch_weight;
    bool as_alone;         /* the loop is no better than it was under feedback alone */
    uint32_t worse_for;    /* samples in a row in which it is worse than without */
    uint32_t since_change; /* samples in which it does less than half of what was promised */

    uint32_t calls; /* steps that a proposal has waited */
    bool handed;    /* the proposal */
    bool again;     /* it is to identify anew once the feedforward is off */
    bool silencing; /* it proposes a gain of 0 */
    bool off_waits; /* it has, and that has not been decided on */
    /* The estimator: of the stage. */
    _Alignas(8) char memory[];
};

static inline struct high_order *tune_model(struct tune *t)
{
    return (struct high_order *)(void *)t->memory;
}

static inline uint32_t tune_samples(const struct tune *t, float seconds)
{
    float n = seconds / (float)t->h_s;
    return n < 1 ? 1u : n > 1e8f ? 100000000u : (uint32_t)n;
}

/* B, C, D have a stage for the loop. */
static inline bool tune_is_staged(const struct tune *t)
{
    return t->s.method != TUNE_JOINT;
}

/* Of a response: beyond what it is in doubt by. */
static inline bool tune_is_known(const struct tune *t, const struct high_order_point *p)
{
    return t->s.doubt * p->sd < cplx_abs(p->is);
}

/* Dead time that a shadow can have, s. */
static inline real_t tune_dead_reach(const struct tune *t)
{
    return t->h_s * (real_t)(SHADOW_REACH - 2u);
}

/* ---- settings (feedforward_tune_settings.c) ---- */

#define TUNE_PARAMETERS 42
extern const struct block_parameter tune_parameter_rows[TUNE_PARAMETERS];
#define TUNE_ID_BLOCK 38
#define TUNE_ID_K     60 /* k, lead, lag, dead */

MUST_CHECK enum err tune_check(const struct block_setup *setup, struct block_fault *fault);
uint32_t tune_ticks(const struct block_setup *setup);
/* [0]: of the loop, nothing for A; [1]: of the disturbance. */
void tune_shapes(const struct tune_settings *s, struct high_order_shape shape[2]);
uint32_t tune_model_bytes(const struct tune_settings *s);
struct high_order_settings tune_rules(const struct tune_settings *s);

/* ---- samples (feedforward_tune_samples.c) ---- */

void tune_samples_begin(struct tune *t);
/* A step; true when a sample is whole, which is in t->now then. */
bool tune_take(struct tune *t, const struct block_io *io);
/* The estimator begins with the model of the present stage. */
void tune_learn_anew(struct tune *t);
void tune_learn(struct tune *t);
void tune_ask_signal(struct tune *t, struct block_io *io);
/* Finds whether the disturbance moves. Called once for each sample. */
void tune_look_at_disturbance(struct tune *t);
/* It rests, and what the stage is there for needs it to move: nothing is learnt, and no test signal moves the plant. */
bool tune_waits(const struct tune *t);

/* ---- work (feedforward_tune_work.c) ---- */

bool tune_work(void *state);
/* The grid: from the band that is set, or wide. */
void tune_make_grid(struct tune *t);
void tune_ask_look(struct tune *t, bool look_only);

/* ---- models and rules (feedforward_tune_models.c) ---- */

#define TUNE_POINTS_LEAST 3u
/* A piece each: of the model of the process, TUNE_NO_MODEL where there is none; then of that of the disturbance's path, and the rule.
 * *more: another is to follow. */
enum tune_verdict tune_process_piece(struct tune *t, bool *more);
void tune_path_piece(struct tune *t, bool *more);
/* The rule is to be tried in place of what is not good enough. */
bool tune_falls_back(const struct tune *t);
void tune_take_rule(struct tune *t);

/* ---- test and watch (feedforward_tune_watch.c) ---- */

void tune_shadows_begin(struct tune *t);
/* Of this sample; then the test or the watch may look at it. */
void tune_shadows_step(struct tune *t);
void tune_test_begin(struct tune *t);
/* TUNE_NONE: it goes on; TUNE_ADOPTED: it has passed. */
enum tune_verdict tune_test_step(struct tune *t);
void tune_watch_begin(struct tune *t);
/* TUNE_WORSE: switch it off. */
enum tune_verdict tune_watch_step(struct tune *t);
/* What the feedforward has made of the loop's squares, %, while it runs; 0 before. */
float tune_improvement(const struct tune *t);

/* ---- stages (feedforward_tune_stages.c) ---- */

void tune_stage_begins(struct tune *t, enum tune_stage stage);
/* A stage that learns, from the next sample on for which the work is over. */
void tune_learn_stage(struct tune *t, enum tune_stage stage);
/* The first stage that learns, or the wait for a silent feedforward before it. */
void tune_begin(struct tune *t);
/* Nothing more comes of it. An element that acts is watched on. */
void tune_end_with(struct tune *t, enum tune_verdict verdict);
/* Returns the `step` that the last identification lacked, EU; 0: its test signal was large enough, or not the reason. */
float tune_step_wanted(const struct tune *t);
/* A mean square so small that nothing moves. */
bool tune_stands_still(real_t square);
/* In every step; the second where a sample is whole. */
void tune_work_on(struct tune *t, struct block_io *io);
void tune_on_sample(struct tune *t);

/* ---- proposals (feedforward_tune_proposals.c) ---- */

void tune_propose_on(struct tune *t, struct block_io *io);

const char *tune_describe(const void *state, size_t i, float *value);

#endif
#endif

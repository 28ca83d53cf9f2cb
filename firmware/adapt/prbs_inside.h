/* What the files of the kind `experiment` share. */
#ifndef REFLUX_ADAPT_PRBS_INSIDE_H
#define REFLUX_ADAPT_PRBS_INSIDE_H

#include "adapt/prbs_experiment.h"

#if CONFIG_BLOCKS

#include "identify/arx_fit.h"
#include "identify/arx_select.h"
#include "identify/decimate.h"
#include "identify/prbs.h"
#include "identify/rls.h"

#define CHANNELS DIFFERENCE_MOST

/* How far it is. */
enum experiment_stage {
    EXPERIMENT_IDLE,
    EXPERIMENT_BEGINS, /* asks for the workspace */
    EXPERIMENT_RESTS,  /* where the plant is, and its noise */
    EXPERIMENT_MOVES,
    EXPERIMENT_FINDS, /* the model */
    EXPERIMENT_PROPOSES,
    EXPERIMENT_DONE, /* with a model */
    EXPERIMENT_ENDED /* without one */
};

/* Why it has ended without a model. */
enum experiment_end {
    END_NOTHING,
    END_BY_HAND,     /* `stop` */
    END_REACH,       /* a measurement left its range */
    END_MEASUREMENT, /* one is lost */
    END_MV,          /* one may not be moved any more: excite_reason */
    END_WORKSPACE,   /* somebody else has it */
    END_AWAY,        /* the plant was away, or settings have changed */
    END_DOUBT /* there is a record, but no model that could be relied on: enum experiment_doubt */
};

/* What is wrong with a model. */
enum experiment_doubt {
    DOUBT_NONE,
    DOUBT_STILL,      /* the record does not tell parameters apart */
    DOUBT_UNSTABLE,   /* the noise leaves only unstable ones, or an output integrates */
    DOUBT_UNEXPLAINED /* it explains less than fit_least of what an output did */
};

enum experiment_phase {
    PHASE_ORDERS,
    PHASE_TWO_THIRDS,
    PHASE_LAST_THIRD,
    PHASE_WHOLE,
    PHASE_AGAIN, /* two thirds, where the whole has no model */
    PHASE_OVER
};

/* What became of an output. */
struct experiment_found {
    uint8_t doubt; /* enum experiment_doubt */
    uint8_t na;
    uint8_t first[CHANNELS], last[CHANNELS];
    float
        fit; /* part of its movement that the model explains from the MVs alone, on the last third */
    float step; /* the same one sample ahead */
};

/* In the workspace. The numbers behind it: u and y of every sample, then the recursive estimators. */
struct experiment_work {
    struct arx_data data;
    struct arx_search search;
    struct arx_selecting selecting;
    struct arx_fitting fitting;
    struct arx_judging judging;
    struct arx_orders orders, all;
    /* By na: the trial with the best criterion, and how its model does on the last third. */
    uint16_t trial[DIFFERENCE_A_MOST + 1];
    struct arx_judgement did[DIFFERENCE_A_MOST + 1];
    bool stands[DIFFERENCE_A_MOST + 1]; /* there is such a model */
    bool unstable;                      /* one of them was */
    uint8_t candidate;                  /* na that is looked at */
    struct arx_fit fit[CHANNELS];
    struct experiment_found found[CHANNELS];
    struct arx_history history[CHANNELS]; /* of the recursive estimators */
    uint8_t output, phase;                /* enum experiment_phase */
    real_t numbers[];
};

struct experiment_block {
    struct experiment_settings s;
    uint8_t outputs, mvs;
    uint8_t stage, end,
        detail; /* enums experiment_stage, experiment_end; excite_reason, doubt, output */
    bool wants_start, wants_stop, anew;
    uint16_t ratio; /* base ticks of a sample */
    float interval_s;
    uint32_t samples, at; /* of the record; taken so far, of it or of the rest */
    uint32_t lease;
    uint16_t ticks; /* since the last sample */
    uint32_t lost;  /* ticks without a measurement */
    uint16_t lost_in_a_row;
    float last[CHANNELS];      /* good readings */
    float level[2 * CHANNELS]; /* before it moves: outputs, then MVs */
    float square[CHANNELS];    /* sums about them */
    float sum[CHANNELS];       /* of what was applied since the last sample */
    real_t signal[CHANNELS];   /* now */
    struct prbs prbs;
    struct decimator filter[CHANNELS];
    struct experiment_work *work; /* NULL: no workspace */
    /* Results */
    struct experiment_found found[CHANNELS];
    struct difference_model model;
    real_t gain[CHANNELS][CHANNELS];
    float noise[CHANNELS]; /* of measurements, standard deviation */
    float live_error[CHANNELS],
        live_gain[CHANNELS]; /* recursive: error one sample ahead, own gain */
    uint8_t proposed, waits_for;
};

/* Settings. */
#define EXPERIMENT_PARAMETER_ROWS 40
#define EXPERIMENT_ID_MODEL       40
extern const struct block_parameter experiment_parameter_rows[EXPERIMENT_PARAMETER_ROWS];
enum err experiment_check(const struct block_setup *setup, struct block_fault *fault);
unsigned experiment_outputs(const struct block_setup *setup);
uint32_t experiment_samples(const struct experiment_settings *s);
void experiment_signal(const struct experiment_settings *s, unsigned mvs,
                       struct prbs_settings *signal);
/* Base ticks of a sample. */
uint16_t experiment_ratio(const struct block_setup *setup);
/* Bytes of the workspace. */
uint32_t experiment_work_bytes(const struct experiment_settings *s, unsigned outputs, unsigned mvs);
/* Parameters of the recursive estimator of an output; 0: too many. */
unsigned experiment_live_parameters(const struct experiment_settings *s, unsigned mvs);

/* The record. */
void experiment_place_work(struct experiment_block *b, void *memory);
/* A tick with readings. True: a sample is there. */
bool experiment_take(struct experiment_block *b, const struct block_io *io, real_t *y, real_t *u);
void experiment_rest(struct experiment_block *b, const real_t *y, const real_t *u);
void experiment_record(struct experiment_block *b, const real_t *y, const real_t *u);
/* Looks at readings: why it has to end, or END_NOTHING. */
enum experiment_end experiment_watch(struct experiment_block *b, const struct block_io *io);

/* The model. Main loop. */
void experiment_begin_finding(struct experiment_block *b);
bool experiment_find_piece(struct experiment_block *b);
/* What was found becomes results; DOUBT_NONE: a model. *output: the first that is in doubt. */
enum experiment_doubt experiment_take_model(struct experiment_block *b, uint8_t *output);

/* Whether it fits among the settings. */
bool experiment_is_small(const struct experiment_block *b);
/* Puts the next values; true while there are more to come. *refused: one was. */
bool experiment_propose(struct experiment_block *b, struct block_io *io, bool *refused);
const char *experiment_describe(const void *state, size_t i, float *value);

#endif
#endif

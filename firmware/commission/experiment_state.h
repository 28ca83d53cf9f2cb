/* Settings and state of a double step on one input: experiment.h. */
#ifndef REFLUX_COMMISSION_EXPERIMENT_STATE_H
#define REFLUX_COMMISSION_EXPERIMENT_STATE_H

#include "commission/interim_fit.h"
#include "commission/origin.h"
#include "identify/guard.h"
#include "identify/moments.h"
#include "identify/record.h"
#include "identify/steady.h"

enum experiment_phase {
    EXPERIMENT_REST,
    EXPERIMENT_UP,
    EXPERIMENT_DOWN,
    EXPERIMENT_BACK,
    EXPERIMENT_DONE,
    EXPERIMENT_FAILED /* without a result; the level is 0 again */
};

enum experiment_failure {
    EXPERIMENT_FINE,
    EXPERIMENT_RESTLESS, /* an output does not come to rest before the step */
    EXPERIMENT_LIMIT,    /* an output exceeded its limit in spite of the guards */
    EXPERIMENT_AWAY,     /* an output does not return after the step */
    EXPERIMENT_LEFT      /* the tests before have left an output too far from the operating point */
};

struct experiment_config {
    uint8_t outputs;        /* 1 to CHANNEL_MAX */
    real_t h_s;             /* sample interval, s */
    uint32_t window;        /* samples over which rest is judged, from STEADY_BLOCKS up */
    real_t noise_floor;     /* least noise of an output, fraction of span, above 0 */
    real_t amplitude;       /* fraction of span; 0: the test finds it */
    real_t amplitude_first; /* first amplitude where the test finds it */
    real_t amplitude_max;   /* room in both directions, fraction of span, above 0 */
    real_t noise_multiple;  /* a response this many times the noise is enough */
    uint32_t half;          /* samples of the positive half; 0: until rest */
    uint32_t half_least;    /* shortest half that ends by itself, samples */
    uint32_t half_most;     /* longest half, samples; above window */
    real_t blank_s;         /* time for which the guard is blind after an edge */
    bool line_guard; /* the guard trusts the straight line, not only above half of the limit */
    real_t limit[CHANNEL_MAX]; /* farthest from the operating point, fraction of span, above 0 */
    real_t dead_time_s[CHANNEL_MAX]; /* 0: not known */
    /* The operating point, kept from test to test; NULL: the rest before this one. */
    struct origin *origin;
};

struct experiment {
    struct experiment_config config;
    enum experiment_phase phase;
    enum experiment_failure failure;
    uint8_t culprit;  /* output for which it failed, or for which the guard cut the step */
    bool begun;       /* there has been a sample */
    bool watched;     /* the rest before the first test has been watched for longer */
    bool cut;         /* the guard ended the positive half */
    bool one_sided;   /* there is no negative half, because it would have exceeded a limit */
    bool at_longest;  /* half_most ended the positive half before it came to rest */
    bool small;       /* the largest amplitude was not enough for noise_multiple */
    real_t predicted; /* peak that the guard predicted, fraction of span */
    real_t amplitude; /* of the present level or the last one */
    real_t level;     /* of the present test signal, fraction of span */
    uint32_t waited;  /* samples in this phase */
    uint32_t half;    /* samples since the last positive edge, then length of the negative half */
    uint32_t samples; /* since the first edge */
    real_t last[CHANNEL_MAX];    /* sample */
    real_t at_turn[CHANNEL_MAX]; /* deviation from rest where the negative half began */
    uint8_t over[CHANNEL_MAX];   /* samples in a row past the limit */
    /* Extremes of the positive half below and above rest for an amplitude of 1, fraction of span. */
    real_t low[CHANNEL_MAX], high[CHANNEL_MAX];
    real_t
        worst; /* largest share of its limit that an output has used, with the deviation before the test */
    uint8_t worst_output;
    real_t rest[CHANNEL_MAX];        /* level before the step */
    real_t drift_per_s[CHANNEL_MAX]; /* slope before the step, where that exceeds the noise */
    struct steady_result before[CHANNEL_MAX], after[CHANNEL_MAX];
    bool returned; /* `after` is from outputs at rest */

    /* The interim fit: experiment_step() begins it, the main loop runs it, experiment_take_interim_fit() takes it. */
    bool interim_fitting;
    bool interim_fitted;       /* there is a model of this step */
    bool fresh;                /* no decision has used that model yet */
    uint32_t next_interim_fit; /* samples since the first edge */
    struct interim_fit interim_fit;

    /* The beginning of the response, from the interim fit that knew the dead time best. */
    struct {
        real_t slope, dead_s, dead_sd_s; /* slope: gain over time constant; 0: not known */
    } early[CHANNEL_MAX];

    struct steady steady;
    struct record record;
    struct moments moments;
    struct guard guard;
};

#endif

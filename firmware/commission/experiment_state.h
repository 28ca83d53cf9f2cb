/* What a double step on one input (experiment.h) keeps, finds and is told. */
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
    EXPERIMENT_FAILED /* nothing to be had; the level is 0 again */
};

enum experiment_failure {
    EXPERIMENT_FINE,
    EXPERIMENT_RESTLESS, /* an output does not come to rest before the step */
    EXPERIMENT_LIMIT,    /* an output went past its limit all the same */
    EXPERIMENT_AWAY,     /* an output does not come back after it */
    EXPERIMENT_LEFT      /* the tests before have left an output too far from the operating point */
};

struct experiment_config {
    uint8_t outputs;           /* 1 to CHANNEL_MAX */
    real_t h_s;                /* sample interval, s */
    uint32_t window;           /* samples over which rest is judged, from STEADY_BLOCKS up */
    real_t noise_floor;        /* noise of an output at least, fraction of span, above 0 */
    real_t amplitude;          /* fraction of span, above 0; 0 = to be found */
    real_t amplitude_first;    /* ... beginning with this */
    real_t amplitude_max;      /* room in both directions, fraction of span, above 0 */
    real_t noise_multiple;     /* a response this many times the noise is enough */
    uint32_t half;             /* samples of the positive half; 0 = until rest */
    uint32_t half_least;       /* ... but no less than this */
    uint32_t half_most;        /* no half is longer; above window */
    real_t blank_s;            /* the guard looks away for so long */
    bool line_guard;           /* believe the straight line; else only above half of the limit */
    real_t limit[CHANNEL_MAX]; /* farthest from the operating point, fraction of span, above 0 */
    real_t dead_time_s[CHANNEL_MAX]; /* as far as known, else 0 */
    struct origin
        *origin; /* the operating point, kept from test to test; NULL: the rest before this one */
};

struct experiment {
    struct experiment_config config;
    enum experiment_phase phase;
    enum experiment_failure failure;
    uint8_t culprit;  /* output: of the failure, or that made the guard cut the step */
    bool begun;       /* there has been a sample */
    bool watched;     /* the rest before the first test, for longer */
    bool cut;         /* by the guard */
    bool one_sided;   /* ... and without a negative half, which would have gone past a limit */
    bool at_longest;  /* half_most ended it before it came to rest */
    bool small;       /* the largest amplitude was not enough for noise_multiple */
    real_t predicted; /* peak that the guard saw coming, fraction of span */
    real_t amplitude; /* of the level now or last */
    real_t level;     /* of the test signal now, fraction of span */
    uint32_t waited;  /* samples in this phase */
    uint32_t half;    /* samples since the last positive edge, then length of the negative half */
    uint32_t samples; /* since the first edge */
    real_t last[CHANNEL_MAX];    /* sample */
    real_t at_turn[CHANNEL_MAX]; /* deviation from rest where the negative half began */
    uint8_t over[CHANNEL_MAX];   /* samples in a row past the limit */
    /* In the positive half: the farthest from rest to either side for an amplitude of 1, fraction of span, never on the
     * other side of it. */
    real_t low[CHANNEL_MAX], high[CHANNEL_MAX];
    real_t
        worst; /* largest share of its limit any output has used, by what is left of earlier tests, too */
    uint8_t worst_output;
    real_t rest[CHANNEL_MAX]; /* level before the step */
    real_t drift_per_s
        [CHANNEL_MAX]; /* ... and what it climbed then, where that stands out of the noise */
    struct steady_result before[CHANNEL_MAX], after[CHANNEL_MAX];
    bool returned; /* `after` is from outputs at rest */

    /* The interim fit under way: experiment_step begins it, the background runs it (interim_fit_run), experiment_take_interim_fit takes it. */
    bool interim_fitting;
    bool interim_fitted, fresh; /* there is a model of this step; not yet acted upon */
    uint32_t next_interim_fit;  /* samples since the first edge */
    struct interim_fit interim_fit;

    /* From the interim fit that has known the dead time best, when the record was still fine: how the response begins. */
    struct {
        real_t slope, dead_s, dead_sd_s; /* slope: gain over time constant; 0: not known */
    } early[CHANNEL_MAX];

    struct steady steady;
    struct record record;
    struct moments moments;
    struct guard guard;
};

#endif

/* Settings, phases and failures of a double step on one input (experiment.h): records. */
#ifndef REFLUX_COMMISSION_EXPERIMENT_CONFIG_H
#define REFLUX_COMMISSION_EXPERIMENT_CONFIG_H

#include "exchange/config.h"
#include "num/real.h"

/* First amplitude over a limit where no gain is known: a gain of 100 spans per span ends at the limit. */
#define FIRST_OF_LIMIT REAL_C(0.01)
#define AMPLITUDE_MOST REAL_C(0.25) /* of span: largest step where the test finds it */
/* Limit for tests of an input that are repeated with a smaller step, because the guard has cut them; over all rounds. */
#define RETRIES_MAX 3u

struct origin;

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
    bool gains_unknown;     /* the first amplitude must be safe for large gains, too */
    real_t amplitude_max;   /* room in both directions, fraction of span, above 0 */
    real_t noise_multiple;  /* a response this many times the noise is enough */
    uint32_t half;          /* samples of the positive half; 0: until rest */
    uint32_t half_least;    /* shortest half that ends by itself, samples */
    uint32_t half_most;     /* longest half, samples; above window */
    uint32_t
        half_plenty; /* samples after which a half goes on only for a response that does; 0: half_most */
    real_t blank_s;  /* time for which the guard is blind after an edge */
    bool repeats;    /* a step that the guard cuts is made again with a smaller one */
    bool line_guard; /* the guard trusts the straight line, not only above half of the limit */
    real_t limit[CHANNEL_MAX]; /* farthest from the operating point, fraction of span, above 0 */
    real_t dead_time_s[CHANNEL_MAX]; /* 0: not known */
    /* The operating point, kept from test to test; NULL: the rest before this one. */
    struct origin *origin;
};

#endif

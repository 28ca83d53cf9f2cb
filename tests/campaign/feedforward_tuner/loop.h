/* A loop with a disturbance, twice with the same noise: under its PI alone, and with an element that a block of the kind `ff_tune`
 * tunes. Everything in fractions of span about a place of rest; time in base ticks of one second. */
#ifndef REFLUX_CAMPAIGN_FEEDFORWARD_TUNER_LOOP_H
#define REFLUX_CAMPAIGN_FEEDFORWARD_TUNER_LOOP_H

#include <stdalign.h>
#include <stdbool.h>
#include <stdint.h>

#include "kinds/ff_tune/feedforward_tune.h"
#include "kinds/ff_tune/tune_state.h"
#include "random_source.h"

#define PATH_DEAD_MOST 128u /* ticks */

/* gain e^(-dead s)/((lag s + 1)(lag2 s + 1)), or gain e^(-dead s)/s. */
struct path {
    double gain, lag, lag2;
    unsigned dead;
    bool integrates;
};

struct path_state {
    double u[PATH_DEAD_MOST], x[2];
};

enum disturbance { SQUARE, TELEGRAPH, COLOURED };

struct loop_case {
    const char *name;
    struct path process, path;
    enum disturbance disturbance;
    double noise, disturbance_noise; /* of the sensors, r.m.s. */
    double dead_band;                /* of the element, fraction of span */
    double step;                     /* of the test signal */
    uint8_t method;
    float check_s;
};

/* One of the two. */
struct half {
    struct path_state process, path;
    double integral, y;
};

struct loop {
    struct loop_case given;
    struct random_source random;
    uint64_t t;
    double d, telegraph, coloured; /* the disturbance */
    bool moves;                    /* whether it may */
    struct half alone, tuned;
    double gain, ti; /* of the PI */
    /* The element, and the block. */
    struct tune_settings settings;
    struct block_setup setup;
    struct block_io io;
    num_t setpoint, in, out, input[2];
    uint8_t quality[2], clamp, limited;
    float age_s[2], event_value[BLOCK_EVENTS_MAX];
    const struct applied_history *applied[1];
    struct block_proposal proposal;
    struct block_switch_off off;
    struct block_excitation excite[BLOCK_EXCITES_MAX];
    double excited; /* added to the setpoint */
    double delayed[PATH_DEAD_MOST], lead_lag, before;
    double counted; /* the disturbance behind the dead band */
    uint8_t waiting;
    uint16_t raised; /* events since they were last looked at */
    alignas(8) char history[sizeof(struct applied_history) + 4 * sizeof(num_t)];
    alignas(8) char state[16384];
};

/* SIMC's PI; false: the block refuses its settings. */
bool loop_begin(struct loop *l, const struct loop_case *of, uint64_t seed);
void loop_tick(struct loop *l);
void loop_verb(struct loop *l, const char *name);
struct tune_parts loop_block(struct loop *l);

#endif

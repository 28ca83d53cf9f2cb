/* A simulated plant as the bench sees it: a table of channels and a handful of functions.
 *
 * Rules
 *  1. All values are in engineering units; time is in seconds of plant time, starting at 0.
 *  2. Inputs are piecewise constant: what set_input() set holds over the next advance().
 *  3. The plant is perfect: sensors, noise, valve limits and faults are added by instruments.c around it.
 *  4. Every function that can fail writes one line to the error buffer: what is wrong, where, what would
 *     be right.
 *  5. Same calls, same numbers: a plant holds no clock, no random source and no global state.
 */
#ifndef REFLUX_HOST_SIM_PLANT_H
#define REFLUX_HOST_SIM_PLANT_H

#include <stdbool.h>
#include <stddef.h>

enum plant_kind {
    PLANT_MV,          /* manipulated variable, driven by the controller */
    PLANT_DISTURBANCE, /* input or parameter the scenario may change with --event */
    PLANT_MEASUREMENT, /* announced over the link */
    PLANT_INTERNAL     /* logged as truth, not announced (compositions, flows) */
};

struct plant_channel {
    enum plant_kind kind;
    const char *name; /* at most 15 characters: letters, digits, underscore */
    const char *unit; /* at most 11 characters, "-" for none */
    /* span; inputs outside it are refused (disturbances) or clipped (MVs, by instruments) */
    double lo, hi;
    double nominal;    /* inputs start there; of the steady state, where create() makes one */
    double safe;       /* MVs: value taken on silence or an emergency */
    double slew;       /* MVs: fastest change, units per second, 0 = none. An actuator property */
    double lag_s;      /* measurements: first-order sensor time constant, 0 = none */
    double noise;      /* measurements: standard deviation of the sensor at --noise 1, units */
    double resolution; /* measurements: quantisation step, units, 0 = none */
    /* measurements: an analyser, with a new value every so many seconds; 0 = none */
    double every_s;
    double delay_s; /* measurements: an analyser's value was taken so long before it is shown */
    const char *help;
};

struct plant;        /* opaque, one per implementation */
struct linear_model; /* linear_plant.h */
struct column_plant; /* column_plant.h */

struct linearised; /* linearise.h */

/* Access to a nonlinear plant's state, so that it can be linearised by differences. */
struct plant_states {
    size_t (*count)(const struct plant *p);
    const char *unit; /* of every state */
    double lo, hi;    /* states stay between these */
    double step; /* a difference that is small for every state, relative where a state is above 1 */
    void (*get)(const struct plant *p, double *x);
    bool (*set)(struct plant *p, const double *x, char *err, size_t err_size);
    /* Rates of change per second at the present state and inputs. */
    bool (*rates)(struct plant *p, double *rates, char *err, size_t err_size);
};

struct plant_class {
    const char *name;   /* as in --plant */
    const char *title;  /* one line */
    const char *source; /* author and what of it is the source's, and what is ours */
    double tick_s;      /* control interval it is meant for */
    const struct plant_channel *channels;
    size_t n_channels;

    /* Creates the plant at the steady state of its nominal inputs, or cold where the class says so, time 0. NULL
     * on error, with the reason in err. */
    struct plant *(*create)(char *err, size_t err_size);
    void (*destroy)(struct plant *p);
    /* channel: index in channels[], kind MV or DISTURBANCE. Out of [lo, hi] or not finite is refused. */
    bool (*set_input)(struct plant *p, size_t channel, double value, char *err, size_t err_size);
    /* Integrates to plant time t_s (seconds, not before the present time). */
    bool (*advance)(struct plant *p, double t_s, char *err, size_t err_size);
    /* Present true value of any channel (inputs too). */
    double (*value)(const struct plant *p, size_t channel);
    /* Moves the state to the steady state of the present inputs, time unchanged. */
    bool (*settle)(struct plant *p, char *err, size_t err_size);

    /* The rest may be left out. */
    const char *ours; /* what the source does not give and we chose, when source does not say it */
    const char *time_unit; /* of the source's numbers, NULL = s; here all is in seconds */
    double period_s;       /* discrete plants: the only tick they take; 0 = any */
    const struct linear_model *model;  /* linear plants: then create is NULL */
    const struct column_plant *column; /* columns: likewise */
    const struct plant_states *states;
    /* Fills the matrices of l (linearise.h), whose sizes and point are there, where differences of the plant itself
     * would not do. The plant is left as it was. */
    bool (*linearise)(struct plant *p, struct linearised *l, char *err, size_t err_size);
};

/* A plant of a class at its nominal steady state, time 0. NULL on error, with the reason in err. */
struct plant *plant_create(const struct plant_class *class, char *err, size_t err_size);

/* All plants written in C, NULL-terminated. Those in files: plant_library.h. */
extern const struct plant_class *const plant_classes[];

/* For set_input of plants whose first n_inputs channels are the inputs: false, with the line, for another channel
 * or a value outside its span (NaN too). */
bool plant_input_allowed(const struct plant_class *class, size_t n_inputs, size_t channel,
                         double value, char *err, size_t err_size);

#endif

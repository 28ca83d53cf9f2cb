/* Estimator of the compositions of a column from temperatures: the column's model, drawn towards what is measured. For this folder alone. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_H
#define REFLUX_COMPOSITION_COMPOSITION_H

#include "kinds/column/column.h"
#include "kinds/composition/composition_settings.h"
#include "kinds/composition/covariance.h"
#include "model/column_implicit.h"
#include "model/column_transition.h"

#if CONFIG_BLOCKS

#define SENSORS_MAX BLOCK_INPUTS_MAX

/* What is known of a temperature. */
struct composition_sensor {
    uint8_t input;     /* which */
    uint8_t stage;     /* from 0 */
    uint8_t component; /* from 0 */
    bool moves;        /* else it is only compared */
    bool there;        /* a good reading, not gated, in this step */
    real_t kp, ki;     /* 1/s, 1/s2 */
    real_t time;       /* s, 1/lambda */
    real_t e;          /* K, measured less predicted, before the step */
    real_t sum;        /* integral of what is left of it, K s */
    real_t variance;   /* reduced EKF: of its mole fraction */
    real_t slope;      /* dT/dx of its component at the estimate, K */
    real_t spread;     /* reduced EKF: variance of e that is expected, K2 */
    uint32_t outside;  /* steps in a row outside the gate */
    real_t correction; /* K/s, by which it drew the temperature in this step */
    real_t noise2;     /* K2, of a reading */
    real_t slow;       /* of the innovations, over SLOW_STEPS: what they swing about */
    /* Means over the last `watch` seconds: of innovations over their expected standard deviation; of squares of that swing; of corrections; of e2 over its expected variance; of e times the one before. */
    real_t mean, swing, pull, square, product, last;
};

/* Complete innovation: gains by which a deviation moves all mole fractions, and what nobody measures besides (extras): the feed's mole
 * fractions, as many as are integrated, its flow, and by how much the model is off where there are analyses. */
struct composition_gains {
    const real_t *
        of; /* [sensors][mole fractions, then extras]; NULL: none yet, each temperature moves its own mole fraction */
    bool has_feed;        /* its mole fractions are the first extras */
    bool has_flow;        /* part by which the feed is more than it is said to be: the next one */
    uint8_t feed, extras; /* how many: of the feed; altogether */
    real_t extra[COVARIANCE_EXTRAS_MAX];
};

/* A model that is linear around the profile and the inputs of the table. */
struct composition_linear {
    struct column_transition transition;
    real_t *push; /* [feed's extras][mole fractions]: rates by what is found of the feed, 1/s */
    real_t h;     /* s, of its steps; 0: it is not there yet */
};

/* The least noise that is found of a reading, K2. */
#define NOISE_LEAST2 REAL_C(0.0025)

struct composition {
    struct column_table table;
    struct column column;
    struct column_inputs inputs;
    bool truncated[COLUMN_STAGES_MAX];
    real_t x[COLUMN_STATES_MAX], rates[COLUMN_STATES_MAX];
    struct column_blocks blocks;
    struct composition_sensor sensor[SENSORS_MAX];
    uint8_t sensors;
    uint8_t method;  /* enum composition_method */
    uint8_t between; /* enum column_between */
    struct composition_gains gains;
    struct composition_linear linear; /* METHOD_KALMAN */
    real_t h;                         /* s */
    bool finds_noise;                 /* of each sensor */
    real_t model2;                    /* 1/s */
    real_t gate;
    uint32_t gate_steps;
    real_t weight;    /* of a step in the means of the monitor, once they have begun */
    uint32_t watched; /* steps in them; saturates */
    bool solved;      /* the last step went well */
    uint16_t clipped; /* mole fractions kept within limits in it */
    uint16_t
        bounced; /* steps since the profile was taken again because there was no solution; saturates */
};

/* It moves the model in this step. */
static inline bool composition_draws(const struct composition_sensor *s)
{
    return s->moves && s->there;
}

/* The section it is in. */
static inline bool composition_is_above_feed(const struct composition *c,
                                             const struct composition_sensor *s)
{
    return s->stage + 1u > c->table.config.feed_stage;
}

/* From the estimate, by more than the gate. */
static inline bool composition_is_far(const struct composition *c,
                                      const struct composition_sensor *s)
{
    return c->gate > REAL_C(0.0) && real_abs(s->e) > c->gate;
}

/* Whether a temperature moves all mole fractions, once there are gains. */
static inline bool composition_is_complete(const struct composition *c)
{
    return c->method == METHOD_EKF || c->method == METHOD_KALMAN;
}

/* Mole fractions and extras. */
static inline size_t composition_moved(const struct composition *c)
{
    return c->column.n_fractions + c->gains.extras;
}

/* The state may have been moved to another place since the last call: pointers into it are set anew. */
void composition_stands_here(struct composition *c);

/* What the model is driven by: the inputs, with what has been found of the feed. */
void composition_inputs(const struct composition *c, struct column_inputs *inputs);

/* push[feed's extras][mole fractions]: rates by what is found of the feed, 1/s, at the state x and the inputs of the column, which
 * column_rates() has seen last. flow, work: [mole fractions], space. */
void composition_push(const struct composition_gains *g, struct column *column, const real_t *x,
                      real_t *push, real_t *flow, real_t *work);

/* The linear model (composition_linear.c): rates at the profile, with what has been found of the feed, and a step of it in c->blocks. */
enum err composition_linear_rates(struct composition *c);
void composition_linear_step(struct composition *c);

/* dT/dx and dy/dx of a stage as composition_temperature uses them: at the estimate, or where the model is linear. */
void composition_slopes(const struct composition *c, size_t stage, real_t *dt, real_t *dy);

/* Of a stage, K, by the model before the step. */
real_t composition_temperature_before(const struct composition *c, size_t stage);

/* Moves everything by what a temperature says: s->e, measured less predicted at the end of the step. */
void composition_innovate(struct composition *c, struct composition_sensor *s, unsigned k,
                          const real_t *dt);
/* The extras alone, by a gain whose first part is of the mole fractions. */
void composition_move_extras(struct composition *c, const real_t *gain, real_t e);

/* Begins with the profile of the table. */
void composition_begin(struct composition *c);

/* A step of c->h to the readings t[sensors], K; those that are not there count for nothing. The inputs are those of the time
 * between. ERR_OK, or why there is no estimate: then it has begun anew. */
enum err composition_step(struct composition *c, const real_t *t);

/* Temperatures at the estimate and the inputs, without a step. Errors as composition_step. */
enum err composition_evaluate(struct composition *c);

/* The step of the model alone, over c->h. */
enum err composition_predict(struct composition *c);

/* The monitor's means. */
void composition_watch(struct composition *c);

/* Number of the sensor whose mean correction is farthest from the mean of its section, where they are more than `most` K/h apart:
 * 1 and up; 0 where there is none, or fewer than two. A reading that lies disagrees with those beside it; where all are wrong, or the
 * feed is another, they agree. */
unsigned composition_odd_sensor(const struct composition *c, real_t most);

/* Estimated temperature, K, at a stage from 0, after the step. */
real_t composition_temperature(const struct composition *c, size_t stage);

#endif
#endif

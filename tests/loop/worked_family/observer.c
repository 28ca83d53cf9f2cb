/* An estimator: a Kalman filter of a plant with two measurements and two manipulated variables, whose elements are
 * first-order lags with dead time. It tells what the measurements will be when what was sent has arrived.
 *
 * Model, per step of h seconds, in fractions of span
 *     x_ij(k+1) = a_ij x_ij(k) + b_ij u_j(k - n_ij)   a_ij = exp(-h / lag_ij), b_ij = (1 - a_ij) gain_ij, n_ij = dead_ij / h
 *     y_i(k)    = x_i1(k) + x_i2(k) + d_i(k) + noise  d_i: what the model does not explain, a random walk
 *
 * Step
 *     x <- model(x, u);  x <- x + L (y - x_i1 - x_i2 - d_i)
 *     point i = y_i the shortest of its dead times later: all that moves it until then has been sent
 *
 * L is that of the stationary Kalman filter (Anderson and Moore, Optimal Filtering, 1979, chapter 4): the recursion of the
 * covariance until it stands still, one iteration a piece, as work between ticks; then it is tried whether errors die away
 * with it. Until then, and where it finds no rest or fails, L is a safe one that corrects d alone, and is stable whatever the model.
 *
 * Computed in real_t: variances have a range that Q7.24 has not. */
#include "kinds.h"

#include <string.h>

#include "base/channel.h"
#include "num/real.h"

#define STATES       6     /* x_11 x_12 x_21 x_22 d_1 d_2 */
#define DEAD_MOST    240   /* steps */
#define LAG_MOST     10000 /* steps: what is slower is drift, and float would lose its increments */
#define SAFE_GAIN    REAL_C(0.1)
#define GAIN_STEPS   20           /* the gain is taken so many steps after it was asked for */
#define PIECES_MOST  4000         /* iterations */
#define STANDS_STILL REAL_C(1e-5) /* part of itself by which the gain changes in an iteration */
#define DIED_AWAY    REAL_C(1e-6) /* part of an error */
#define TRIAL_STEPS  400
#define FAR_OFF      REAL_C(10.0) /* standard deviations of a reading */

enum { MEASURED, MOVED = 2, INPUTS = 4 }; /* the first of two each */
enum { GAINED, SURPRISE, EVENTS };

struct observer_settings {
    float gain[2][2]; /* measurement i per MV j, spans */
    float lag_s[2][2], dead_s[2][2];
    float noise[2]; /* standard deviations, fractions of span: of a reading, */
    float drift[2]; /* of a step of d, */
    float unseen;   /* of what the plant gets besides what was sent */
};

/* Memory of the work; the tick leaves it alone until the work is done. */
struct observer_design {
    real_t a[STATES], q[STATES][STATES], r[2];
    real_t p[STATES][STATES], gain[STATES][2];
    uint16_t iterations;
    bool found; /* it stands still: now it is tried */
    /* with an error of each state: which comes next, how many have died away */
    uint8_t next, tried;
};

struct observer {
    real_t a[STATES], b[4];
    uint16_t dead[4]; /* steps */
    uint16_t ahead[2];
    real_t q[STATES][STATES], r[2];
    real_t x[STATES], gain[STATES][2];
    bool begun;
    bool gain_wanted; /* settings are newer than the gain that is there or asked for */
    bool gained;      /* the gain is the filter's, not the safe one */
    float interval_s;
    uint32_t frozen; /* steps for which nothing measured is valid */
    struct observer_design design;
};

static const struct block_parameter observer_parameters[] = {
    {1, BLOCK_FLOAT, offsetof(struct observer_settings, gain), 2, 2, "gain", "-",
     "row: measurement, column: MV; span per span", -100, 100, 0},
    {2, BLOCK_FLOAT, offsetof(struct observer_settings, lag_s), 2, 2, "lag", "s", "time constants",
     0.001f, 1e6f, 60},
    {3, BLOCK_FLOAT, offsetof(struct observer_settings, dead_s), 2, 2, "dead", "s",
     "dead times; the nearest step counts", 0, 1e6f, 0},
    {4, BLOCK_FLOAT, offsetof(struct observer_settings, noise), 1, 2, "noise", "fraction",
     "standard deviation of the readings", 1e-4f, 0.1f, 1e-3f},
    {5, BLOCK_FLOAT, offsetof(struct observer_settings, drift), 1, 2, "drift", "fraction",
     "the same of what nobody measures, per step", 1e-5f, 0.1f, 3e-4f},
    {6, BLOCK_FLOAT, offsetof(struct observer_settings, unseen), 1, 1, "unseen", "fraction",
     "the same of what the plant gets besides what was sent", 0, 0.02f, 2e-3f},
};

/* ---- settings ---- */

/* Steps of dead time of element k = 2 i + j. */
static uint16_t dead_steps(const struct block_setup *setup, unsigned k)
{
    const struct observer_settings *c = setup->settings;
    return (uint16_t)(c->dead_s[k / 2][k % 2] / setup->interval_s + 0.5f);
}

static uint32_t observer_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct observer);
}

/* The input of the longest dead time ago comes out now. */
static uint16_t observer_history(const struct block_setup *setup)
{
    uint16_t most = 0;
    for (unsigned k = 0; k < 4; k++)
        if (dead_steps(setup, k) > most)
            most = dead_steps(setup, k);
    return (uint16_t)(most + 1u);
}

static enum err observer_refuse(struct block_fault *fault, const char *field, const char *wanted)
{
    *fault = (struct block_fault){.field = field, .wanted = wanted};
    return ERR_RANGE;
}

static enum err observer_check(const struct block_setup *setup, struct block_fault *fault)
{
    const struct observer_settings *c = setup->settings;
    if (setup->inputs != INPUTS || setup->input[MEASURED].is_mv ||
        setup->input[MEASURED + 1].is_mv || !setup->input[MOVED].is_mv ||
        !setup->input[MOVED + 1].is_mv)
        return observer_refuse(fault, "inputs", "needs two measurements, then two MVs");
    if (setup->points != 2)
        return observer_refuse(fault, "points", "needs two");
    for (unsigned i = 0; i < 2; i++)
        if (setup->point[i].lo != setup->input[MEASURED + i].lo ||
            setup->point[i].hi != setup->input[MEASURED + i].hi)
            return observer_refuse(fault, "points", "needs for each the span of its measurement");
    for (unsigned k = 0; k < 4; k++) {
        if (c->lag_s[k / 2][k % 2] > LAG_MOST * setup->interval_s)
            return observer_refuse(fault, "lag", "must be at most 10000 steps");
        if (c->dead_s[k / 2][k % 2] > DEAD_MOST * setup->interval_s)
            return observer_refuse(fault, "dead", "must be at most 240 steps");
    }
    return ERR_OK;
}

/* Returns the shorter dead time of elements k and k + 1, of those that have a gain. */
static uint16_t shortest_dead_time(const struct observer *o, unsigned k)
{
    if (o->b[k] == 0 || (o->b[k + 1] != 0 && o->dead[k + 1] < o->dead[k]))
        k++;
    return o->b[k] == 0 ? 0 : o->dead[k];
}

static void set_model(struct observer *o, const struct block_setup *setup)
{
    const struct observer_settings *c = setup->settings;
    for (unsigned k = 0; k < 4; k++) {
        o->a[k] = real_exp(-setup->interval_s / c->lag_s[k / 2][k % 2]);
        o->b[k] = (REAL_C(1.0) - o->a[k]) * c->gain[k / 2][k % 2];
        o->dead[k] = dead_steps(setup, k);
    }
    o->a[4] = o->a[5] = REAL_C(1.0);
    for (unsigned i = 0; i < 2; i++)
        o->ahead[i] = shortest_dead_time(o, 2 * i);
}

/* Covariances: what comes unseen at an input moves both measurements. */
static void set_covariances(struct observer *o, const struct observer_settings *c)
{
    memset(o->q, 0, sizeof o->q);
    for (unsigned k = 0; k < 4; k++) {
        unsigned other = (k + 2) % 4; /* the other measurement, the same MV */
        o->q[k][k] = c->unseen * c->unseen * o->b[k] * o->b[k];
        o->q[k][other] = c->unseen * c->unseen * o->b[k] * o->b[other];
    }
    for (unsigned i = 0; i < 2; i++) {
        o->q[4 + i][4 + i] = c->drift[i] * c->drift[i];
        o->r[i] = c->noise[i] * c->noise[i];
    }
}

static enum err observer_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct observer *o = state;
    if (!retune) {
        memset(o, 0, sizeof *o);
        o->gain[4][0] = o->gain[5][1] = SAFE_GAIN;
    }
    o->interval_s = setup->interval_s;
    set_model(o, setup);
    set_covariances(o, setup->settings);
    o->gain_wanted = true; /* the one in use goes on until then */
    return ERR_OK;
}

/* ---- the gain: work between ticks ---- */

static void begin_design(struct observer *o)
{
    struct observer_design *d = &o->design;
    memcpy(d->a, o->a, sizeof d->a);
    memcpy(d->q, o->q, sizeof d->q);
    memcpy(d->p, o->q, sizeof d->p);
    memcpy(d->r, o->r, sizeof d->r);
    memset(d->gain, 0, sizeof d->gain);
    d->iterations = d->next = d->tried = 0;
    d->found = false;
}

/* Column i of P C': a measurement is the sum of three states. */
static real_t seen_by(const struct observer_design *d, unsigned row, unsigned i)
{
    return d->p[row][2 * i] + d->p[row][2 * i + 1] + d->p[row][4 + i];
}

/* Row of the gain from that of P C'; returns by how much it has changed. */
static real_t new_gain(real_t gain[2], const real_t pc[2], real_t s[2][2], real_t det)
{
    real_t g[2] = {(pc[0] * s[1][1] - pc[1] * s[1][0]) / det,
                   (pc[1] * s[0][0] - pc[0] * s[0][1]) / det};
    real_t change = real_abs(g[0] - gain[0]) + real_abs(g[1] - gain[1]);
    memcpy(gain, g, sizeof g);
    return change;
}

/* True if an error of a state dies away: x <- A x, x <- x - L C x. With rounding between P and L it may be that it grows. */
static bool dies_away(const struct observer_design *d, unsigned state)
{
    real_t x[STATES] = {0}, half = 0, rest = 0;
    x[state] = 1;
    for (unsigned step = 1; step <= TRIAL_STEPS; step++) {
        for (unsigned r = 0; r < STATES; r++)
            x[r] *= d->a[r];
        real_t seen[2] = {x[0] + x[1] + x[4], x[2] + x[3] + x[5]};
        rest = 0;
        for (unsigned r = 0; r < STATES; r++) {
            x[r] -= d->gain[r][0] * seen[0] + d->gain[r][1] * seen[1];
            rest += real_abs(x[r]);
        }
        if (step == TRIAL_STEPS / 2)
            half = rest;
    }
    return rest < half || rest < DIED_AWAY; /* false for what is no number */
}

/* One iteration: P <- A P A' + Q, L = P C' (C P C' + R)^-1, P <- P - L C P. */
static bool iterate(struct observer_design *d)
{
    real_t pc[STATES][2], s[2][2], change = 0, size = 0;
    for (unsigned r = 0; r < STATES; r++)
        for (unsigned c = 0; c < STATES; c++)
            d->p[r][c] = d->a[r] * d->p[r][c] * d->a[c] + d->q[r][c];
    for (unsigned r = 0; r < STATES; r++)
        for (unsigned i = 0; i < 2; i++)
            pc[r][i] = seen_by(d, r, i);
    for (unsigned i = 0; i < 2; i++)
        for (unsigned k = 0; k < 2; k++)
            s[i][k] = pc[2 * i][k] + pc[2 * i + 1][k] + pc[4 + i][k] + (i == k ? d->r[i] : 0);
    real_t det = s[0][0] * s[1][1] - s[0][1] * s[1][0];
    if (!(det > 0))
        return false; /* beyond float: the safe gain stays */
    for (unsigned r = 0; r < STATES; r++) {
        change += new_gain(d->gain[r], pc[r], s, det);
        size += real_abs(d->gain[r][0]) + real_abs(d->gain[r][1]);
    }
    for (unsigned r = 0; r < STATES; r++)
        for (unsigned c = 0; c <= r; c++)
            d->p[c][r] = d->p[r][c] -= d->gain[r][0] * pc[c][0] + d->gain[r][1] * pc[c][1];
    d->iterations++;
    d->found = change < STANDS_STILL * size;
    return d->found || d->iterations < PIECES_MOST;
}

static bool observer_work(void *state)
{
    struct observer_design *d = &((struct observer *)state)->design;
    if (!d->found)
        return iterate(d);
    d->tried = (uint8_t)(d->tried + dies_away(d, d->next));
    return ++d->next < STATES;
}

static void take_gain(struct observer *o, struct block_io *io)
{
    if (io->requests.work_done && o->design.tried == STATES && !o->gain_wanted) {
        memcpy(o->gain, o->design.gain, sizeof o->gain);
        o->gained = true;
        io->requests.raised = 1u << GAINED;
        io->requests.event_value[GAINED] = o->design.iterations;
    }
    if (!o->gain_wanted || io->requests.work_wanted)
        return;
    begin_design(o);
    io->requests.ask_work = GAIN_STEPS;
    o->gain_wanted = false;
}

/* ---- steps ---- */

/* Value of the MV of element k that took effect so many steps before the last. */
static real_t sent(const struct block_io *io, unsigned k, unsigned before)
{
    return num_to_float(applied_ticks_ago(io->inputs.applied[MOVED + k % 2], before + 1u));
}

/* At rest with what is there: what the model does not explain is d. */
static void begin_at_rest(struct observer *o, const struct block_io *io)
{
    for (unsigned k = 0; k < 4; k++)
        o->x[k] = o->b[k] / (REAL_C(1.0) - o->a[k]) * sent(io, k, o->dead[k]);
    for (unsigned i = 0; i < 2; i++)
        o->x[4 + i] =
            num_to_float(io->inputs.value[MEASURED + i]) - (o->x[2 * i] + o->x[2 * i + 1]);
    o->begun = true;
}

static void predict(struct observer *o, const struct block_io *io)
{
    for (unsigned k = 0; k < 4; k++)
        o->x[k] = o->a[k] * o->x[k] + o->b[k] * sent(io, k, o->dead[k]);
}

/* By what was measured, where it was. */
static void correct(struct observer *o, struct block_io *io)
{
    real_t e[2] = {0, 0};
    for (unsigned i = 0; i < 2; i++) {
        if (!quality_usable((enum quality)io->inputs.quality[MEASURED + i]))
            continue;
        e[i] = num_to_float(io->inputs.value[MEASURED + i]) -
               (o->x[2 * i] + o->x[2 * i + 1] + o->x[4 + i]);
        if (e[i] * e[i] <= FAR_OFF * FAR_OFF * o->r[i])
            continue;
        io->requests.raised = (uint16_t)(io->requests.raised | 1u << SURPRISE);
        io->requests.event_value[SURPRISE] = e[i];
    }
    for (unsigned r = 0; r < STATES; r++)
        o->x[r] += o->gain[r][0] * e[0] + o->gain[r][1] * e[1];
}

/* Measurement i when what was sent until now begins to be all. */
static real_t look_ahead(const struct observer *o, const struct block_io *io, unsigned i)
{
    real_t y = o->x[4 + i];
    for (unsigned k = 2 * i; k < 2 * i + 2; k++) {
        real_t x = o->x[k];
        for (unsigned step = 1; step <= o->ahead[i]; step++)
            x = o->a[k] * x + o->b[k] * sent(io, k, o->dead[k] - step);
        y += x;
    }
    return y;
}

/* All that it needs to begin with; to go on, what was sent is enough. */
static bool has_inputs(const struct observer *o, const struct block_io *io)
{
    for (unsigned k = o->begun ? MOVED : MEASURED; k < INPUTS; k++)
        if (!quality_usable((enum quality)io->inputs.quality[k]))
            return false;
    return true;
}

/* It is worth what its measurement is; where that is not looked at, it is a guess. */
static enum quality point_quality(const struct observer *o, enum quality measured)
{
    if (o->frozen)
        return QUALITY_UNCERTAIN;
    return quality_usable(measured) ? measured : QUALITY_BAD;
}

static void observer_step(void *state, struct block_io *io)
{
    struct observer *o = state;
    take_gain(o, io);
    if (!has_inputs(o, io)) {
        o->begun = false; /* and anew when they are back; until then the points are missing */
        return;
    }
    if (!o->begun)
        begin_at_rest(o, io);
    predict(o, io);
    if (!o->frozen)
        correct(o, io);
    for (unsigned i = 0; i < 2; i++) {
        io->points.value[i] = num_from_float(look_ahead(o, io, i));
        io->points.quality[i] =
            (uint8_t)point_quality(o, (enum quality)io->inputs.quality[MEASURED + i]);
    }
    if (o->frozen)
        o->frozen--;
}

/* The state may be that of another plant, or hours old. The gain is not. */
static void observer_follow(void *state, struct block_io *io)
{
    (void)io;
    ((struct observer *)state)->begun = false;
}

/* ---- what it says, and what it may be told ---- */

static const struct block_event observer_events[EVENTS] = {
    [GAINED] = {"gained", BLOCK_INFO, "the gain is the filter's from now on; iterations"},
    [SURPRISE] = {"surprise", BLOCK_ALARM,
                  "a reading is far from what was expected; fraction of span"},
};

static const char *observer_freeze(void *state, const float *seconds)
{
    struct observer *o = state;
    if (!o->begun)
        return "not begun";
    o->frozen = (uint32_t)(*seconds / o->interval_s + 0.5f);
    return NULL;
}

static const char *observer_thaw(void *state, const float *number)
{
    (void)number;
    ((struct observer *)state)->frozen = 0;
    return NULL;
}

static const struct block_verb observer_verbs[] = {
    {.name = "freeze",
     .number = "s",
     .help = "for so long nothing measured is valid",
     .lo = 1,
     .hi = 86400,
     .access = ACCESS_OPERATOR,
     .run = observer_freeze},
    {.name = "thaw",
     .help = "what is measured is valid again",
     .access = ACCESS_OPERATOR,
     .run = observer_thaw},
};

static const char *observer_describe(const void *state, size_t i, float *value)
{
    const struct observer *o = state;
    const struct {
        const char *name;
        float value;
    } inner[] = {
        {"gained", o->gained},
        {"iterations", o->design.iterations},
        {"gain_1", o->gain[4][0]},
        {"gain_2", o->gain[5][1]},
        {"unexplained_1", o->x[4]},
        {"unexplained_2", o->x[5]},
        {"frozen", (float)o->frozen * o->interval_s},
    };
    if (i >= sizeof inner / sizeof inner[0])
        return NULL;
    *value = inner[i].value;
    return inner[i].name;
}

const struct block_kind observer_kind = {
    .name = "observer",
    .stage = STAGE_ESTIMATE,
    .parameter = observer_parameters,
    .parameters = sizeof observer_parameters / sizeof observer_parameters[0],
    .settings_bytes = sizeof(struct observer_settings),
    .inputs_most = INPUTS,
    .points_most = 2,
    .bytes = observer_bytes,
    .history = observer_history,
    .check = observer_check,
    .configure = observer_configure,
    .step = observer_step,
    .follow = observer_follow,
    .work = observer_work,
    .verb = observer_verbs,
    .verbs = sizeof observer_verbs / sizeof observer_verbs[0],
    .event = observer_events,
    .events = EVENTS,
    .describe = observer_describe,
};

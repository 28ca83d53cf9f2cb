#include "kinds/composition/composition_judge.h"

#include "base/assertion.h"
#include "kinds/composition/composition_filter.h"
#include "kinds/composition/composition_judge_state.h"

#define ZERO REAL_C(0.0)

/* Time until the estimate counts as settled, in 1/lambda. */
#define SETTLED    REAL_C(3.0)
#define STEPS_MOST (1u << 31)
/* Vapour to the condenser that counts as none, part of its holdup in an hour. */
#define LITTLE REAL_C(0.1)
/* Time for which vapour must flow until it counts, s. */
#define VAPOUR_S     REAL_C(300.0)
#define DRY_STEPS(h) ((uint32_t)(VAPOUR_S / (h)) + 1u)
#define HOUR         REAL_C(3600.0)
/* The least impurity of a point: no model is better. */
#define IMPURITY_LEAST REAL_C(1e-5)

void composition_judge_begin(struct composition_judge *j)
{
    j->steps = j->without = j->dry = 0;
    j->seen = false;
}

void composition_judge_restart(struct composition_judge *j)
{
    j->steps = 0;
}

void composition_judge_put_missing(struct composition_judge *j, unsigned number)
{
    j->missing = (uint8_t)number;
}

/* ---- settled ---- */

static real_t steps_to_settle(const struct composition_parts *p)
{
    return SETTLED * composition_sensors_slowest(p->sensors) / composition_model_h(p->model);
}

bool composition_judge_is_settled(const struct composition_parts *p)
{
    return (real_t)p->judge->steps >= steps_to_settle(p);
}

/* Counts the steps in which so much vapour has reached the condenser that the temperatures belong to each other. */
static void count_vapour(const struct composition_parts *p)
{
    const struct column *column = composition_model_column(p->model);
    struct composition_judge *j = p->judge;
    size_t top = column->config->stages - 1u;
    if (column->vapour_flow[top - 1] * HOUR < LITTLE * column->holdup[top])
        j->dry = DRY_STEPS(composition_model_h(p->model));
    else
        j->dry -= j->dry ? 1u : 0;
}

static size_t feed_stage_of(const struct composition_parts *p)
{
    return composition_model_table(p->model)->config.feed_stage;
}

void composition_judge_count(const struct composition_parts *p, bool failed)
{
    struct composition_judge *j = p->judge;
    count_vapour(p);
    if (failed) {
        j->steps = 0;
    } else if (!composition_sensors_lost_section(p->sensors, feed_stage_of(p)) && !j->dry) {
        j->steps += j->steps < STEPS_MOST ? 1u : 0;
    } else {
        if (composition_judge_is_settled(p))
            j->steps = (uint32_t)steps_to_settle(p);
        j->steps -= j->steps ? 1u : 0;
    }
}

bool composition_judge_sees(const struct composition_parts *p)
{
    bool drawn = composition_sensors_any_draws(p->sensors);
    p->judge->seen = p->judge->seen || drawn;
    return drawn;
}

/* ---- points ---- */

/* A point of the feed belongs to no section. */
bool composition_judge_is_unseen(const struct composition_parts *p, unsigned k)
{
    REFLUX_ASSERT(k < p->points);
    size_t feed_stage = feed_stage_of(p);
    bool above = p->settings->point[k][AT_STAGE] > feed_stage;
    return p->settings->quantity[k] == OF_STAGE &&
           !composition_sensors_in_section(p->sensors, feed_stage, above) &&
           !composition_analyses_in_section(p->analyses, feed_stage, above);
}

/* Returns the smaller of the mole fraction and the rest; 0 for a point that is no mole fraction of a stage. */
static real_t impurity(const struct composition_parts *p, unsigned k)
{
    size_t component = p->settings->point[k][OF_COMPONENT];
    if (p->settings->quantity[k] != OF_STAGE || !component)
        return ZERO;
    real_t x =
        composition_model_fraction(p->model, p->settings->point[k][AT_STAGE] - 1u, component - 1u);
    real_t least = x < REAL_C(0.5) ? x : REAL_C(1.0) - x;
    return least > IMPURITY_LEAST ? least : IMPURITY_LEAST;
}

/* True: an analysis finds the model's error at the point. */
static bool is_analysed(const struct composition_parts *p, unsigned k)
{
    const uint16_t *point = p->settings->point[k];
    return composition_analyses_find(p->analyses, point[AT_STAGE] - (size_t)1,
                                     point[OF_COMPONENT] - (size_t)1) < ANALYSES_MAX;
}

real_t composition_judge_sd(const struct composition_parts *p, unsigned k)
{
    real_t lasting = is_analysed(p, k) ? ZERO : p->settings->lasting * impurity(p, k);
    real_t sd =
        composition_filter_sd(p->filter, k) * composition_watch_factor(p->watch, p->sensors);
    return real_sqrt(sd * sd + lasting * lasting);
}

bool composition_judge_is_unsure(const struct composition_parts *p, unsigned k)
{
    const struct composition_settings *s = p->settings;
    real_t least = impurity(p, k), sd = composition_judge_sd(p, k);
    if (!composition_is_complete(s) || !(least > ZERO))
        return false;
    return (s->sure > 0 && sd > s->sure) || (s->sure_part > 0 && sd > s->sure_part * least);
}

/* ---- events ---- */

/* value 0: the event does not hold. */
static void raise_event(struct block_io *io, unsigned event, unsigned value)
{
    REFLUX_ASSERT(event < COMPOSITION_EVENTS);
    if (!value)
        return;
    io->requests.raised = (uint16_t)(io->requests.raised | 1u << event);
    io->requests.event_value[event] = (float)value;
}

void composition_judge_put_analysis(const struct composition_parts *p, struct block_io *io,
                                    unsigned input)
{
    if (!p->judge->missing)
        raise_event(io, EVENT_NO_INPUT, input);
}

static unsigned surprising_sensor(const struct composition_parts *p)
{
    bool complete = composition_filter_gain(p->filter) != NULL;
    return composition_watch_surprising(p->watch, p->sensors,
                                        complete ? p->settings->nis_full : p->settings->nis,
                                        complete && composition_sensors_finds_noise(p->sensors));
}

enum quality composition_judge_step(const struct composition_parts *p, struct block_io *io,
                                    enum err err)
{
    struct composition_judge *j = p->judge;
    const struct composition_settings *s = p->settings;
    real_t h = composition_model_h(p->model);
    unsigned lost = composition_sensors_lost(p->sensors);
    bool settled = composition_judge_is_settled(p), drawn = composition_judge_sees(p);
    bool dry = j->dry;
    j->without = drawn && !dry ? 0 : j->without < UINT32_MAX ? j->without + 1u : j->without;
    bool alone = j->without && (!j->seen || (real_t)j->without * h > s->alone_s);
    if ((settled || composition_watch_steps(p->watch)) && !err)
        composition_watch_step(p->watch, p->sensors);
    bool watched = (real_t)composition_watch_steps(p->watch) * h >= s->watch_s;
    unsigned pulling = watched ? composition_watch_pulling(p->watch, p->sensors, s->pull) : 0;
    unsigned surprising = watched ? surprising_sensor(p) : 0;
    unsigned odd = watched && s->apart > 0
                       ? composition_watch_odd(p->watch, p->sensors, feed_stage_of(p), s->apart)
                       : 0;

    io->requests.raised = 0;
    bool without_room = composition_filter_lacks_workspace(p);
    raise_event(io, EVENT_LOST, lost);
    if (!lost && without_room) {
        io->requests.raised |= 1u << EVENT_LOST;
        io->requests.event_value[EVENT_LOST] = 0.0f;
    }
    raise_event(io, EVENT_ALONE, alone && !drawn ? 1 : 0);
    raise_event(io, EVENT_PULL, pulling);
    raise_event(io, EVENT_NIS, surprising);
    raise_event(io, EVENT_APART, odd);
    raise_event(io, EVENT_NO_STATE, err ? 1 : 0);
    raise_event(io, EVENT_NO_INPUT, j->missing);
    raise_event(io, EVENT_NO_BOIL, dry ? 1 : 0);
    bool doubted = pulling || surprising || odd;
    if (err || alone || (doubted && s->doubt == DOUBT_BAD))
        return QUALITY_BAD;
    return lost || without_room || composition_filter_is_unsure(p) || j->missing || !settled ||
                   doubted || composition_sensors_use_outside(p->sensors)
               ? QUALITY_UNCERTAIN
               : QUALITY_GOOD;
}

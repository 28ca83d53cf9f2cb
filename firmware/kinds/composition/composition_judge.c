/* How good the estimates are, and what is said of them. */
#include "kinds/composition/composition_job.h"

#define ZERO REAL_C(0.0)

/* It counts as settled after so many times 1/lambda. */
#define SETTLED    REAL_C(3.0)
#define STEPS_MOST (1u << 31)
/* Vapour to the condenser that counts as none, part of its holdup in an hour. */
#define LITTLE REAL_C(0.1)
/* Vapour counts as there when it was for so long. */
#define VAPOUR_S     REAL_C(300.0)
#define DRY_STEPS(h) ((uint32_t)(VAPOUR_S / (h)) + 1u)
#define HOUR         REAL_C(3600.0)
/* What is purer counts as so impure: no model knows better. */
#define IMPURITY_LEAST REAL_C(1e-5)
/* How many steps it takes until it counts as settled. */
static real_t steps_to_settle(const struct composition_block *b)
{
    real_t slowest = ZERO;
    for (uint8_t k = 0; k < b->c.sensors; k++) {
        const struct composition_sensor *s = &b->c.sensor[k];
        if (s->moves && s->time > slowest)
            slowest = s->time;
    }
    return SETTLED * slowest / b->c.h;
}

bool composition_is_locked_on(const struct composition_block *b)
{
    return (real_t)b->steps >= steps_to_settle(b);
}

/* How long so much vapour has reached the condenser that what temperatures say does as well. */
static void count_vapour(struct composition_block *b)
{
    const struct composition *c = &b->c;
    size_t top = c->table.config.stages - 1u;
    if (c->column.vapour_flow[top - 1] * HOUR < LITTLE * c->column.holdup[top])
        b->dry = DRY_STEPS(c->h);
    else
        b->dry -= b->dry ? 1u : 0;
}

/* Whether a section that has temperatures is without all of them, or no vapour connects them. */
static bool is_blind(const struct composition_block *b)
{
    const struct composition *c = &b->c;
    bool has[2] = {false, false}, sees[2] = {false, false};
    for (uint8_t k = 0; k < c->sensors; k++) {
        const struct composition_sensor *s = &c->sensor[k];
        unsigned above = composition_is_above_feed(c, s);
        has[above] = has[above] || s->moves;
        sees[above] = sees[above] || composition_draws(s);
    }
    return (has[0] && !sees[0]) || (has[1] && !sees[1]) || b->dry;
}

/* Whether the section of a point has neither a temperature that moves the model nor an analysis: what the model says there nobody
 * contradicts. What is of the feed belongs to no section. */
bool composition_point_is_unseen(const struct composition_block *b, unsigned k)
{
    const struct composition *c = &b->c;
    size_t feed = c->table.config.feed_stage;
    bool above = b->s.point[k][AT_STAGE] > feed;
    for (uint8_t i = 0; i < c->sensors; i++)
        if (c->sensor[i].moves && composition_is_above_feed(c, &c->sensor[i]) == above)
            return false;
    for (uint8_t i = 0; i < b->analyses; i++)
        if ((b->analysis[i].stage + 1u > feed) == above)
            return false;
    return b->s.of[k] == OF_STAGE;
}

/* What was not seen for a while is found again as slowly as it was lost, at most as slowly as in the beginning. */
void composition_count_step(struct composition_block *b, bool failed)
{
    count_vapour(b);
    if (failed) {
        b->steps = 0;
    } else if (!is_blind(b)) {
        b->steps += b->steps < STEPS_MOST ? 1u : 0;
    } else {
        if (composition_is_locked_on(b))
            b->steps = (uint32_t)steps_to_settle(b);
        b->steps -= b->steps ? 1u : 0;
    }
}

/* The number of the first sensor of which this can be said, or 0. */
static unsigned lost_sensor(const struct composition_block *b)
{
    for (uint8_t k = 0; k < b->c.sensors; k++)
        if (b->c.sensor[k].moves && !b->c.sensor[k].there)
            return b->c.sensor[k].input + 1u;
    return 0;
}

static unsigned pulling_sensor(const struct composition_block *b)
{
    for (uint8_t k = 0; k < b->c.sensors; k++) {
        if (b->s.pull > 0 && real_abs(b->c.sensor[k].pull) > b->s.pull)
            return b->c.sensor[k].input + 1u;
    }
    return 0;
}

/* Innovations that are off to one side for long, as far as docs/consistency.md has it: of a model that is trusted none is. */
#define MEAN_MOST REAL_C(0.3)

static unsigned surprising_sensor(const struct composition_block *b)
{
    real_t most = b->c.gains.of ? b->s.nis_full : b->s.nis;
    for (uint8_t k = 0; k < b->c.sensors; k++)
        if (most > ZERO &&
            (b->c.sensor[k].square > most ||
             (b->c.finds_noise && b->c.gains.of && real_abs(b->c.sensor[k].mean) > MEAN_MOST)))
            return b->c.sensor[k].input + 1u;
    return 0;
}

/* By how much innovations are larger than the covariances say; at least 1. */
static real_t innovation_factor(const struct composition *c)
{
    real_t most = REAL_C(1.0);
    for (uint8_t k = 0; k < c->sensors; k++)
        if (composition_draws(&c->sensor[k]) && c->sensor[k].square > most)
            most = c->sensor[k].square;
    return real_sqrt(most);
}

/* Of a point that is a mole fraction of a stage: the smaller of it and what is not of it. Else 0. */
static real_t impurity(const struct composition_block *b, unsigned k)
{
    size_t component = b->s.point[k][OF_COMPONENT];
    if (b->s.of[k] != OF_STAGE || !component)
        return ZERO;
    real_t x = column_fraction(&b->c.column, b->c.x, b->s.point[k][AT_STAGE] - 1u, component - 1u);
    real_t least = x < REAL_C(0.5) ? x : REAL_C(1.0) - x;
    return least > IMPURITY_LEAST ? least : IMPURITY_LEAST;
}

/* Then what the model is off by there is found. */
static bool is_analysed(const struct composition_block *b, unsigned k)
{
    bool is = false;
    for (uint8_t i = 0; i < b->analyses; i++)
        is = is || (b->analysis[i].stage + 1u == b->s.point[k][AT_STAGE] &&
                    b->analysis[i].component + 1u == b->s.point[k][OF_COMPONENT]);
    return is;
}

real_t composition_point_sd(const struct composition_block *b, unsigned k)
{
    real_t lasting = is_analysed(b, k) ? ZERO : b->s.lasting * impurity(b, k);
    real_t sd = b->filter.sd[k] * innovation_factor(&b->c);
    return real_sqrt(sd * sd + lasting * lasting);
}

bool composition_point_is_unsure(const struct composition_block *b, unsigned k)
{
    real_t least = impurity(b, k), sd = composition_point_sd(b, k);
    if (!composition_is_complete(&b->c) || !(least > ZERO))
        return false;
    return (b->s.sure > 0 && sd > b->s.sure) || (b->s.sure_part > 0 && sd > b->s.sure_part * least);
}

/* One that is drawn to although it is far away: it was believed in the end, or at once in the beginning. */
static bool believes_one_far_off(const struct composition *c)
{
    for (uint8_t k = 0; k < c->sensors; k++) {
        const struct composition_sensor *s = &c->sensor[k];
        if (composition_draws(s) && composition_is_far(c, s))
            return true;
    }
    return false;
}

/* Whether a temperature moves anything in this step; remembered. */
bool composition_is_drawn(struct composition_block *b)
{
    bool drawn = false;
    for (uint8_t k = 0; k < b->c.sensors; k++)
        drawn = drawn || composition_draws(&b->c.sensor[k]);
    b->seen = b->seen || drawn;
    return drawn;
}

void composition_raise(struct block_io *io, unsigned event, unsigned value)
{
    if (!value)
        return;
    io->raised = (uint16_t)(io->raised | 1u << event);
    io->event_value[event] = (float)value;
}

/* Events, and how good the estimates are. */
enum quality composition_judge(struct composition_block *b, struct block_io *io, enum err err)
{
    unsigned lost = lost_sensor(b);
    bool settled = composition_is_locked_on(b), drawn = composition_is_drawn(b), dry = b->dry;
    b->without = drawn && !dry ? 0 : b->without < UINT32_MAX ? b->without + 1u : b->without;
    bool alone = b->without && (!b->seen || (real_t)b->without * b->c.h > b->s.alone_s);
    if ((settled || b->c.watched) && !err)
        composition_watch(&b->c);
    bool watched = (real_t)b->c.watched * b->c.h >= b->s.watch_s;
    unsigned pulling = watched ? pulling_sensor(b) : 0;
    unsigned surprising = watched ? surprising_sensor(b) : 0;
    unsigned odd = watched && b->s.apart > 0 ? composition_odd_sensor(&b->c, b->s.apart) : 0;

    io->raised = 0;
    bool without_room = composition_lacks_workspace(b);
    composition_raise(io, EVENT_LOST, lost);
    if (!lost && without_room) {
        io->raised |= 1u << EVENT_LOST;
        io->event_value[EVENT_LOST] = 0.0f;
    }
    composition_raise(io, EVENT_ALONE, alone && !drawn ? 1 : 0);
    composition_raise(io, EVENT_PULL, pulling);
    composition_raise(io, EVENT_NIS, surprising);
    composition_raise(io, EVENT_APART, odd);
    composition_raise(io, EVENT_NO_STATE, err ? 1 : 0);
    composition_raise(io, EVENT_NO_INPUT, b->missing);
    composition_raise(io, EVENT_NO_BOIL, dry ? 1 : 0);
    bool doubted = pulling || surprising || odd;
    if (err || alone || (doubted && b->s.doubt == DOUBT_BAD))
        return QUALITY_BAD;
    return lost || without_room || composition_is_unsure(b) || b->missing || !settled || doubted ||
                   believes_one_far_off(&b->c)
               ? QUALITY_UNCERTAIN
               : QUALITY_GOOD;
}

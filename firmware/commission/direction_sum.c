#include "commission/direction_sum.h"

#include "base/assertion.h"
#include "base/error.h"
#include "commission/commission_state.h"
#include "commission/experiment.h"
#include "commission/test_inputs.h"

#define POINTS_LEAST     6u
#define CORRELATION_MOST REAL_C(0.9)

static const struct shape *single_shape(const struct commission *c, uint8_t j, uint8_t k)
{
    REFLUX_ASSERT(j < CHANNEL_MAX && k < CHANNEL_MAX);
    return &c->work->element[j][k].found.shape;
}

real_t direction_response(const struct commission *c, uint8_t j, real_t t_s)
{
    real_t sum = REAL_C(0.0);
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++) {
        const struct shape *s = single_shape(c, j, k);
        real_t gone_s = t_s - s->dead_time_s, left = REAL_C(0.0);
        if (gone_s <= REAL_C(0.0))
            continue;
        if (s->lag_s > REAL_C(0.0))
            left = real_exp(-gone_s / s->lag_s);
        sum += c->work->share[k] * s->gain * (REAL_C(1.0) - left);
    }
    return sum;
}

real_t direction_end(const struct commission *c, uint8_t j)
{
    real_t sum = REAL_C(0.0);
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++)
        sum += c->work->share[k] * single_shape(c, j, k)->gain;
    return sum;
}

NOT_INLINE real_t direction_over_s(const struct commission *c, uint8_t j, real_t lags)
{
    real_t longest_s = REAL_C(0.0);
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++) {
        const struct shape *s = single_shape(c, j, k);
        real_t over_s = s->dead_time_s + lags * s->lag_s;
        if (real_abs(c->work->share[k]) > REAL_C(0.0) && over_s > longest_s)
            longest_s = over_s;
    }
    return longest_s;
}

/* Variance of the response that the model still expects after DIRECTION_LAGS lags, by the errors of the time constants. */
static real_t variance_to_come(const struct commission *c, uint8_t j)
{
    real_t sum = REAL_C(0.0), left = DIRECTION_LAGS * real_exp(-DIRECTION_LAGS);
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++) {
        const struct shape *s = single_shape(c, j, k);
        if (!(s->lag_s > REAL_C(0.0)))
            continue;
        real_t sd_s = element_lag_sd_s(&c->work->element[j][k].found);
        real_t part = c->work->share[k] * s->gain * left * sd_s / s->lag_s;
        sum += part * part;
    }
    return sum;
}

/* The end of an output's response to the direction, and the time it takes, s. */
struct response_end {
    real_t over_s, level;
};

/* Finds the level of the direction at point i of the record, and what is still to come of the responses to all edges, by the
 * model. False: an edge is too near. */
static bool level_of_point(const struct commission *c, uint8_t j, const struct response_end *end,
                           uint32_t i, real_t *level, real_t *to_come)
{
    const struct record *r = experiment_record(&c->work->experiment);
    real_t half_s = REAL_C(0.5) * (real_t)r->block * r->h_s, at_s = record_time(r, i);
    *level = *to_come = REAL_C(0.0);
    for (uint32_t k = 0; k < r->input.edges; k++) {
        real_t since_s = at_s - (real_t)r->input.edge[k].sample * r->h_s;
        if (since_s + half_s <= REAL_C(0.0))
            continue;
        if (since_s - half_s < end->over_s)
            return false;
        *level += r->input.edge[k].change;
        *to_come += r->input.edge[k].change * (direction_response(c, j, since_s) - end->level);
    }
    return true;
}

/* Sums over the points at which the responses are over. rr and r1 sum what the gain leaves of them. */
struct sums {
    real_t uu, u, ut, uy, rr, r1;
    uint32_t n;
};

NOT_INLINE static void add_points(const struct commission *c, uint8_t j, const struct baseline *b,
                                  real_t gain, struct sums *s)
{
    const struct record *r = experiment_record(&c->work->experiment);
    const struct response_end end = {.over_s = direction_over_s(c, j, DIRECTION_LAGS),
                                     .level = direction_end(c, j)};
    real_t before = REAL_C(0.0);
    *s = (struct sums){0};
    for (uint32_t i = 0; i < r->points; i++) {
        real_t level, to_come, at_s = record_time(r, i);
        if (!level_of_point(c, j, &end, i, &level, &to_come) || !(real_abs(level) > REAL_C(0.0)))
            continue;
        real_t y = r->y[j][i] - b->offset - b->slope_per_s * at_s - to_come;
        real_t left = y - gain * level;
        s->uu += level * level;
        s->u += level;
        s->ut += level * at_s;
        s->uy += level * y;
        s->rr += left * left;
        s->r1 += left * before;
        before = left;
        s->n++;
    }
}

bool direction_plateau(const struct commission *c, uint8_t j, real_t *gain)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    struct baseline b;
    struct sums s;
    if (experiment_baseline(&c->work->experiment, j, &b) != ERR_OK)
        return false;
    add_points(c, j, &b, REAL_C(0.0), &s);
    if (s.n < POINTS_LEAST)
        return false;
    *gain = s.uy / s.uu;
    return real_is_finite(*gain);
}

bool direction_plateau_sd(const struct commission *c, uint8_t j, real_t gain, real_t *sd)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    const struct record *r = experiment_record(&c->work->experiment);
    struct baseline b;
    struct sums s;
    if (experiment_baseline(&c->work->experiment, j, &b) != ERR_OK)
        return false;
    add_points(c, j, &b, gain, &s); /* again, because the residuals need the gain */
    real_t noise = b.noise_sd * b.noise_sd / (real_t)r->block;
    real_t variance = s.rr / (real_t)(s.n - 1u), together = s.r1 / s.rr;
    if (!(variance > noise))
        variance = noise;
    if (!(together > REAL_C(0.0))) /* also where nothing is left */
        together = REAL_C(0.0);
    if (together > CORRELATION_MOST)
        together = CORRELATION_MOST;
    variance *= (REAL_C(1.0) + together) / (REAL_C(1.0) - together);
    real_t offset = b.offset_sd * s.u / s.uu, slope = b.slope_sd_per_s * s.ut / s.uu;
    *sd = real_sqrt(variance / s.uu + offset * offset + slope * slope + variance_to_come(c, j));
    return real_is_finite(*sd);
}

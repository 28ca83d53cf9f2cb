#include "design/members.h"

#include "num/random.h"

#define DEVIATE_MOST REAL_C(3.0)
#define TIME_MOST_S  REAL_C(1e6)
/* A gain keeps its sign and this part of its size. */
#define GAIN_KEPT REAL_C(0.05)

static real_t deviate(struct random *random)
{
    real_t x = random_normal(random);
    return x > DEVIATE_MOST ? DEVIATE_MOST : x < -DEVIATE_MOST ? -DEVIATE_MOST : x;
}

/* Standard deviation of a value with a relative floor. */
static real_t with_floor(real_t value, real_t sd, real_t floor)
{
    real_t part = floor * value;
    return real_sqrt(sd * sd + part * part);
}

static real_t draw_gain(real_t gain, real_t sd, struct random *random)
{
    real_t drawn = gain + sd * deviate(random), least = GAIN_KEPT * gain;
    if (gain > REAL_C(0.0))
        return drawn > least ? drawn : least;
    if (gain < REAL_C(0.0))
        return drawn < least ? drawn : least;
    return drawn;
}

/* Factor on a time, above 0. */
static real_t draw_factor(real_t time_s, real_t sd_s, struct random *random)
{
    real_t x = deviate(random);
    if (!(time_s > REAL_C(0.0)))
        return REAL_C(1.0);
    x *= sd_s / time_s;
    return x > REAL_C(0.0) ? REAL_C(1.0) + x : REAL_C(1.0) / (REAL_C(1.0) - x);
}

static real_t time_at_most(real_t time_s)
{
    return time_s < TIME_MOST_S ? time_s : TIME_MOST_S;
}

static void draw_element(const struct members *m, size_t i, size_t j, struct random *random,
                         struct interact_plant *drawn)
{
    struct fopdt *e = &drawn->element[i][j];
    struct interact_shape *shape = &drawn->shape[i][j];
    real_t lag_sd = m->errors ? m->errors->time_constant_s[i][j] : REAL_C(0.0);
    real_t dead_sd = m->errors ? m->errors->dead_time_s[i][j] : REAL_C(0.0);
    e->gain = draw_gain(e->gain, with_floor(e->gain, drawn->gain_sd[i][j], m->floor), random);
    real_t lag =
        draw_factor(e->time_constant_s, with_floor(e->time_constant_s, lag_sd, m->floor), random);
    real_t dead =
        draw_factor(e->dead_time_s, with_floor(e->dead_time_s, dead_sd, m->floor), random);
    if (lag * e->time_constant_s > TIME_MOST_S)
        lag = TIME_MOST_S / e->time_constant_s;
    e->time_constant_s = time_at_most(e->time_constant_s * lag);
    e->dead_time_s = time_at_most(e->dead_time_s * dead);
    shape->zero_s *= lag;
    shape->square_s2 *= lag * lag;
}

void members_draw(const void *context, uint16_t member, uint8_t output,
                  struct interact_plant *drawn)
{
    const struct members *m = context;
    struct random random = random_from(m->seed + ((uint64_t)member * INTERACT_MAX + output + 1u) *
                                                     UINT64_C(0xD1342543DE82EF95));
    if (output == 0)
        *drawn = *m->plant;
    for (size_t j = 0; j < drawn->inputs; j++)
        draw_element(m, output, j, &random, drawn);
}

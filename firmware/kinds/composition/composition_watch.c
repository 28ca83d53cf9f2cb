/* Monitor of the estimator: whether what the sensors say goes on being what the model expects, and whether they agree. */
#include "kinds/composition/composition.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

static real_t expected(const struct composition *c, const struct composition_sensor *s)
{
    return c->method != METHOD_GEOMETRIC && s->moves && s->spread > ZERO ? s->spread : s->noise2;
}

/* The readings' own noise, as fast as the column is not: what the innovations swing by about their mean of so many steps. */
#define SLOW_STEPS REAL_C(20.0)

static void read_noise(const struct composition *c, struct composition_sensor *s, real_t weight)
{
    real_t off = s->e - s->slow;
    s->slow += off / SLOW_STEPS;
    s->swing += weight * (off * off - s->swing);
    if (c->finds_noise)
        s->noise2 = s->swing < NOISE_LEAST2 ? NOISE_LEAST2 : s->swing;
}

void composition_watch(struct composition *c)
{
    if (c->watched < UINT32_MAX)
        c->watched++;
    real_t first = ONE / (real_t)c->watched;
    real_t weight = first > c->weight ? first : c->weight;
    for (uint8_t k = 0; k < c->sensors; k++) {
        struct composition_sensor *s = &c->sensor[k];
        if (!s->there)
            continue;
        if (c->watched == 1)
            s->slow = s->e;
        real_t of = expected(c, s);
        read_noise(c, s, weight);
        s->mean += weight * (s->e / real_sqrt(of) - s->mean);
        s->pull += weight * (s->correction * REAL_C(3600.0) - s->pull);
        s->square += weight * (s->e * s->e / of - s->square);
        s->product += weight * (s->e * s->last / of - s->product);
        s->last = s->e;
    }
}

static bool counts(const struct composition *c, const struct composition_sensor *s, bool above)
{
    return composition_draws(s) && composition_is_above_feed(c, s) == above;
}

/* Of the sensors of a section: how many, the least and the largest correction. */
static unsigned section(const struct composition *c, bool above, real_t *least, real_t *most)
{
    unsigned n = 0;
    for (uint8_t k = 0; k < c->sensors; k++) {
        const struct composition_sensor *s = &c->sensor[k];
        if (!counts(c, s, above))
            continue;
        *least = n == 0 || s->pull < *least ? s->pull : *least;
        *most = n == 0 || s->pull > *most ? s->pull : *most;
        n++;
    }
    return n;
}

/* Farthest from the mean of the others, which is the same as from the mean of all. */
static unsigned farthest(const struct composition *c, bool above, unsigned n)
{
    real_t mean = ZERO, far = -ONE;
    unsigned at = 0;
    for (uint8_t k = 0; k < c->sensors; k++)
        if (counts(c, &c->sensor[k], above))
            mean += c->sensor[k].pull / (real_t)n;
    for (uint8_t k = 0; k < c->sensors; k++) {
        real_t away = real_abs(c->sensor[k].pull - mean);
        if (counts(c, &c->sensor[k], above) && away > far) {
            far = away;
            at = c->sensor[k].input + 1u;
        }
    }
    return at;
}

unsigned composition_odd_sensor(const struct composition *c, real_t most)
{
    for (unsigned above = 0; above < 2; above++) {
        real_t least = ZERO, largest = ZERO;
        unsigned n = section(c, above != 0, &least, &largest);
        if (n > 1 && largest - least > most)
            return farthest(c, above != 0, n);
    }
    return 0;
}

/* Monitor of the estimator: whether what the sensors say goes on being what the model expects. Means over the last `watch` seconds. */
#include "estimate/composition.h"

#if CONFIG_BLOCKS

#define ZERO REAL_C(0.0)

real_t composition_pull(const struct composition_sensor *s)
{
    return s->ki * s->sum * REAL_C(3600.0);
}

static real_t expected(const struct composition *c, const struct composition_sensor *s)
{
    return c->method == METHOD_REKF && s->moves && s->spread > ZERO ? s->spread : c->noise2;
}

void composition_watch(struct composition *c)
{
    for (uint8_t k = 0; k < c->sensors; k++) {
        struct composition_sensor *s = &c->sensor[k];
        if (!s->there)
            continue;
        real_t of = expected(c, s);
        s->mean += c->weight * (s->e - s->mean);
        s->square += c->weight * (s->e * s->e / of - s->square);
        s->product += c->weight * (s->e * s->last / of - s->product);
        s->last = s->e;
    }
}

#endif

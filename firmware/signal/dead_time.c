#include "signal/dead_time.h"

#include "signal/check.h"

static enum err split_dead_time(float dead_time_s, float h_s, uint32_t *whole, float *fraction)
{
    enum err err = check_range(dead_time_s, 0.0f, 1e6f);
    if (err)
        return err;
    err = check_interval(h_s);
    if (err)
        return err;
    float steps = dead_time_s / h_s;
    if (steps > (float)DEAD_TIME_MAX_STEPS)
        return ERR_RANGE;
    *whole = (uint32_t)steps;
    *fraction = steps - (float)*whole;
    /* 0.3 / 0.1 is not 3 in floating point; nobody means the difference. */
    if (*fraction < 1.0f / 1024.0f) {
        *fraction = 0.0f;
    } else if (*fraction > 1023.0f / 1024.0f) {
        *fraction = 0.0f;
        *whole += 1;
    }
    return ERR_OK;
}

size_t dead_time_bytes(float dead_time_s, float h_s)
{
    uint32_t whole;
    float fraction;
    if (split_dead_time(dead_time_s, h_s, &whole, &fraction))
        return 0;
    return ((size_t)whole + 2u) * sizeof(num_t);
}

enum err dead_time_init(struct dead_time *f, float dead_time_s, float h_s, num_t *ring,
                        size_t bytes)
{
    uint32_t whole;
    float fraction;
    enum err err = split_dead_time(dead_time_s, h_s, &whole, &fraction);
    if (err)
        return err;
    if (!ring || bytes < ((size_t)whole + 2u) * sizeof(num_t))
        return ERR_MEMORY;
    f->ring = ring;
    f->length = whole + 2u;
    f->whole = whole;
    f->fraction = num_from_float(fraction);
    dead_time_reset(f, num_zero());
    return ERR_OK;
}

num_t *dead_time_place(struct dead_time *f, num_t *ring)
{
    f->ring = ring;
    return ring + f->length;
}

void dead_time_reset(struct dead_time *f, num_t value)
{
    for (uint32_t i = 0; i < f->length; i++)
        f->ring[i] = value;
    f->head = 0;
}

num_t dead_time_step(struct dead_time *f, num_t x)
{
    f->ring[f->head] = x;
    uint32_t newer = f->head >= f->whole ? f->head - f->whole : f->head + f->length - f->whole;
    uint32_t older = newer > 0 ? newer - 1u : f->length - 1u;
    f->head = f->head + 1u < f->length ? f->head + 1u : 0;
    num_t a = f->ring[newer];
    num_t b = f->ring[older];
    /* a + fraction (b - a): exactly a when both are equal */
    return num_add(a, num_mul(f->fraction, num_sub(b, a)));
}

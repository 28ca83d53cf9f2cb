#include "commission/test_outputs.h"

#include "base/assertion.h"
#include "base/elapsed.h"
#include "commission/channels.h"
#include "commission/test_outputs_state.h"

void outputs_begin(struct test_outputs *t, const struct supervisor *s)
{
    t->plan_serial = s->plan->serial;
    t->channels = commission_channels(&s->plan->config);
    t->safe_count = s->safe_count;
}

void outputs_add(struct test_outputs *t, uint8_t measurement)
{
    REFLUX_ASSERT(t->n < CHANNEL_MAX);
    t->measurement[t->n++] = measurement;
}

const char *outputs_name(const struct test_outputs *t, const struct supervisor *s, uint8_t j)
{
    REFLUX_ASSERT(j < t->n);
    return s->plan->config.measurement[t->measurement[j]].name;
}

bool outputs_are_those_of(const struct test_outputs *t, const struct config *config)
{
    return commission_channels(config) == t->channels;
}

void outputs_watch_spans(struct test_outputs *t, const struct supervisor *s)
{
    uint32_t ends = 0;
    for (uint8_t j = 0; j < t->n; j++)
        if (s->measurement[t->measurement[j]].seen && channel_is_at_end(s, t->measurement[j]))
            ends |= UINT32_C(1) << j;
    t->ends_again = t->ends & ends;
    t->ends = ends;
}

int outputs_at_end(const struct test_outputs *t)
{
    for (uint8_t j = 0; j < t->n; j++)
        if (t->ends_again >> j & 1u)
            return j;
    return -1;
}

void outputs_read(const struct test_outputs *t, const struct supervisor *s, real_t *y)
{
    for (uint8_t j = 0; j < t->n; j++)
        y[j] = num_to_float(s->measurement[t->measurement[j]].value);
}

static real_t unseen_s(const struct test_outputs *t, const struct supervisor *s)
{
    return elapsed_ms(s->time_ms, t->sample_ms) / REAL_C(1000.0);
}

uint32_t outputs_see_sample(struct test_outputs *t, const struct supervisor *s)
{
    uint32_t samples = commission_samples(s, unseen_s(t, s));
    outputs_mark_sample(t, s);
    return samples;
}

void outputs_age_origin(struct test_outputs *t, struct origin *origin, const struct supervisor *s)
{
    if (origin_is_fixed(origin))
        origin_grow_older(origin, unseen_s(t, s));
    outputs_mark_sample(t, s);
}

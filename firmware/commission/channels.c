#include "commission/channels.h"

#include "base/assertion.h"
#include "base/crc32.h"

#define END_SHARE 2.5e-4f /* of a span, from its end: a step of a converter of 12 bits */

uint32_t commission_samples(const struct supervisor *s, real_t seconds)
{
    return (uint32_t)(seconds / s->plan->tick_s + REAL_C(0.5));
}

uint32_t commission_longest(const struct supervisor *s)
{
    real_t longest_s = s->plan->config.test.longest_s;
    return longest_s > REAL_C(0.0) ? commission_samples(s, longest_s) : COMMISSION_HALF_MOST;
}

real_t commission_test_base(const struct supervisor *s, uint8_t j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return num_to_float(s->mv[j].manual);
}

uint32_t commission_channels(const struct config *config)
{
    uint32_t sum = 0;
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        const struct measurement_config *m = &config->measurement[i];
        const struct mv_config *o = &config->mv[i];
        float span[] = {m->lo, m->hi, o->lo, o->hi};
        sum = crc32_update(sum, m->name, sizeof m->name);
        sum = crc32_update(sum, o->name, sizeof o->name);
        sum = crc32_update(sum, span, sizeof span);
    }
    return sum;
}

real_t commission_room(const struct supervisor *s, uint8_t j, real_t held)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    const struct mv_config *o = &s->plan->config.mv[j];
    real_t lo = (o->min - o->lo) / (o->hi - o->lo), hi = (o->max - o->lo) / (o->hi - o->lo);
    return held - lo < hi - held ? held - lo : hi - held;
}

real_t commission_limit(const struct measurement_config *m)
{
    real_t limit =
        m->start_up.limit > 0.0f ? m->start_up.limit / (m->hi - m->lo) : TEST_LIMIT_DEFAULT;
    return m->start_up.critical ? REAL_C(0.5) * limit : limit;
}

bool commission_input_is_tested(const struct supervisor *s, uint8_t j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    const struct mv_config *o = &s->plan->config.mv[j];
    return o->name[0] && o->start_up.test && s->mv[j].bound;
}

bool commission_measurement_is_tested(const struct supervisor *s, uint8_t i)
{
    REFLUX_ASSERT(i < CHANNEL_MAX);
    const struct measurement_config *m = &s->plan->config.measurement[i];
    return m->name[0] && m->start_up.test && s->measurement[i].bound;
}

bool channel_is_valid(const struct supervisor *s, uint8_t i)
{
    REFLUX_ASSERT(i < CHANNEL_MAX);
    return s->measurement[i].seen && s->measurement[i].quality == QUALITY_GOOD;
}

bool channel_is_at_end(const struct supervisor *s, uint8_t i)
{
    REFLUX_ASSERT(i < CHANNEL_MAX);
    const struct measurement_config *m = &s->plan->config.measurement[i];
    float margin = END_SHARE * (m->hi - m->lo), raw = s->measurement[i].raw;
    return raw <= m->lo + margin || raw >= m->hi - margin;
}

/* Measurements that come every n-th base tick, some time after they were sampled: analysers (docs/use/analysers.md). The
 * link has no word for "this number is new", so the configuration says when a number is new: `every`, `phase` and
 * `delay`, in base ticks of plant time. Between two of its samples a measurement keeps its value and its quality. */
#ifndef REFLUX_EXCHANGE_SAMPLING_H
#define REFLUX_EXCHANGE_SAMPLING_H

#include "base/elapsed.h"
#include "exchange/state.h"

/* Returns the base ticks from one sample to the next; 1 = a sample in each tick. */
#if CONFIG_ANALYSERS
static inline uint16_t sampling_every(const struct measurement_config *c)
{
    return c->analyser.every;
}
/* For `every` above 1: returns true if the tick has looked at a reading. */
static inline bool sampling_is_fresh(const struct measurement_state *m)
{
    return m->analyser.fresh;
}
/* Returns the base ticks from sampling to coming. */
static inline uint16_t sampling_delay(const struct measurement_config *c)
{
    return c->analyser.delay;
}

static inline uint32_t sampling_tick_ms(const struct plan *plan)
{
    return (uint32_t)(plan->tick_s * 1000.0f + 0.5f);
}
/* Returns the plant time at which the sample came that the tick looks at, or has last looked at. */
static inline uint64_t sampling_ms(const struct supervisor *s, const struct measurement_state *m,
                                   const struct measurement_config *c)
{
    return sampling_every(c) > 1 ? m->analyser.sample_ms : s->time_ms;
}
/* Returns true for an analyser without a new reading in this tick. Its filter then makes no step. */
static inline bool sampling_stands(const struct supervisor *s, uint8_t i)
{
    return sampling_every(&s->plan->config.measurement[i]) > 1 && !s->measurement[i].analyser.fresh;
}
#else

#define sampling_every(c)      ((void)(c), (uint16_t)1)
#define sampling_is_fresh(m)   ((void)(m), false)
#define sampling_delay(c)      ((void)(c), (uint16_t)0)
#define sampling_tick_ms(plan) ((void)(plan), 0u)
#define sampling_stands(s, i)  ((void)(s), (void)(i), false)
#define sampling_ms(s, m, c)   ((s)->time_ms)

#endif

/* Returns the seconds without a valid sample where one should have come; it is a base tick for the first one. For a
 * measurement that comes in each tick, this is the age of the last valid sample. */
static inline float sampling_without_s(const struct supervisor *s, uint8_t i)
{
    float since = elapsed_ms(s->time_ms, s->measurement[i].valid_ms) / 1000.0f;
    if (CONFIG_ANALYSERS)
        since -= (float)(sampling_every(&s->plan->config.measurement[i]) - 1) * s->plan->tick_s;
    return since;
}

/* Returns the plant time at which the last valid reading was sampled, ms. The result means nothing before the
 * first. */
static inline uint64_t sampling_at_ms(const struct supervisor *s, uint8_t i)
{
    uint64_t came_ms = s->measurement[i].valid_ms;
    if (!CONFIG_ANALYSERS)
        return came_ms;
    uint64_t delay_ms =
        (uint64_t)sampling_delay(&s->plan->config.measurement[i]) * sampling_tick_ms(s->plan);
    return delay_ms < came_ms ? came_ms - delay_ms : 0;
}

#endif

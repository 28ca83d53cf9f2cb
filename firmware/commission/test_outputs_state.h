/* The state of test_outputs.c. */
#ifndef REFLUX_COMMISSION_TEST_OUTPUTS_STATE_H
#define REFLUX_COMMISSION_TEST_OUTPUTS_STATE_H

#include "base/assertion.h"
#include "exchange/config.h"
#include "num/real.h"
#include "supervise/supervisor.h"

struct test_outputs {
    uint64_t sample_ms;               /* plant time of the last sample that a test has seen */
    real_t noise_sd[CHANNEL_MAX];     /* fraction of span */
    uint8_t measurement[CHANNEL_MAX]; /* index in the configuration */
    uint8_t n;
    uint32_t plan_serial; /* of the plan that the tests belong to */
    uint32_t channels;    /* commission_channels() of its configuration */
    uint32_t safe_count;  /* how often the safe state had been taken by then */
    /* Bit j: output j reads an end of its span; and did so in the sample before, too. */
    uint32_t ends, ends_again;
};

static inline uint8_t outputs_count(const struct test_outputs *t)
{
    return t->n;
}

/* Index of output j in the configuration. */
static inline uint8_t outputs_measurement(const struct test_outputs *t, unsigned j)
{
    REFLUX_ASSERT(j < t->n);
    return t->measurement[j];
}

/* That plan is in force. */
static inline bool outputs_plan_in_force(const struct test_outputs *t, const struct supervisor *s)
{
    return s->plan->serial == t->plan_serial;
}

/* The safe state was taken since; it may have been left again. */
static inline bool outputs_were_safe(const struct test_outputs *t, const struct supervisor *s)
{
    return s->safe_count != t->safe_count;
}

/* This sample is seen, whatever came before. */
static inline void outputs_mark_sample(struct test_outputs *t, const struct supervisor *s)
{
    t->sample_ms = s->time_ms;
}

/* Noise of every output, standard deviation, fraction of span. */
static inline const real_t *outputs_noise(const struct test_outputs *t)
{
    return t->noise_sd;
}

static inline void outputs_set_noise(struct test_outputs *t, unsigned j, real_t sd)
{
    REFLUX_ASSERT(j < t->n);
    t->noise_sd[j] = sd;
}

/* From now on a trial runs in the plan of that serial. */
static inline void outputs_begin_trial(struct test_outputs *t, const struct supervisor *s,
                                       uint32_t serial)
{
    t->plan_serial = serial;
    t->safe_count = s->safe_count;
}

#endif

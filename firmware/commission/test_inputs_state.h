/* The state of test_inputs.c. */
#ifndef REFLUX_COMMISSION_TEST_INPUTS_STATE_H
#define REFLUX_COMMISSION_TEST_INPUTS_STATE_H

#include "base/assertion.h"
#include "commission/tested_input.h"
#include "exchange/config.h"

struct test_inputs {
    struct tested_input input[CHANNEL_MAX];
    uint8_t order[CHANNEL_MAX]; /* index in input[] by turn */
    uint8_t n;
    uint8_t turn;        /* index in order[] */
    uint8_t round;       /* from 1 */
    bool only_unsettled; /* this round is for inputs that want longer tests */
    bool direction;      /* one is lined up behind the inputs */
    uint16_t tests;      /* tests that are over, repeated ones included */
    real_t tested_s;     /* duration of all of them, with their rests */
    uint32_t half_least; /* samples that the slowest known response takes */
};

static inline uint8_t inputs_count(const struct test_inputs *t)
{
    return t->n;
}

static inline const struct tested_input *inputs_get(const struct test_inputs *t, unsigned k)
{
    REFLUX_ASSERT(k < CHANNEL_MAX);
    return &t->input[k];
}

/* A direction of the inputs is tested as well: direction.h. Its number is inputs_count(). */
static inline bool inputs_has_direction(const struct test_inputs *t)
{
    return t->direction;
}

/* Number of turns in a round: inputs, and the direction. */
static inline uint8_t inputs_slots(const struct test_inputs *t)
{
    return (uint8_t)(t->n + t->direction);
}

/* Number of the input whose turn it is. */
static inline uint8_t inputs_current(const struct test_inputs *t)
{
    REFLUX_ASSERT(t->turn < inputs_slots(t));
    return t->order[t->turn];
}

static inline uint8_t inputs_turn(const struct test_inputs *t)
{
    return t->turn;
}

static inline uint8_t inputs_round(const struct test_inputs *t)
{
    return t->round;
}

/* The next one by turn is input k. */
static inline void inputs_line_up(struct test_inputs *t, unsigned turn, uint8_t k)
{
    REFLUX_ASSERT(turn < CHANNEL_MAX && k < CHANNEL_MAX);
    t->order[turn] = k;
}

/* It is the direction's turn. */
static inline bool inputs_is_direction(const struct test_inputs *t)
{
    return t->direction && t->turn < inputs_slots(t) && t->order[t->turn] == t->n;
}

/* There is an input before this one. */
static inline bool inputs_can_repeat(const struct test_inputs *t)
{
    return t->turn > 0;
}

/* Number of tests that are over. */
static inline unsigned inputs_tests(const struct test_inputs *t)
{
    return t->tests;
}

/* Samples that the slowest known response takes. */
static inline uint32_t inputs_half_least(const struct test_inputs *t)
{
    return t->half_least;
}

static inline void inputs_set_half_least(struct test_inputs *t, uint32_t samples)
{
    t->half_least = samples;
}

static inline void inputs_set_unsettled(struct test_inputs *t, unsigned k, bool unsettled)
{
    REFLUX_ASSERT(k < t->n);
    t->input[k].unsettled = unsettled;
}

#endif

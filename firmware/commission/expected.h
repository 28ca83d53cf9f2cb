/* Forecast of a start-up before anything moves: step sizes and durations. Main loop, under hal_tick_lock. */
#ifndef REFLUX_COMMISSION_EXPECTED_H
#define REFLUX_COMMISSION_EXPECTED_H

#include "num/real.h"
#include "supervise/supervisor.h"

struct commission;

struct expected_input {
    bool tested;
    real_t test_base;    /* fraction of span; the steps go both ways from it */
    real_t first;        /* amplitude of the first step, fraction of span */
    real_t most;         /* largest amplitude to which it may grow, likewise */
    real_t least_s;      /* shortest duration of one test, by the times that are known */
    real_t most_s;       /* longest duration of one test, by the longest half allowed */
    uint16_t tests_most; /* in all rounds, with all repetitions */
};

struct expected {
    uint8_t inputs, outputs;
    real_t least_s; /* all inputs once */
    real_t most_s;  /* all tests that there may be, without the trial */
};

/* Manipulated variable j, by the settings in force. */
struct expected_input expected_of_input(const struct supervisor *s, uint8_t j);
/* All tests. */
struct expected expected_of(const struct supervisor *s);

/* Time left while start-up tests: by the mean duration of the tests before; until the first is done, by the plan. */
struct expected_left {
    bool planned;   /* no test is done: shortest and longest time by the plan */
    real_t round_s; /* of this round */
    real_t most_s;  /* of all rounds that may come */
};

struct expected_left expected_left(const struct commission *c, const struct supervisor *s);

#endif

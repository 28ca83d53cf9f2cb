/* What a start-up would do to the plant, before anything moves: by how much, and for how long. */
#ifndef REFLUX_COMMISSION_EXPECTED_H
#define REFLUX_COMMISSION_EXPECTED_H

#include "num/real.h"
#include "supervise/supervisor.h"

struct commission;

struct expected_input {
    bool tested;
    real_t test_base; /* fraction of span; goes both ways from there */
    real_t first,
        most; /* amplitude of the first step, and of the largest it may grow to, likewise */
    real_t least_s, most_s; /* of one test: at the least times known, and at the longest allowed */
    uint16_t tests_most;    /* in all rounds, and each made again as often as it may be */
};

struct expected {
    uint8_t inputs, outputs;
    real_t least_s; /* all inputs once */
    real_t most_s;  /* all tests there may be; the trial comes on top */
};

/* Manipulated variable j, by the settings in force. Main loop, under hal_tick_lock; so is expected_of. */
struct expected_input expected_of_input(const struct supervisor *s, uint8_t j);
/* All of it. */
struct expected expected_of(const struct supervisor *s);

/* While it tests: what is left by what the tests before took on average; before the first is done, by the plan. */
struct expected_left {
    bool planned;   /* no test is done: at least and at most, by the plan */
    real_t round_s; /* of this round */
    real_t most_s;  /* ... and of all that may come */
};

/* Likewise. */
struct expected_left expected_left(const struct commission *c, const struct supervisor *s);

#endif

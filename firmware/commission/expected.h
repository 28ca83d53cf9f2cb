/* What a start-up would do to the plant, before anything moves: by how much, and for how long. */
#ifndef REFLUX_COMMISSION_EXPECTED_H
#define REFLUX_COMMISSION_EXPECTED_H

#include "num/real.h"
#include "supervise/supervisor.h"

struct expected_input {
    bool tested;
    real_t test_base; /* fraction of span; goes both ways from there */
    real_t first,
        most; /* amplitude of the first step, and of the largest it may grow to, likewise */
    real_t least_s, most_s; /* of one test: at the least times known, and at the longest allowed */
};

struct expected {
    uint8_t inputs, outputs;
    real_t least_s; /* all inputs once */
    real_t
        most_s; /* ... in all rounds; a test that is made again comes on top, and so does the trial */
};

/* Manipulated variable j, by the settings in force. Main loop, under hal_tick_lock; so is expected_of. */
struct expected_input expected_of_input(const struct supervisor *s, uint8_t j);
/* All of it. */
struct expected expected_of(const struct supervisor *s);

#endif

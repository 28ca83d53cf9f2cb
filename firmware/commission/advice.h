/* Advice where start-up has ended without a proposal: computed changes of settings that let the next one go further. Following a
 * line literally is enough. Main loop. */
#ifndef REFLUX_COMMISSION_ADVICE_H
#define REFLUX_COMMISSION_ADVICE_H

#include "num/real.h"
#include "supervise/supervisor.h"

#define ADVICE_MOST 4u

struct commission;

enum advice_kind {
    ADVICE_LONGEST,  /* test.longest, s */
    ADVICE_TIME,     /* mv.test_time, s */
    ADVICE_STEP,     /* mv.test_step, unit of the input */
    ADVICE_LARGER,   /* likewise, because a sensor is too coarse for the steps there were */
    ADVICE_STRONGER, /* likewise, because noise hides the response to the step that is given */
    ADVICE_NOISE,    /* test.noise */
    ADVICE_ROUNDS,   /* test.rounds */
    ADVICE_WINDOW,   /* test.window, ticks */
    ADVICE_LEAVE,    /* mv.test off */
    ADVICE_RELAY,    /* set the loop of a pair by a relay test */
    /* Inputs that act nearly alike: start up all but this pair, and then this one while those loops are closed. */
    ADVICE_OTHERS_FIRST,
    ADVICE_THEN_THIS
};

struct advice {
    enum advice_kind kind;
    uint8_t input;       /* index of the manipulated variable, where it is about one */
    uint8_t measurement; /* index of the measurement that asks for it; CHANNEL_MAX: none */
    real_t value,
        present; /* of the setting; ADVICE_THEN_THIS: hours that the tests take at least */
};

/* Fills in at most ADVICE_MOST and returns their number; 0 where there is nothing to say or the results are no longer there. */
unsigned advice_of(const struct commission *c, const struct supervisor *s, struct advice *advice);

#endif

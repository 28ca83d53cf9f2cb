/* Faults of a sensor that the samples of the tests show: it reads in coarse steps, gives a new value only every few ticks, or has a span
 * so wide that responses are lost in it. Main loop, under hal_tick_lock, and tick. */
#ifndef REFLUX_COMMISSION_SENSOR_ADVICE_H
#define REFLUX_COMMISSION_SENSOR_ADVICE_H

#include "num/real.h"
#include "supervise/supervisor.h"

struct commission;

/* In the order in which one hides the others; part of an event. */
enum sensor_fault {
    SENSOR_RARE = 1, /* renewed every few ticks */
    SENSOR_COARSE,
    SENSOR_LOST /* a response is lost in the span */
};

struct sensor_advice {
    real_t step_share; /* it reads in steps of this share of its span; 0: finer than matters */
    real_t
        step_least; /* least test_step of `input` for it, unit of that input; 0: no gain is known */
    uint8_t input;  /* index of the manipulated variable with the largest gain */
    unsigned renewal; /* ticks after which it gives a new value; 1: every tick */
    real_t
        span_wanted; /* span in its unit that would show the largest response; 0: the span is fine */
    real_t moved_share; /* that response, share of the span */
};
/* Number of outputs to ask for; 0 where the results are no longer there. */
unsigned sensor_advices(const struct commission *c, const struct supervisor *s);
/* Advice about the sensor of output j, from the samples of the tests so far; j is below their number. False: there is none. */
bool sensor_advice_of(const struct commission *c, const struct supervisor *s, uint8_t j,
                      struct sensor_advice *advice);

/* The fault of a sensor about which there is advice, and its number: ticks, else a share of the span. */
enum sensor_fault sensor_fault_of(const struct sensor_advice *a, real_t *value);

#endif

#include "kinds/gmv/gmv_cycle.h"

#include <string.h>

#include "kinds/gmv/gmv_cycle_state.h"
#include "num/real.h"

/* Steps of a window, windows in a row, crossings in each. */
#define WINDOW    32u
#define WINDOWS   2u
#define CROSSINGS 3u
/* A smaller swing does not matter; fraction of span, r.m.s. */
#define LEAST 0.005f
/* A swing is as many times the mean square of the prediction errors. */
#define SURPRISES 25.0f
/* Between its limits an MV makes a loop swing that a linear model does not predict as well. */
#define LARGE           0.01f
#define LARGE_SURPRISES 4.0f

static void begin_cycle_window(struct gmv_cycle *c)
{
    c->window_steps = c->crossings = 0;
    c->first = c->second = c->surprise = c->last = 0;
}

void gmv_cycle_begin(struct gmv_cycle *c)
{
    memset(c, 0, sizeof *c);
}

float gmv_cycle_size(const struct gmv_cycle *c)
{
    return real_sqrt(c->second / (0.5f * (float)WINDOW));
}

static bool keeps_swinging(const struct gmv_cycle *c)
{
    float sum = c->first + c->second;
    bool large = sum > LARGE * LARGE * (float)WINDOW;
    return c->crossings >= CROSSINGS && c->second >= 0.5f * c->first &&
           sum > LEAST * LEAST * (float)WINDOW &&
           sum > (large ? LARGE_SURPRISES : SURPRISES) * c->surprise;
}

bool gmv_cycle_step(struct gmv_cycle *c, float setpoint, float away, float error, uint32_t settled)
{
    if (setpoint != c->setpoint)
        c->steps_at_rest = 0;
    else if (c->steps_at_rest < UINT32_MAX)
        c->steps_at_rest++;
    c->setpoint = setpoint;
    if (c->steps_at_rest < settled || c->window_steps >= WINDOW)
        begin_cycle_window(c);
    if (c->steps_at_rest < settled) {
        c->swinging_windows = 0;
        return false;
    }
    if (away * away > LEAST * LEAST / 4) {
        c->crossings += away * c->last < 0;
        c->last = away;
    }
    if (c->window_steps < WINDOW / 2u)
        c->first += away * away;
    else
        c->second += away * away;
    c->surprise += error * error;
    c->window_steps++;
    if (c->window_steps < WINDOW)
        return false;
    c->swinging_windows =
        keeps_swinging(c) ? (uint8_t)(c->swinging_windows + (c->swinging_windows < WINDOWS)) : 0;
    return c->swinging_windows == WINDOWS;
}

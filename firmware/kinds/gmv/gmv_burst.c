#include "kinds/gmv/gmv_burst.h"

#include <string.h>

#include "kinds/gmv/gmv_burst_state.h"
#include "num/real.h"

/* Steps of the two means; nothing is judged before LONG_MEMORY steps. */
#define SHORT_MEMORY 16.0f
#define LONG_MEMORY  256.0f
/* Turns that make a burst, and the steps within which they are counted. */
#define TURNS_MEMORY 64.0f
#define TURNS        4.0f
/* Smaller moves, r.m.s., wear nothing out; fraction of span. */
#define LEAST_MOVE 0.005f

void gmv_burst_begin(struct gmv_burst *b)
{
    memset(b, 0, sizeof *b);
}

bool gmv_burst_step(struct gmv_burst *b, float setpoint, float moved, float ratio, uint32_t settled)
{
    if (setpoint != b->setpoint)
        b->steps_at_rest = 0;
    else if (b->steps_at_rest < UINT32_MAX)
        b->steps_at_rest++;
    b->setpoint = setpoint;
    float square = moved * moved;
    b->turns -= b->turns / TURNS_MEMORY;
    if (square > LEAST_MOVE * LEAST_MOVE) {
        b->turns += moved * b->last < 0;
        b->last = moved;
    }
    b->recent += (square - b->recent) / SHORT_MEMORY;
    if (b->steps_at_rest < settled)
        return false;
    b->mean_steps += b->mean_steps < UINT32_MAX;
    float memory = (float)b->mean_steps < LONG_MEMORY ? (float)b->mean_steps : LONG_MEMORY;
    float most = 4 * b->usual + LEAST_MOVE * LEAST_MOVE;
    bool ordinary = square <= most || (float)b->mean_steps < LONG_MEMORY;
    /* Clipped, so that a burst stands out for long. */
    b->usual += ((ordinary ? square : most) - b->usual) / memory;
    return (float)b->mean_steps >= LONG_MEMORY && b->recent > ratio * b->usual &&
           b->recent > LEAST_MOVE * LEAST_MOVE && b->turns >= TURNS;
}

float gmv_burst_size(const struct gmv_burst *b)
{
    return real_sqrt(b->recent);
}

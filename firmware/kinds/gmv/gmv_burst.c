#include "kinds/gmv/gmv_burst.h"

#include <string.h>

#define SHORT_MEMORY 16.0f  /* steps */
#define LONG_MEMORY  256.0f /* steps, also how many it wants before it says anything */
#define TURNS_MEMORY 64.0f  /* steps */
#define TURNS        4.0f
#define LEAST_MOVE   0.005f /* of span, r.m.s.: smaller moves wear nothing out */

void gmv_burst_begin(struct gmv_burst *b)
{
    memset(b, 0, sizeof *b);
}

bool gmv_burst_step(struct gmv_burst *b, float setpoint, float moved, float ratio, uint32_t settled)
{
    if (setpoint != b->setpoint)
        b->rests = 0;
    else if (b->rests < UINT32_MAX)
        b->rests++;
    b->setpoint = setpoint;
    float square = moved * moved;
    b->turns -= b->turns / TURNS_MEMORY;
    if (square > LEAST_MOVE * LEAST_MOVE) {
        b->turns += moved * b->last < 0;
        b->last = moved;
    }
    b->soon += (square - b->soon) / SHORT_MEMORY;
    if (b->rests < settled)
        return false;
    b->seen += b->seen < UINT32_MAX;
    float memory = (float)b->seen < LONG_MEMORY ? (float)b->seen : LONG_MEMORY;
    float most = 4 * b->long_ + LEAST_MOVE * LEAST_MOVE;
    bool usual = square <= most || (float)b->seen < LONG_MEMORY;
    b->long_ +=
        ((usual ? square : most) - b->long_) / memory; /* a burst is to stand out for long */
    return (float)b->seen >= LONG_MEMORY && b->soon > ratio * b->long_ &&
           b->soon > LEAST_MOVE * LEAST_MOVE && b->turns >= TURNS;
}

/* First-order-plus-dead-time plant in double, sampled exactly (zero-order hold), dead time a whole number of
 * steps: y follows offset_y + gain (u - offset_u) delayed. */
#ifndef REFLUX_TESTS_FOPDT_PLANT_H
#define REFLUX_TESTS_FOPDT_PLANT_H

#include <math.h>
#include <stdlib.h>

#define FOPDT_PLANT_MAX_DELAY 4096

struct fopdt_plant {
    double gain, decay, offset_u, offset_y, y;
    int delay, head;
    double ring[FOPDT_PLANT_MAX_DELAY];
};

/* At rest at input u, output y. */
static inline void fopdt_plant_init(struct fopdt_plant *p, double gain, double time_constant_s,
                                    int delay_steps, double h_s, double u, double y)
{
    if (delay_steps < 0 || delay_steps >= FOPDT_PLANT_MAX_DELAY)
        abort();
    p->gain = gain;
    p->decay = exp(-h_s / time_constant_s);
    p->offset_u = u;
    p->offset_y = y;
    p->y = y;
    p->delay = delay_steps;
    p->head = 0;
    for (int i = 0; i < FOPDT_PLANT_MAX_DELAY; i++)
        p->ring[i] = u;
}

/* Holds u for one step; returns the output at its end. */
static inline double fopdt_plant_step(struct fopdt_plant *p, double u)
{
    p->ring[p->head] = u;
    double late = p->ring[(p->head + FOPDT_PLANT_MAX_DELAY - p->delay) % FOPDT_PLANT_MAX_DELAY];
    p->head = (p->head + 1) % FOPDT_PLANT_MAX_DELAY;
    double target = p->offset_y + p->gain * (late - p->offset_u);
    p->y = target + p->decay * (p->y - target);
    return p->y;
}

#endif

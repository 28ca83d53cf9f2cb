/* Compositions that are analysed now and then, late: what the model is off by at the place of each is taken off its points. For this folder alone.
 *
 * An analysis y of a sample that was taken a seconds ago is compared with what the estimate was then, and a share of what is left over
 * moves the correction:
 *
 *     c <- c + g (y - (x(t - a) + c)),   estimate = x + c, within 0..1
 *
 * so that after n samples (1 - g)^n of a constant error is left. The model itself stays as it is: temperatures say how fast a composition
 * moves, analyses where it is. Ours. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_ANALYSIS_H
#define REFLUX_COMPOSITION_COMPOSITION_ANALYSIS_H

#include <stdbool.h>
#include <stdint.h>

#include "num/real.h"

#define ANALYSES_MAX  2
#define ANALYSIS_PAST 128u

struct composition_analysis {
    uint8_t input, stage, component; /* from 0 */
    real_t share;                    /* g */
    real_t correction;               /* mole fraction */
    real_t surprise;                 /* mole fraction, by which the last one was off */
    real_t age_s;                    /* of the last one, in the step before */
    bool seen;                       /* there has been one */
    bool far;                        /* the last one was too far off, and is not believed */
    bool told;                 /* the correction is found elsewhere, from `surprise` and this: */
    bool fresh;                /* there is one that was believed; whoever takes it in clears it */
    real_t moved;              /* mole fraction, by the estimate since its sample was taken */
    float past[ANALYSIS_PAST]; /* of the estimate without correction, every `every` steps */
    uint16_t at, filled;       /* the newest is at `at` */
    uint16_t counted;          /* steps since it was put there */
    uint16_t every;
};

/* Every how many steps the estimate is kept. h: s, of a step; reach: s, the oldest sample that counts. */
uint16_t composition_analysis_every(real_t h, real_t reach);

/* h: s, of a step; reach: s, the oldest sample that counts. Nothing is known before. */
void composition_analysis_begin(struct composition_analysis *a, real_t h, real_t reach);

/* A step: x is the estimate now, y what the analyser shows, age_s since its sample was taken; usable: it shows something valid. most: mole
 * fraction; what is farther off is not believed; 0: all is. Returns whether a sample has come that is older than the reach. */
bool composition_analysis_step(struct composition_analysis *a, real_t h, real_t x, bool usable,
                               real_t y, real_t age_s, real_t most);

#endif

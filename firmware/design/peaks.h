/* Largest sensitivities of several loops together over frequency: |S_kk| and |T_kk| of S = (I + G C)^-1 and T = I - S, for every
 * loop k broken at its output while the others stay closed. With G C diagonal they are those of single loops.
 *
 * Frequencies come one by one, upwards. Between them the peak is where a parabola through three values has its vertex,
 * over the logarithm of frequency. */
#ifndef REFLUX_DESIGN_PEAKS_H
#define REFLUX_DESIGN_PEAKS_H

#include <stdint.h>

#include "design/double_symbols.h"
#include "interact/plant.h"

/* |S_kk| and |T_kk| at one frequency. */
struct peaks_point {
    real_t s[INTERACT_MAX], t[INTERACT_MAX];
};

struct peaks {
    /* Results */
    real_t s[INTERACT_MAX], t[INTERACT_MAX]; /* largest, of loop k */
    /* Frequencies, rad/s, between which the loops act: from the first |S_kk| above 0.15 to the last |T_kk| above 0.1. */
    real_t omega_lo, omega_hi;

    /* Work: 0.4 KiB (float) */
    struct peaks_point last, before; /* the two points before */
    real_t last_log, before_log;     /* logarithms of their frequencies */
    uint8_t loops, points;
};

void peaks_begin(struct peaks *p, uint8_t loops);
/* I + G C, factored, as values at one frequency. */
void peaks_values(const struct clu *lu, struct peaks_point *point);
/* Largest relative change since the last point of what is above 1.1: a step that is too long shows. */
real_t peaks_change(const struct peaks *p, const struct peaks_point *point);
void peaks_keep(struct peaks *p, const struct peaks_point *point, real_t omega);
/* Largest of |S_kk|/s_most and |T_kk|/t_most over all loops, and the loop: at most 1 where both bounds hold. loop may be NULL. */
real_t peaks_excess(const struct peaks *p, real_t s_most, real_t t_most, uint8_t *loop);

#endif

/* Derivative of several functions of one number, by differences whose distance shrinks until they agree.
 *
 * Differences on both sides at h, h/2 and h/4 are extrapolated to distance 0 (Richardson); what the last extrapolation
 * changed is taken for the error, and h falls to a sixteenth, up to three times, until it is small, or what rounding makes,
 * for every function. Each function keeps the estimate with the least error. Where a function may be asked on one side only the differences are
 * taken there. Where the slopes of the two sides do not come together as h falls there is no derivative: a kink. */
#ifndef REFLUX_HOST_SIM_DERIVATIVE_H
#define REFLUX_HOST_SIM_DERIVATIVE_H

#include <stdbool.h>
#include <stddef.h>

enum derivative_side { DERIVATIVE_BOTH, DERIVATIVE_ABOVE, DERIVATIVE_BELOW };

struct derivative_task {
    size_t n; /* functions */
    /* number of functions of the first kind; functions are compared within their kind */
    size_t first;
    /* f[n] at a distance from the point; false, with the reason, where there is none. */
    bool (*values)(void *context, long double distance, long double *f, char *err, size_t err_size);
    void *context;
    long double step;     /* the first h, above 0 */
    long double rounding; /* of the functions, relative to themselves and to 1 */
    /* how far the functions may be asked on either side, 0 or more; one above 0 */
    long double below, above;
};

struct derivative_found {
    enum derivative_side side; /* on which the slopes were taken */
    bool kink;                 /* the slopes of the two sides differ; those above are given */
    size_t kinked;             /* index of the function with the kink */
};

#define DERIVATIVE_WORK 10 /* numbers of workspace for each function */

/* slope[n]. work[DERIVATIVE_WORK n]. False, with the reason, when the functions cannot be had on either side. */
bool derivative_take(const struct derivative_task *task, long double *work, double *slope,
                     struct derivative_found *found, char *err, size_t err_size);

#endif

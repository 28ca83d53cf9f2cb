#include "linear/derivative.h"

#include <math.h>
#include <stdio.h>

#define LEVELS     4 /* of h, each a sixteenth of the one before */
#define SHRINK     16.0L
#define ENOUGH     1e-9L /* error over the slope at which no smaller h is tried */
#define ROUNDINGS  64.0L /* that add up in a function, at most */
#define NEAR_END   0.01L /* of the step: with less room on one side only the other one is used */
#define KINK_SHARE 1e-3L /* of the slope; smaller differences between the two sides are no kink */
#define KINK_LEAST 1e-7L /* of the largest slope of the kind */
#define KINK_STEADY                                                                                \
    1.5L /* and no more than so many times the one at the h before: noise grows as h falls */
#define KINK_STAYS                                                                                 \
    0.6L /* of the difference between the sides is left at h/4; smooth functions leave a quarter */

struct taking {
    const struct derivative_task *task;
    enum derivative_side side;
    long double *start, *above, *below; /* f at the point, and at a distance on either side */
    long double *d[3];                  /* differences at h, h/2, h/4 */
    long double *gap;        /* slope above less slope below at h/4 where that is as at h, else 0 */
    long double *gap_before; /* the same at the h before */
    long double *best, *error;
    long double noise; /* of a slope by rounding, at h/4, for functions of size 1 */
    char *err;
    size_t err_size;
};

static bool ask(const struct taking *k, long double distance, long double *f)
{
    return k->task->values(k->task->context, distance, f, k->err, k->err_size);
}

/* Differences at one distance; k->gap as well on both sides, at the first and the last. */
static bool differences(struct taking *k, long double h, size_t order)
{
    bool both = k->side == DERIVATIVE_BOTH;

    if (k->side != DERIVATIVE_BELOW && !ask(k, h, k->above))
        return false;
    if (k->side != DERIVATIVE_ABOVE && !ask(k, -h, k->below))
        return false;
    for (size_t i = 0; i < k->task->n; i++) {
        long double up = (k->above[i] - k->start[i]) / h, down = (k->start[i] - k->below[i]) / h;
        k->d[order][i] = both                          ? 0.5L * (k->above[i] - k->below[i]) / h
                         : k->side == DERIVATIVE_ABOVE ? up
                                                       : down;
        if (both && order == 0) {
            k->gap_before[i] = k->gap[i];
            k->gap[i] = up - down;
        } else if (both && order == 2) {
            bool stays = fabsl(up - down) >= KINK_STAYS * fabsl(k->gap[i]);
            k->gap[i] = stays ? up - down : 0.0L;
        }
    }
    return true;
}

/* Extrapolates row i to distance 0 and keeps what is better than before. Errors of differences on both sides go with
 * h^2, h^4, h^6, of those on one side with h, h^2, h^3. */
static long double extrapolate(struct taking *k, size_t i)
{
    long double p = k->side == DERIVATIVE_BOTH ? 4.0L : 2.0L,
                q = k->side == DERIVATIVE_BOTH ? 16.0L : 4.0L;
    long double coarse = (p * k->d[1][i] - k->d[0][i]) / (p - 1.0L);
    long double fine = (p * k->d[2][i] - k->d[1][i]) / (p - 1.0L);
    long double value = (q * fine - coarse) / (q - 1.0L), error = fabsl(value - fine);

    if (error < k->error[i]) {
        k->best[i] = value;
        k->error[i] = error;
    }
    return fabsl(value);
}

static long double largest_of(const struct taking *k, size_t i, const long double largest[2])
{
    return largest[i < k->task->first ? 0 : 1];
}

/* A difference between the sides that did not fall with h. */
static bool two_slopes(const struct taking *k, size_t i, const long double largest[2])
{
    long double gap = fabsl(k->gap[i]);
    return k->side == DERIVATIVE_BOTH && gap > KINK_SHARE * fabsl(k->best[i]) &&
           gap > KINK_LEAST * largest_of(k, i, largest) &&
           gap > ROUNDINGS * k->noise * (1.0L + fabsl(k->start[i]));
}

/* One h. *done: small errors everywhere. */
static bool level(struct taking *k, long double h, long double largest[2], bool *done)
{
    largest[0] = largest[1] = 0.0L;
    k->noise = k->task->rounding / (0.25L * h);
    for (size_t order = 0; order < 3; order++, h *= 0.5L)
        if (!differences(k, h, order))
            return false;
    for (size_t i = 0; i < k->task->n; i++) {
        long double *of = &largest[i < k->task->first ? 0 : 1];
        *of = fmaxl(*of, extrapolate(k, i));
    }
    *done = true;
    for (size_t i = 0; i < k->task->n; i++)
        *done = *done && !two_slopes(k, i, largest) &&
                (k->error[i] <= ENOUGH * fabsl(k->best[i]) ||
                 k->error[i] <= k->noise * (1.0L + fabsl(k->start[i])));
    return true;
}

static bool on_side(struct taking *k, enum derivative_side side, struct derivative_found *found)
{
    const struct derivative_task *t = k->task;
    long double h = t->step, largest[2];
    bool done = false;

    *found = (struct derivative_found){.side = side};
    k->side = side;
    h = side != DERIVATIVE_BELOW ? fminl(h, t->above) : h;
    h = side != DERIVATIVE_ABOVE ? fminl(h, t->below) : h;
    for (size_t i = 0; i < t->n; i++)
        k->error[i] = INFINITY;
    for (size_t n = 0; n < LEVELS && !done; n++, h /= SHRINK)
        if (!level(k, h, largest, &done))
            return false;
    if (done || side != DERIVATIVE_BOTH)
        return true;
    for (size_t i = 0; i < t->n; i++) {
        long double before = fabsl(k->gap_before[i]), gap = fabsl(k->gap[i]);
        if (two_slopes(k, i, largest) && gap <= KINK_STEADY * before &&
            before <= KINK_STEADY * gap) {
            found->kink = true;
            found->kinked = i;
            return true;
        }
    }
    return true;
}

bool derivative_take(const struct derivative_task *task, long double *work, double *slope,
                     struct derivative_found *found, char *err, size_t err_size)
{
    struct taking k = {.task = task, .err = err, .err_size = err_size};
    long double **const part[DERIVATIVE_WORK] = {&k.start, &k.above,      &k.below, &k.d[0],
                                                 &k.d[1],  &k.gap_before, &k.d[2],  &k.gap,
                                                 &k.best,  &k.error};

    for (size_t i = 0; i < DERIVATIVE_WORK; i++)
        *part[i] = work + i * task->n;
    for (size_t i = 0; i < DERIVATIVE_WORK * task->n; i++)
        work[i] = 0.0L;
    if (!ask(&k, 0.0L, k.start))
        return false;
    bool good = fminl(task->above, task->below) > NEAR_END * task->step &&
                on_side(&k, DERIVATIVE_BOTH, found);
    if (good && found->kink) {
        struct derivative_found kink = *found;
        good = on_side(&k, DERIVATIVE_ABOVE, found);
        found->kink = true;
        found->kinked = kink.kinked;
    }
    bool up = task->above > 0.0L && task->above >= task->below;
    good = good || (up && on_side(&k, DERIVATIVE_ABOVE, found)) ||
           (task->below > 0.0L && on_side(&k, DERIVATIVE_BELOW, found)) ||
           (!up && task->above > 0.0L && on_side(&k, DERIVATIVE_ABOVE, found));
    for (size_t i = 0; i < task->n && good; i++)
        slope[i] = (double)k.best[i];
    if (good && err_size > 0)
        err[0] = '\0'; /* what a side said that cannot be had */
    return good;
}

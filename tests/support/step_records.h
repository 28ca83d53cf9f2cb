/* Records for the tests of identification: elements of first order with dead time under steps of the input, at the
 * samples, and noise. Times in samples. */
#ifndef REFLUX_TESTS_STEP_RECORDS_H
#define REFLUX_TESTS_STEP_RECORDS_H

#include <math.h>
#include <stdint.h>

#include "random_source.h"

struct test_element {
    double gain, lag, dead;
};

/* Unit step at sample 0, right after that sample was taken. */
static inline double step_response(const struct test_element *e, double k)
{
    double t = k - e->dead;
    if (!(t > 0.0))
        return 0.0;
    return e->gain * (e->lag > 0.0 ? -expm1(-t / e->lag) : 1.0);
}

/* Double step of height 1: + from sample 0, - from t1, 0 from t1 + t2. */
static inline double double_step_response(const struct test_element *e, double t1, double t2,
                                          double k)
{
    return step_response(e, k) - 2.0 * step_response(e, k - t1) + step_response(e, k - t1 - t2);
}

static inline double uniform(struct random_source *r, double lo, double hi)
{
    return lo + (hi - lo) * (double)(random_next(r) >> 11) * 0x1p-53;
}

/* Logarithmically uniform. */
static inline double spread_over(struct random_source *r, double lo, double hi)
{
    return lo * pow(hi / lo, uniform(r, 0.0, 1.0));
}

/* Standard normal (Box and Muller 1958). */
static inline double normal(struct random_source *r)
{
    double u = uniform(r, 0x1p-60, 1.0), v = uniform(r, 0.0, 1.0);
    return sqrt(-2.0 * log(u)) * cos(6.283185307179586 * v);
}

#endif

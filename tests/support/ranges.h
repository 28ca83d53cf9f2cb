/* Ranges of arguments as a header states them: both ends are taken, a thousandth beyond them is refused, and so is what is
 * no number. */
#ifndef REFLUX_TESTS_RANGES_H
#define REFLUX_TESTS_RANGES_H

#include <math.h>
#include <stddef.h>
#include <stdio.h>

#include "base/error.h"
#include "num/real.h"
#include "unity.h"

/* A real_t at `at` of what is tried. ABOVE: lo itself is not taken. */
struct range {
    const char *name;
    size_t offset;
    double lo, hi;
    enum { FROM, ABOVE } kind;
};

#define RANGE(of, field, lo, hi)                                                                   \
    {                                                                                              \
#field, offsetof(struct of, field), lo, hi, FROM                                           \
    }
#define ABOVE(of, field, lo, hi)                                                                   \
    {                                                                                              \
#field, offsetof(struct of, field), lo, hi, ABOVE                                          \
    }

/* with: plausible where everything else is. */
static inline void expect(void *with, const struct range *r, double value, bool taken,
                          enum err (*begin)(void))
{
    char message[80];
    real_t *x = (real_t *)((char *)with + r->offset), before = *x;
    *x = (real_t)value;
    enum err err = begin();
    *x = before;
    snprintf(message, sizeof message, "%s = %g", r->name, value);
    bool refused = err == ERR_RANGE || err == ERR_NOT_FINITE;
    TEST_ASSERT_EQUAL_MESSAGE(!taken, refused, message);
}

static inline void check(void *with, const struct range *ranges, unsigned n,
                         enum err (*begin)(void))
{
    TEST_ASSERT_NOT_EQUAL(ERR_RANGE, begin());
    for (const struct range *r = ranges; r < ranges + n; r++) {
        double below = r->lo != 0.0 ? r->lo - 1e-3 * fabs(r->lo) : -1e-3 * r->hi;
        if (r->lo == 0.0 && r->hi > 1.0)
            below = -1e-3;
        expect(with, r, r->lo, r->kind == FROM, begin);
        expect(with, r, below, false, begin);
        expect(with, r, r->hi, true, begin);
        expect(with, r, r->hi + 1e-3 * fabs(r->hi), false, begin);
        expect(with, r, NAN, false, begin);
        expect(with, r, INFINITY, false, begin);
    }
}

#define CHECK(with, ranges, begin) check(&(with), ranges, sizeof(ranges) / sizeof(ranges)[0], begin)

/* One or two numbers that are handed over by themselves. */
struct only {
    real_t x, y;
};

#endif

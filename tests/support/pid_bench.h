/* Short ways to build and drive a PID in tests. */
#ifndef REFLUX_TESTS_PID_BENCH_H
#define REFLUX_TESTS_PID_BENCH_H

#include "formats.h"
#include "kinds/pid/pid.h"
#include "unity.h"

/* One step of num_t at magnitude 1, and what two roundings of it may differ. */
#define NUM_STEP 5.9604645e-8

static inline struct pid make_pid(struct pid_config config, float h_s)
{
    struct pid pid;
    TEST_ASSERT_EQUAL_INT(ERR_OK, pid_init(&pid, &config, h_s));
    return pid;
}

/* One tick in which the output takes effect as commanded. */
static inline double tick(struct pid *pid, double r, double y)
{
    num_t u = pid_step(pid, N(r), N(y));
    pid_back_calculate(pid, u, INTEGRAL_FREE);
    return D(u);
}

#endif

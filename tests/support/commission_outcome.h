/* A test that has just been made, with what is found of it made up: for the tests of what becomes of it. */
#ifndef REFLUX_TESTS_COMMISSION_OUTCOME_H
#define REFLUX_TESTS_COMMISSION_OUTCOME_H

#include <string.h>

#include "commission_space.h"
#include "supervisor_bench.h"

static struct commission c;
static struct config *cf;
static struct experiment *x;

#define NEAR(wanted, value) TEST_ASSERT_DOUBLE_WITHIN(2e-6, wanted, (double)(value))

/* The main loop has, and the next tick takes it. */
static inline void has_done(enum background_task what)
{
    c.background.task = (uint8_t)what;
    job_ask(&c.background.job, 1);
    c.background.job.done = true;
}

/* The firmware's jobs: start-up's alone. */
static inline struct jobs jobs_of_it(void)
{
    struct jobs jobs = {0};
    TEST_ASSERT_EQUAL_INT(ERR_OK, jobs_add(&jobs, &c.background.job));
    return jobs;
}

/* Input 0 of two has just been tested, by 0.1 for 100 ticks of 2 s, and fitted. */
static inline void fitted(void)
{
    commission_init(&c, &bench.events, commission_fresh_region());
    commission_lease(&c);
    c.outputs.plan_serial = bench.s.plan->serial;
    c.outputs.safe_count = bench.s.safe_count;
    c.outputs.n = c.inputs.n = 2;
    c.outputs.measurement[1] = c.inputs.input[1].output = c.inputs.order[1] = 1;
    c.inputs.input[0].test_base = REAL_C(0.5);
    c.inputs.input[1].test_base = REAL_C(0.5);
    c.inputs.round = 1;
    c.status.phase = COMMISSION_FITTING;
    c.model.fitted[2] = (struct identified){.gain = 50, .time_constant_s = 1000}; /* of no output */
    c.model.climbs[2] = 9;
    c.work->element[2][0].asymmetry = 5000;
    x = &c.work->experiment;
    for (unsigned j = 0; j < 2; j++) {
        struct shape_found *f = interim_fit_shape(&x->interim_fit, j);
        *f = (struct shape_found){.kind = SHAPE_ONE_LAG, .parameters = 3};
        f->shape = (struct shape){.gain = REAL_C(0.5), .lag_s = 20, .dead_time_s = 10};
        f->sd[SHAPE_GAIN] = REAL_C(0.01);
        f->sd[SHAPE_LAG] = f->residence_sd_s = 1;
        c.model.fitted[j] = element_of_found(f, 0);
    }
    x->config.outputs = 2;
    x->config.h_s = 2;
    x->config.repeats = true;
    x->config.limit[0] = x->config.limit[1] = REAL_C(0.2);
    x->half = 100;
    x->amplitude = REAL_C(0.1);
    x->record.input.edges = 3;
    has_done(TASK_FIT);
    bench_forget_events();
}

static inline void outcome_begin(void)
{
    bench_start();
    bench.plan[bench.current].tick_s = 2;
    cf = &bench.plan[bench.current].config;
    cf->test =
        (struct test_config){.noise_multiple = 20, .confidence = 0.95f, .rounds = 3, .window = 40};
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        cf->measurement[i].start_up.test = cf->mv[i].start_up.test = i < 2;
        cf->measurement[i].start_up.limit = cf->mv[i].start_up.step = 0;
    }
    fitted();
}

static inline void goes_on(void)
{
    commission_wait_for_job(&c, &bench.s);
}

/* The event of that code that came last. */
static inline const struct event *said(enum event_code code)
{
    bench_events();
    for (unsigned i = bench.n_seen; i-- > 0;)
        if (bench.seen[i].code == code)
            return &bench.seen[i];
    TEST_FAIL_MESSAGE("it was not said");
    return NULL;
}

#endif

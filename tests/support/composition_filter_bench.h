/* The bench of composition_bench.h for methods whose gains are found between ticks: a state with all that stands behind it, in memory of
 * just as many bytes, a workspace, and a main loop that works between steps as the supervisor has it work. */
#ifndef REFLUX_TESTS_COMPOSITION_FILTER_BENCH_H
#define REFLUX_TESTS_COMPOSITION_FILTER_BENCH_H

#include <stdlib.h>

#include "base/workspace.h"
#include "composition_bench.h"
#include "kinds/composition/composition_job_state.h"

static struct workspace workspace;
static void *region;
static void *left_behind; /* where the state was before it moved, spoilt */
static float age[BLOCK_INPUTS_MAX];

/* A block that the main loop serves. */
struct filter_bench {
    struct composition_block *b;
    bool asked, done;
    unsigned ticks, due;
    bool idle; /* the main loop does not come to it */
    unsigned works;
};

static struct filter_bench filter;

static inline void bench_frees(void)
{
    free(filter.b);
    free(region);
    free(left_behind);
    left_behind = NULL;
    filter.b = NULL;
    region = NULL;
}

static inline void workspace_of(uint32_t bytes)
{
    free(region);
    region = malloc(bytes);
    TEST_ASSERT_NOT_NULL(region);
    memset(region, 0xFF, bytes);
    workspace_init(&workspace, region, bytes);
    workspace_share(&workspace);
}

/* The pilot column; its plant knows nothing of filters. */
static inline void bench_filter(enum composition_method method,
                                enum composition_covariance covariance)
{
    bench_pilot();
    bench_frees();
    workspace_of(WORKSPACE_BYTES);
    memset(&filter, 0, sizeof filter);
    memset(age, 0, sizeof age);
    io.inputs.age_s = age;
    all_settings.s.method = (uint8_t)method;
    all_settings.s.covariance = (uint8_t)covariance;
    /* Numbers of the bench's own: what defaults are good for is a campaign's affair (tests/campaign/composition). */
    all_settings.noise = 0.2f;
    all_settings.model = 0.1f;
    all_settings.s.feed_f = 0;
    all_settings.s.sure = 0.01f;
    all_settings.s.sure_part = all_settings.s.lasting = 0;
}

static inline struct composition_block *state_of(void)
{
    struct composition_block *b = malloc(kind->bytes(&setup));
    TEST_ASSERT_NOT_NULL(b);
    memset(b, 0xA5, kind->bytes(&setup)); /* whatever was there */
    return b;
}

/* All of what was asked. */
static inline void work_all(struct filter_bench *f)
{
    while (f->asked && !f->done) {
        f->works++;
        f->done = !kind->work(f->b);
    }
}

static inline void step_alone(struct filter_bench *f)
{
    io.requests.raised = 0;
    io.requests.ask_work = 0;
    io.requests.work_done = io.requests.work_wanted = false;
    if (f->asked) {
        f->ticks += f->ticks < f->due ? 1u : 0;
        io.requests.work_done = f->done && f->ticks >= f->due;
        io.requests.work_wanted = !io.requests.work_done;
        f->asked = io.requests.work_wanted;
    }
    kind->step(f->b, &io);
    if (io.requests.ask_work && !f->asked) {
        f->asked = true;
        f->done = false;
        f->ticks = 0;
        f->due = io.requests.ask_work;
    }
}

/* A tick, and what is done until the next. */
static inline void tick_of(struct filter_bench *f)
{
    step_alone(f);
    workspace_tick(&workspace);
    if (!f->idle)
        work_all(f);
}

static inline void ticks(unsigned n)
{
    while (n-- > 0)
        tick_of(&filter);
}

static inline void plant_begins(void)
{
    struct composition_settings of_filter = all_settings.s;
    all_settings.s.method = METHOD_GEOMETRIC;
    TEST_ASSERT_EQUAL(ERR_OK, kind->configure(&plant, &setup, false));
    all_settings.s = of_filter;
    measure();
}

static inline void filter_begins(void)
{
    accepted();
    free(filter.b);
    filter.b = state_of();
    TEST_ASSERT_EQUAL(ERR_OK, kind->configure(filter.b, &setup, false));
    kind->follow(filter.b, &io);
    tick_of(&filter);
}

static inline void begin_both(void)
{
    plant_begins();
    filter_begins();
}

/* Plant and filter go on together. */
static inline void run(unsigned n)
{
    while (n-- > 0) {
        plant_runs(1);
        tick_of(&filter);
    }
}

/* To a job that has begun, with the main loop away. */
static inline void to_a_job(void)
{
    for (unsigned n = 0; n < 1000; n++) {
        filter.idle = filter.b->filter.job != NULL;
        if (filter.idle && filter.asked && !filter.done)
            return;
        run(1);
    }
    TEST_FAIL_MESSAGE("no job");
}

static inline void retune_filter(void)
{
    accepted();
    TEST_ASSERT_EQUAL(ERR_OK, kind->configure(filter.b, &setup, true));
}

/* The state stands elsewhere from now on, and where it was is something else. */
static inline void move_state(void)
{
    uint32_t n = kind->bytes(&setup);
    struct composition_block *to = malloc(n);
    TEST_ASSERT_NOT_NULL(to);
    memcpy(to, filter.b, n);
    memset(filter.b, 0xFF, n);
    free(left_behind);
    left_behind = filter.b;
    filter.b = to;
}

static inline float fraction(unsigned stage)
{
    return (float)filter.b->model.x[stage - 1];
}

static inline float true_fraction(unsigned stage)
{
    return (float)plant.model.x[stage - 1];
}

/* The largest error of a mole fraction. */
static inline float worst(void)
{
    float most = 0;
    for (unsigned s = 1; s <= 12; s++)
        most = fmaxf(most, fabsf(fraction(s) - true_fraction(s)));
    return most;
}

static inline float value_named(const char *name)
{
    float value = NAN;
    const char *found;
    for (size_t i = 0; (found = kind->describe(filter.b, i, &value)) != NULL; i++)
        if (strcmp(found, name) == 0)
            return value;
    TEST_FAIL_MESSAGE(name);
    return NAN;
}

static inline const struct block_verb *verb_named(const char *name)
{
    for (unsigned i = 0; i < kind->verbs; i++)
        if (strcmp(kind->verb[i].name, name) == 0)
            return &kind->verb[i];
    TEST_FAIL_MESSAGE(name);
    return NULL;
}

static inline const char *tell(const char *verb)
{
    return verb_named(verb)->run(filter.b, NULL);
}

/* Every way to filter; each from the beginning of the bench. */
struct filter_way {
    const char *name;
    enum composition_method method;
    enum composition_covariance covariance;
};

static const struct filter_way filter_ways[] = {
    {"ekf full", METHOD_EKF, COVARIANCE_FULL},
    {"ekf band", METHOD_EKF, COVARIANCE_BAND},
    {"ekf steady", METHOD_EKF, COVARIANCE_STEADY},
    {"kalman full", METHOD_KALMAN, COVARIANCE_FULL},
    {"kalman band", METHOD_KALMAN, COVARIANCE_BAND},
    {"kalman steady", METHOD_KALMAN, COVARIANCE_STEADY},
};
#define FILTER_WAYS (sizeof filter_ways / sizeof filter_ways[0])

static inline const char *way_begins(unsigned i)
{
    bench_filter(filter_ways[i].method, filter_ways[i].covariance);
    return filter_ways[i].name;
}

static inline bool has_gains(void)
{
    return filter.b->filter.gain != NULL;
}

#endif

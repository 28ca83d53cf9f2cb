/* The tuner of feedforward left alone. Lines of numbers, with a head:
 *
 *     feedforward_tuner stays  [SEED [SEEDS [STRIDE]]]   a week; the disturbance moves and rests by turns of eight hours
 *     feedforward_tuner change [SEED [SEEDS [STRIDE]]]   process or path change an hour after adoption
 *     feedforward_tuner steps  [SEED [SEEDS [STRIDE]]]   how large the test signal has to be
 *
 * Every STRIDE-th plant. Exit status 1: a week or a change missed its limit. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "kinds/ff_tune/tune_responses.h"
#include "kinds/ff_tune/tune_search.h"
#include "loop.h"

#define HOUR    3600u
#define WEEK    (168u * HOUR)
#define WINDOW  (6u * HOUR)
#define SEEDS   6u
#define CHECK_S 1200 /* `check` */
#define METHODS 4u
#define WORST                                                                                      \
    1.1 /* times the squares under feedback alone, but where noise of the disturbance meets no dead band */
#define NOISE_TIMES 4 /* of the noise of the disturbance: the dead band */

static struct loop loop;
static bool missed;

/* Classes of plants: lags and dead times in seconds, gains drawn by the seed. */
static const struct loop_case plants[] = {
    {.name = "first order",
     .process = {1.5, 8, 0, 12, false},
     .path = {1.5, 5, 0, 8, false},
     .disturbance = SQUARE,
     .noise = 0.001},
    {.name = "slower path",
     .process = {0.8, 15, 0, 5, false},
     .path = {0.6, 30, 0, 10, false},
     .disturbance = TELEGRAPH,
     .noise = 0.001},
    {.name = "second order",
     .process = {1.2, 20, 8, 6, false},
     .path = {1, 12, 6, 9, false},
     .disturbance = COLOURED,
     .noise = 0.001},
    {.name = "longer dead time",
     .process = {1, 10, 4, 16, false},
     .path = {0.8, 14, 0, 6, false},
     .disturbance = TELEGRAPH,
     .noise = 0.001},
    {.name = "noisy",
     .process = {1.5, 12, 0, 8, false},
     .path = {1.2, 10, 4, 8, false},
     .disturbance = SQUARE,
     .noise = 0.005,
     .disturbance_noise = 0.002},
    {.name = "lag 40",
     .process = {2, 40, 0, 6, false},
     .path = {1.5, 30, 0, 10, false},
     .disturbance = TELEGRAPH,
     .noise = 0.001},
    {.name = "integrating",
     .process = {0.03, 1, 0, 6, true},
     .path = {0.03, 1, 0, 9, true},
     .disturbance = SQUARE,
     .noise = 0.001},
    {.name = "integrating alone",
     .process = {0.03, 1, 0, 6, true},
     .path = {0.5, 20, 0, 9, false},
     .disturbance = SQUARE,
     .noise = 0.001},
};
#define PLANTS (sizeof plants / sizeof plants[0])

static double drawn(struct random_source *r, double lo, double hi)
{
    return lo + (hi - lo) * (double)(random_next(r) >> 11) / 9007199254740992.0;
}

/* A plant of that class, its numbers within a third. */
static struct loop_case plant_of(unsigned k, uint64_t seed, unsigned method)
{
    struct random_source r = {.state = seed * 977u + k};
    struct loop_case c = plants[k];
    struct path *const paths[2] = {&c.process, &c.path};
    for (unsigned i = 0; i < 2; i++) {
        paths[i]->gain *= drawn(&r, 0.7, 1.4);
        paths[i]->lag *= drawn(&r, 0.7, 1.4);
        paths[i]->lag2 *= drawn(&r, 0.7, 1.4);
        paths[i]->dead = (unsigned)(paths[i]->dead * drawn(&r, 0.7, 1.4));
    }
    c.method = (uint8_t)method;
    c.check_s = CHECK_S;
    /* How large: docs/methods/adaptive-feedforward.md. */
    c.step = method == TUNE_JOINT ? 0.05 : 0.15;
    return c;
}

static bool acts(void)
{
    return loop.settings.k > 0 || loop.settings.k < 0;
}

/* Until an element acts, `most` ticks at the most. */
static bool adopted_within(uint64_t most)
{
    for (uint64_t end = loop.t + most; loop.t < end && !acts();)
        loop_tick(&loop);
    return acts();
}

static bool begins(const struct loop_case *c, uint64_t seed)
{
    if (!loop_begin(&loop, c, seed)) {
        printf("%s: refused\n", c->name);
        return false;
    }
    for (unsigned k = 0; k < 1200; k++)
        loop_tick(&loop);
    loop_verb(&loop, "tune");
    return true;
}

/* ---- a week as it is ---- */

static void week(const struct loop_case *c, uint64_t seed)
{
    double with = 0, alone = 0, worst[2] = {0, 0}, late[2] = {0, 0}, moving[2] = {0, 0};
    unsigned signals = 0, in_rest = 0, offs = 0;
    bool moved = false, before = false;
    if (!begins(c, seed))
        return;
    bool adopted = adopted_within(12u * HOUR);
    uint64_t at = loop.t;
    for (uint64_t n = 1; adopted && loop.t < WEEK; n++) {
        bool rests = (n + HOUR / 2u) / (8u * HOUR) % 2u;
        loop.moves = !rests;
        loop_tick(&loop);
        bool excited = loop.io.requests.excite_state == EXCITE_RUNS;
        signals += excited;
        in_rest += excited && rests && (n + HOUR / 2u) % (8u * HOUR) > HOUR;
        offs += before && !acts();
        before = acts();
        moved = moved || excited;
        with += loop.tuned.y * loop.tuned.y;
        alone += loop.alone.y * loop.alone.y;
        late[0] += rests ? 0 : loop.tuned.y * loop.tuned.y;
        late[1] += rests ? 0 : loop.alone.y * loop.alone.y;
        if (n % WINDOW == 0) {
            if (with / alone > worst[moved])
                worst[moved] = with / alone;
            for (unsigned k = 0; k < 2; k++) {
                moving[k] += moved ? 0 : late[k];
                late[k] = 0;
            }
            with = alone = 0;
            moved = false;
        }
    }
    missed =
        missed || in_rest || ((c->disturbance_noise <= 0 || c->dead_band > 0) && worst[0] > WORST);
    printf("%s,%u,%llu,%d,%.0f,%.3f,%.3f,%.2f,%.3f,%u,%.4f\n", c->name, c->method,
           (unsigned long long)seed, adopted, (double)at, worst[0], worst[1], signals / 3600.0,
           in_rest / 3600.0, offs, moving[1] > 0 ? moving[0] / moving[1] : 1);
}

static void week_with_dead_band(const struct loop_case *c, uint64_t seed)
{
    struct loop_case banded = *c;
    if (c->disturbance_noise <= 0)
        return;
    banded.name = "noisy with dead band";
    banded.dead_band = NOISE_TIMES * c->disturbance_noise;
    week(&banded, seed);
}

/* ---- a change ---- */

struct change {
    const char *name;
    double process, path, dead;
};
static const struct change changes[] = {
    {"process 0.3", 0.3, 1, 1}, {"process 0.5", 0.5, 1, 1}, {"process 2", 2, 1, 1},
    {"process 2.5", 2.5, 1, 1}, {"process 3", 3, 1, 1},     {"path 0.3", 1, 0.3, 1},
    {"path -1", 1, -1, 1},      {"path 3", 1, 3, 1},        {"dead time of the path 3", 1, 1, 3},
};
#define CHANGES (sizeof changes / sizeof changes[0])
#define LOOK    300u /* a period of the square waves */

/* The time from the change in which the element acts and the loop is worse than under feedback alone: until the last such
 * window ends, up to half a day. */
static void changed(const struct loop_case *c, uint64_t seed, const struct change *by)
{
    double with = 0, alone = 0;
    unsigned last = 0, longest = 0, run = 0, signals = 0, off_at = 0;
    if (!begins(c, seed) || !adopted_within(12u * HOUR))
        return;
    for (unsigned n = 0; n < HOUR; n++)
        loop_tick(&loop);
    if (!acts())
        return;
    loop.given.process.gain *= by->process;
    loop.given.path.gain *= by->path;
    loop.given.path.dead = (unsigned)(loop.given.path.dead * by->dead);
    bool acted = true;
    for (unsigned n = 1; n <= 12u * HOUR; n++) {
        loop_tick(&loop);
        signals += loop.io.requests.excite_state == EXCITE_RUNS;
        if (!acts() && !off_at)
            off_at = n;
        acted = acted || acts();
        with += loop.tuned.y * loop.tuned.y;
        alone += loop.alone.y * loop.alone.y;
        if (n % LOOK)
            continue;
        bool worse = acted && with > 1.15 * alone + 2e-5 * LOOK && alone < 100;
        run = worse ? run + LOOK : 0;
        longest = run > longest ? run : longest;
        last = worse ? n : last;
        with = alone = 0;
        acted = acts();
    }
    missed = missed || (float)longest > c->check_s;
    printf("%s,%u,%llu,%s,%u,%u,%u,%.2f\n", c->name, c->method, (unsigned long long)seed, by->name,
           off_at, longest, last, signals / 3600.0);
}

/* ---- the size of the test signal ---- */

static void sized(const struct loop_case *c, uint64_t seed)
{
    if (!begins(c, seed))
        return;
    bool adopted = false;
    struct tune_parts parts = loop_block(&loop);
    while (loop.t < 24u * HOUR && !adopted && tune_stages_stage(parts.stages) != TUNE_IDLE) {
        loop_tick(&loop);
        adopted = acts();
    }
    printf("%s,%u,%llu,%.4f,%d,%u,%.0f,%.1f,%.1f,%.4f\n", c->name, c->method,
           (unsigned long long)seed, c->step, adopted, (unsigned)tune_stages_verdict(parts.stages),
           (double)loop.t, 100 * (double)tune_search_spread(parts.search),
           100 * (double)tune_responses_change(parts.responses), (double)tune_step_wanted(&parts));
}

/* ---- what was asked for ---- */

static void one_plant(const char *what, unsigned k, unsigned m, uint64_t seed)
{
    struct loop_case c = plant_of(k, seed, m);
    if (strcmp(what, "stays") == 0 && m == seed % METHODS) {
        week(&c, seed);
        week_with_dead_band(&c, seed);
    }
    for (unsigned j = 0; strcmp(what, "change") == 0 && m == (seed + k) % METHODS && j < CHANGES;
         j++)
        changed(&c, seed, &changes[j]);
    for (double step = 0.005; strcmp(what, "steps") == 0 && step < 0.05; step *= 2) {
        c.step = step;
        sized(&c, seed);
        /* And as it says itself. */
        const struct tune_parts parts = loop_block(&loop);
        for (unsigned more = 0; more < 3 && !acts() && tune_step_wanted(&parts) > 0; more++) {
            c.step = fmin(0.5, (double)tune_step_wanted(&parts));
            sized(&c, seed);
        }
    }
}

static bool print_head(const char *what)
{
    if (strcmp(what, "stays") == 0)
        puts("plant,method,seed,adopted,at_s,worst,worst_with_signals,signals_h,signals_at_rest_h,"
             "offs,moving");
    else if (strcmp(what, "change") == 0)
        puts("plant,method,seed,change,off_s,longest_s,last_s,signals_h");
    else if (strcmp(what, "steps") == 0)
        puts("plant,method,seed,step,adopted,verdict,at_s,doubted,change,wanted");
    else
        return false;
    return true;
}

int main(int n, char **word)
{
    uint64_t first = n > 2 ? strtoull(word[2], NULL, 10) : 1;
    uint64_t seeds = n > 3 ? strtoull(word[3], NULL, 10) : SEEDS;
    unsigned stride = n > 4 ? (unsigned)strtoul(word[4], NULL, 10) : 1;
    const char *what = n > 1 ? word[1] : "";
    if (!print_head(what) || stride == 0) {
        fputs("feedforward_tuner stays|change|steps [SEED [SEEDS [STRIDE]]]\n", stderr);
        return 2;
    }
    for (uint64_t seed = first; seed < first + seeds; seed++)
        for (unsigned k = 0; k < PLANTS; k += stride)
            for (unsigned m = 0; m < METHODS; m++)
                one_plant(what, k, m, seed);
    return missed ? 1 : 0;
}

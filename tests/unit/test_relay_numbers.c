/* Guards the promise of docs/inside/proofs.md that tests notice nine in ten faults drawn from the code. Answers are compared with references
 * within bounds, and a changed threshold, weight or fall-back mostly stays within them. Here it moves a line.
 *
 * The lines are every number of relay tests on small processes, six digits each: with and without noise, a load, a drift, lost samples,
 * an amplitude that is given or searched for, little room, and processes that do not answer or do not come back. test_relay.c checks how
 * right the numbers are.
 *
 * Kept in reference/relay_numbers.txt, which support/kept_transcript.h says how to write anew. */
#include <math.h>
#include <string.h>

#include "identify/relay.h"
#include "kept_transcript.h"
#include "step_records.h"
#include "unity.h"

#define SEED   20261122u
#define DELAYS 512
#define REST   0.4

static struct relay relay;

void setUp(void)
{
    memset(&relay, 0, sizeof relay);
}
void tearDown(void) {}

struct relay_case {
    const char *name;
    double gain, lag[2];
    unsigned dead;                        /* samples */
    double noise, load, drift;            /* load at the input from sample 60; drift per sample */
    double amplitude, most, wanted, hyst; /* 0: as below */
    double share;                         /* of its limit for a deviation of 1 */
    unsigned patience, half_most, lost;
    unsigned load_at; /* 0: 60 */
};

static const struct relay_case cases[] = {
    {"one lag and dead time", 1, {30, 0}, 8, .amplitude = 0.1},
    {"two lags", 1, {30, 12}, 4, .amplitude = 0.1},
    {"falls where its input rises", -1.5, {40, 10}, 5, .amplitude = 0.1},
    {"noise", 1, {30, 12}, 6, .noise = 2e-4, .amplitude = 0.1},
    {"much noise", 1, {30, 12}, 6, .noise = 1.5e-3, .amplitude = 0.1, .hyst = 4.5e-3},
    {"an amplitude to be found", 0.6, {30, 12}, 6, .noise = 2e-4},
    {"an amplitude to be found, small gain", 0.05, {20, 5}, 3, .noise = 2e-4},
    {"an amplitude to be found, large gain", 12, {20, 5}, 3, .noise = 2e-4},
    {"a load", 1, {30, 12}, 6, .load = 0.06, .amplitude = 0.1},
    {"a load and little room", 1, {30, 12}, 6, .load = 0.09, .amplitude = 0.1, .most = 0.12},
    {"a load the other way", 1, {30, 12}, 6, .load = -0.08, .amplitude = 0.1, .noise = 1e-4},
    {"a load beyond its room", 1, {30, 12}, 6, .load = 0.3, .amplitude = 0.1, .half_most = 400},
    {"a drift", 1, {30, 12}, 6, .drift = 2e-5, .amplitude = 0.1},
    {"a drift to be found in", 1, {30, 12}, 6, .drift = -1e-5, .noise = 1e-4},
    {"one sample in seven lost", 1, {30, 12}, 6, .amplitude = 0.1, .lost = 7},
    {"one sample in seven lost, noise", 1, {30, 12}, 6, .noise = 3e-4, .lost = 7},
    {"no answer", 0.0001, {30, 12}, 6, .most = 0.2, .patience = 40},
    {"an answer in the end", 0.02, {30, 12}, 6, .most = 0.5, .patience = 40},
    {"slow: points of several samples", 1, {900, 300}, 120, .noise = 1e-4, .amplitude = 0.1},
    {"hardly a lag", 1, {1, 0}, 3, .amplitude = 0.1},
    {"little comes back against the input", 1, {200, 0}, 4, .amplitude = 0.1, .hyst = 0.02},
    {"hardly anything comes back", 1, {400, 0}, 2, .amplitude = 0.1, .hyst = 0.03},
    {"a third comes back", 1, {60, 0}, 3, .amplitude = 0.1, .hyst = 0.015},
    {"a quarter comes back", 1, {100, 0}, 4, .amplitude = 0.1, .hyst = 0.016},
    {"less comes back", 1, {60, 0}, 3, .amplitude = 0.1, .hyst = 0.022},
    {"still less comes back", 1, {60, 0}, 3, .amplitude = 0.1, .hyst = 0.028},
    {"near its limit", 1, {30, 12}, 6, .noise = 2e-4, .wanted = 0.05, .share = 60},
    {"far from its limit", 1, {30, 12}, 6, .noise = 2e-4, .wanted = 0.05, .share = 5},
};

#define CASES (sizeof cases / sizeof cases[0])

static void says_period(const struct relay_period *p)
{
    kept_line("period %u high %u top %.6g bottom %.6g mean %.6g block %u whole %d y %.6g %.6g",
              (unsigned)p->samples, (unsigned)p->high, (double)p->top, (double)p->bottom,
              (double)p->mean, (unsigned)p->block, p->whole, (double)p->y[0], (double)p->y[5]);
}

/* brief: how it ended alone. */
static void run(const struct relay_case *p, unsigned number, bool brief)
{
    struct random_source random = {SEED + number};
    double past[DELAYS] = {0}, state[2] = {0}, level = 0;
    unsigned changes = 0;
    struct relay_config c = {
        .h_s = 2,
        .sign = (int8_t)(p->gain < 0 ? -1 : 1),
        .reference = (real_t)REST,
        .noise_sd = (real_t)(p->noise > 0 ? p->noise : 1e-6),
        .hysteresis = (real_t)(p->hyst > 0 ? p->hyst : 1e-3),
        .amplitude = (real_t)p->amplitude,
        .first = REAL_C(0.02),
        .most = (real_t)(p->most > 0 ? p->most : 0.4),
        .wanted = (real_t)(p->wanted > 0 ? p->wanted : 0.01),
        .patience = p->patience > 0 ? p->patience : 100,
        .half_most = p->half_most > 0 ? p->half_most : 5000,
    };
    if (!brief)
        kept_line("# %s", p->name);
    TEST_ASSERT_EQUAL_INT(ERR_OK, relay_begin(&relay, &c));
    for (unsigned k = 0; k < 20000 && relay.phase < RELAY_DONE; k++) {
        double u = level + (k > (p->load_at > 0 ? p->load_at : 60) ? p->load : 0.0);
        double y = REST + p->drift * k, out;
        past[k % DELAYS] = u;
        out = k >= p->dead ? past[(k - p->dead) % DELAYS] : 0.0;
        for (unsigned i = 0; i < 2; i++) {
            if (p->lag[i] > 0)
                state[i] = out + (state[i] - out) * exp(-1.0 / p->lag[i]);
            else
                state[i] = out;
            out = state[i];
        }
        y += p->gain * out + (p->noise > 0 ? p->noise * normal(&random) : 0.0);
        if (p->lost > 0 && k > 0 && k % p->lost == 0)
            TEST_ASSERT_EQUAL_INT(ERR_OK, relay_missed(&relay));
        else
            TEST_ASSERT_EQUAL_INT(
                ERR_OK, relay_step(&relay, (real_t)y, (real_t)(p->share * fabs(y - REST))));
        if ((double)relay.level == level)
            continue;
        level = (double)relay.level;
        if (changes++ < 12 && !brief)
            kept_line("at %u level %.6g amplitude %.6g bias %.6g half %u periods %u same %u", k,
                      level, (double)relay.amplitude, (double)relay.bias, (unsigned)relay.half,
                      relay.periods, relay.same);
    }
    kept_line("phase %d failure %d changes %u periods %u same %u started %u longest %u share %.6g",
              relay.phase, relay.failure, changes, relay.periods, relay.same,
              (unsigned)relay.started, (unsigned)relay.longest, (double)relay.share);
    kept_line("half %u amplitude %.6g bias %.6g", (unsigned)relay.half, (double)relay.amplitude,
              (double)relay.bias);
    for (unsigned i = 0; i < RELAY_PERIODS && !brief; i++)
        says_period(&relay.period[i]);
    struct relay_result r;
    if (relay_look(&relay, &r) == ERR_OK)
        kept_line("gain %.6g described %.6g period %.6g amplitude %.6g peak %.6g bias %.6g spread "
                  "%.6g periods %u",
                  (double)r.gain, (double)r.described, (double)r.period_s, (double)r.amplitude,
                  (double)r.peak, (double)r.bias, (double)r.spread, r.periods);
}

static struct relay_case of;

static void plain(void)
{
    of = (struct relay_case){"", 1, {30, 12}, 6, .amplitude = 0.1};
}

static void grows(const char *what, double *number, double from, double times, unsigned n)
{
    kept_line("# %s", what);
    for (double x = from; n > 0; n--, x *= times) {
        *number = x;
        kept_line("%.4g", x);
        run(&of, 100, true);
    }
}

/* One number grows through the place where the outcome changes. */
static void families(void)
{
    plain();
    grows("noises", &of.noise, 2e-4, 1.5, 8);
    of.noise = 5e-3;
    of.hyst = 6e-3;
    grows("noises and little hysteresis", &of.noise, 2e-3, 1.4, 5);
    plain();
    of.gain = 0.05;
    of.lag[0] = 2;
    of.lag[1] = 0;
    of.dead = 3;
    of.hyst = 3e-3;
    grows("noises on a short period", &of.noise, 1e-3, 1.5, 8);
    plain();
    of.gain = -1;
    grows("loads", &of.load, 0.005, 1.5, 9);
    plain();
    of.most = 0.12;
    grows("loads with little room", &of.load, -0.01, 1.25, 6);
    plain();
    of.load_at = 105;
    grows("loads that come late", &of.load, 0.05, 1.6, 5);
    of.load_at = 165;
    of.amplitude = 0;
    of.gain = -1;
    of.noise = 1e-4;
    grows("late, an amplitude to be found", &of.load, -0.02, 1.8, 6);
    of.lost = 5;
    grows("late, samples lost", &of.load, 0.03, 1.8, 5);
    of.share = 4;
    grows("late, with a limit", &of.load, 0.03, 1.6, 5);
    plain();
    of.amplitude = 0;
    of.noise = 1e-4;
    of.wanted = 0.03;
    grows("limits", &of.share, 20, 1.17, 11);
    of.gain = 5;
    of.wanted = 0.005;
    grows("limits it begins beyond", &of.share, 40, 1.15, 7);
    of.wanted = 0.03;
    of.share = 0;
    grows("gains", &of.gain, 0.02, 1.5, 12);
    of.gain = 1;
    grows("amplitudes wanted", &of.wanted, 0.004, 1.4, 6);
    plain();
    of.gain = 0.001;
    of.amplitude = 0;
    of.patience = 50;
    of.half_most = 400;
    of.drift = 1e-6;
    grows("no answer, with a limit", &of.share, 100, 2, 6);
    plain();
    of.lag[0] = 100;
    of.lag[1] = 0;
    of.dead = 4;
    grows("hysteresis", &of.hyst, 0.004, 1.25, 10);
}

static void the_numbers_of_relay_tests_are_the_ones_kept(void)
{
    kept_open("reference/relay_numbers.txt", "a threshold, a weight or a fall-back of a relay test "
                                             "that changes by mistake moves a line");
    for (unsigned i = 0; i < CASES; i++)
        run(&cases[i], i, false);
    families();
    kept_close();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_numbers_of_relay_tests_are_the_ones_kept);
    return UNITY_END();
}

/* Gain, lead, lag and dead time from an exact ratio, Siddha's nine cases; the optima beside ours are those of the digest's section 8.3 (lead of
 * either sign, no dead time; grid 0.5 to 6 rad/s, weight 1/(w Ts), backward difference, Ts 0.05 s).
 *
 * Contract: where the optimum has no lead below 0, J is at most that and 0.02 J0; in the cases whose disturbance path has the longer dead
 * time, with the dead time of the element, J is below that optimum. */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "kinds/ff_tune/feedforward_search.h"
#include "num/real_trig.h"
#include "siddha_loop.h"
#include "unity.h"

#define PIECES_MOST 400u

static struct feedforward_wanted wanted;
static struct feedforward_search search;

void setUp(void) {}
void tearDown(void) {}

static const double best_known[SIDDHA_CASES] = {21.23, 0, 14.74, 16.96, 0, 1.358, 17.78, 0, 3.740};

static void want(int regime, double dead_most)
{
    memset(&wanted, 0, sizeof wanted);
    wanted.points = 12;
    wanted.h_s = REAL_C(0.05);
    wanted.kick = REAL_C(100.0);
    wanted.lag_most = REAL_C(3.0);
    wanted.dead_most = (real_t)dead_most;
    for (unsigned i = 0; i < wanted.points; i++) {
        double w = 0.5 * (i + 1);
        double complex r = siddha_ratio(regime, w);
        wanted.omega[i] = (real_t)w;
        wanted.ratio[i] = cplx((real_t)creal(r), (real_t)cimag(r));
        wanted.weight[i] = (real_t)(1 / (w * SIDDHA_TS));
    }
}

static unsigned run_search(void)
{
    unsigned pieces = 1;
    feedforward_search_begin(&search, &wanted);
    while (feedforward_search_piece(&search, &wanted)) {
        pieces++;
        TEST_ASSERT_LESS_THAN(PIECES_MOST, pieces);
    }
    return pieces;
}

static bool needs_dead_time(int regime)
{
    return siddha_case[regime].dead > 12;
}

static void say_found(int regime, unsigned pieces)
{
    printf("%-5s K %.4f lead %.4f lag %.4f dead %.4f J %.3f (known %.3f, K = 0 %.1f), %u pieces\n",
           siddha_case[regime].name, (double)search.best.k, (double)search.best.lead,
           (double)search.best.lag, (double)search.best.dead, (double)search.j, best_known[regime],
           (double)search.j0, pieces);
}

static void without_dead_time_the_known_optima_are_met(void)
{
    for (int c = 0; c < SIDDHA_CASES; c++) {
        if (needs_dead_time(c))
            continue;
        want(c, 0);
        say_found(c, run_search());
        TEST_ASSERT_TRUE(search.j <= best_known[c] + 0.02 * search.j0);
    }
}

static void a_dead_time_does_what_a_lead_below_nothing_imitates(void)
{
    for (int c = 0; c < SIDDHA_CASES; c++) {
        want(c, 0.5);
        say_found(c, run_search());
        TEST_ASSERT_TRUE(search.j <= best_known[c] + 0.02 * search.j0);
        if (needs_dead_time(c)) {
            TEST_ASSERT_TRUE(search.j < best_known[c]);
            TEST_ASSERT_FLOAT_WITHIN(0.06, 0.2, search.best.dead);
        }
    }
}

/* Another program's way to J: with the shape that came out. */
static void j_is_that_of_the_shape(void)
{
    want(3, 0);
    (void)run_search();
    double j = 0;
    for (unsigned i = 0; i < wanted.points; i++) {
        double w = 0.5 * (i + 1);
        j += 1 / (w * SIDDHA_TS) *
             cabs(siddha_ratio(3, w) + siddha_feedforward((double)search.best.k,
                                                          (double)search.best.lead,
                                                          (double)search.best.lag, w));
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-3, j, search.j);
}

static void jumps_are_amplified_by_no_more_than_is_allowed(void)
{
    for (int c = 0; c < SIDDHA_CASES; c++) {
        want(c, 0);
        wanted.kick = REAL_C(3.0);
        (void)run_search();
        const struct feedforward_shape *f = &search.best;
        TEST_ASSERT_TRUE(f->lead >= 0 && f->lag >= 0 && f->lag <= REAL_C(3.0001));
        TEST_ASSERT_TRUE((f->lead + wanted.h_s) / (f->lag + wanted.h_s) <= REAL_C(3.001));
    }
}

/* Ratios that would like more of everything. */
static void nothing_is_above_its_most(void)
{
    for (unsigned k = 0; k < 40; k++) {
        want((int)k % SIDDHA_CASES, 0.02 + 0.01 * k);
        wanted.lag_most = (real_t)(0.01 + 0.005 * k);
        wanted.kick = (real_t)(1 + 0.2 * k);
        for (unsigned i = 0; i < wanted.points; i++)
            wanted.ratio[i] =
                cplx_scale(cplx_mul(wanted.ratio[i], cplx_turned(REAL_C(-0.5) * wanted.omega[i])),
                           (real_t)(k % 3 == 2 ? 300 : 1));
        (void)run_search();
        const struct feedforward_shape *f = &search.best;
        TEST_ASSERT_TRUE(f->lag >= 0 && f->lag <= wanted.lag_most);
        TEST_ASSERT_TRUE(f->dead >= 0 && f->dead <= wanted.dead_most);
        TEST_ASSERT_TRUE(real_abs(f->k) <= 100);
        TEST_ASSERT_TRUE(f->lead >= 0 && f->lead + wanted.h_s <=
                                             REAL_C(1.0001) * wanted.kick * (f->lag + wanted.h_s));
        TEST_ASSERT_TRUE(search.j <= search.j0);
    }
}

/* A range of dead times so long that the grid has nothing near. */
static void a_lag_and_dead_time_to_begin_with_help_where_the_grid_is_coarse(void)
{
    const struct feedforward_shape near = {.lag = REAL_C(0.25), .dead = REAL_C(0.2)};
    want(2, 40);
    (void)run_search();
    real_t alone = search.j;
    unsigned pieces = 1;
    feedforward_search_begin(&search, &wanted);
    feedforward_search_near(&search, &wanted, &near);
    while (feedforward_search_piece(&search, &wanted))
        TEST_ASSERT_LESS_THAN(PIECES_MOST, ++pieces);
    printf("dead times to 40 s: J %.3f, begun near %.3f of %.1f\n", (double)alone, (double)search.j,
           (double)search.j0);
    TEST_ASSERT_TRUE(search.j < REAL_C(0.01) * search.j0);
    TEST_ASSERT_TRUE(search.j <= alone);
}

static void what_is_not_known_counts_nothing(void)
{
    want(4, 0);
    for (unsigned i = 6; i < 12; i++) {
        wanted.weight[i] = 0;
        wanted.ratio[i] = cplx(REAL_C(-50.0), REAL_C(20.0));
    }
    (void)run_search();
    TEST_ASSERT_FLOAT_WITHIN(0.01, -1, search.best.k);
    TEST_ASSERT_TRUE(search.j < REAL_C(0.02) * search.j0);
}

/* It never does worse than no feedforward. */
static void a_ratio_that_no_lead_lag_follows_gives_no_more_than_nothing(void)
{
    struct siddha_loop s;
    for (uint64_t seed = 1; seed <= 50; seed++) {
        siddha_begin(&s, 0, 0, seed);
        want(0, 0.5);
        for (unsigned i = 0; i < wanted.points; i++)
            wanted.ratio[i] = cplx((real_t)siddha_normal(&s), (real_t)siddha_normal(&s));
        (void)run_search();
        TEST_ASSERT_TRUE(search.j <= search.j0);
        TEST_ASSERT_TRUE(real_abs(search.best.k) <= REAL_C(100.0));
    }
}

/* The ratio asks for a rate alone, of which an element without a lag has none. */
static void where_no_lead_can_follow_the_ratio_the_best_gain_alone_is_found(void)
{
    real_t sine, cosine;
    double best = 1e9;
    want(0, 0);
    wanted.h_s = REAL_C(0.4);
    wanted.lag_most = 0;
    wanted.kick = 1;
    for (unsigned i = 0; i < wanted.points; i++) {
        real_sincos(wanted.omega[i] * wanted.h_s, &sine, &cosine);
        wanted.ratio[i] = cplx(-(1 - cosine) / wanted.h_s, -sine / wanted.h_s);
    }
    (void)run_search();
    for (unsigned k = 0; k <= 500; k++) {
        const struct feedforward_shape gain = {.k = (real_t)(0.01 * k)};
        best = fmin(best, (double)feedforward_objective(&wanted, &gain));
    }
    TEST_ASSERT_TRUE(best < 0.97 * (double)search.j0);
    TEST_ASSERT_TRUE((double)search.j <= best + 1e-4 * (double)search.j0);
}

static void with_noise_of_a_twentieth_the_shape_is_as_good(void)
{
    struct siddha_loop s;
    for (int c = 0; c < SIDDHA_CASES; c++) {
        want(c, 0.5);
        struct feedforward_wanted exact = wanted;
        double worst = 0;
        for (uint64_t seed = 1; seed <= 20; seed++) {
            siddha_begin(&s, c, 0, seed);
            for (unsigned i = 0; i < wanted.points; i++)
                wanted.ratio[i] =
                    cplx_add(exact.ratio[i], cplx((real_t)(0.035 * siddha_normal(&s)),
                                                  (real_t)(0.035 * siddha_normal(&s))));
            (void)run_search();
            worst = fmax(worst, (double)feedforward_objective(&exact, &search.best));
        }
        printf("%-5s worst J of 20 on the exact ratio %.2f, best known %.2f\n", siddha_case[c].name,
               worst, best_known[c]);
        TEST_ASSERT_TRUE(worst <= best_known[c] + 0.15 * (double)search.j0);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_dead_time_the_known_optima_are_met);
    RUN_TEST(a_dead_time_does_what_a_lead_below_nothing_imitates);
    RUN_TEST(j_is_that_of_the_shape);
    RUN_TEST(jumps_are_amplified_by_no_more_than_is_allowed);
    RUN_TEST(nothing_is_above_its_most);
    RUN_TEST(a_lag_and_dead_time_to_begin_with_help_where_the_grid_is_coarse);
    RUN_TEST(what_is_not_known_counts_nothing);
    RUN_TEST(a_ratio_that_no_lead_lag_follows_gives_no_more_than_nothing);
    RUN_TEST(where_no_lead_can_follow_the_ratio_the_best_gain_alone_is_found);
    RUN_TEST(with_noise_of_a_twentieth_the_shape_is_as_good);
    return UNITY_END();
}

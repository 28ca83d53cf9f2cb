/* commission/judge.[ch]: every number that a record is judged by, against the same in double, and the bounds of what is too short
 * to tell.
 *
 * Contract
 *   1e-4 of the largest number that goes into it, over 400 records of random levels, lengths and resolutions
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "commission/test_verdict.h"
#include "step_records.h"
#include "unity.h"

#define SEED 20261122u

static struct record r;
static struct baseline b;
static struct test_verdict v;
static struct random_source source = {SEED};

void setUp(void)
{
    memset(&r, 0, sizeof r);
    b = (struct baseline){0};
    r.h_s = 2;
    r.block = 2;
}
void tearDown(void) {}

static void edges(uint32_t up, uint32_t down, uint32_t back, uint32_t end)
{
    r.input.edges = 3;
    r.input.edge[0].sample = up;
    r.input.edge[1].sample = down;
    r.input.edge[2].sample = back;
    r.samples = end;
    r.points = end / r.block;
}

/* ---- the same in double ---- */

static double at(uint32_t i)
{
    double t = ((double)i * r.block + (r.block - 1) / 2.0) * (double)r.h_s;
    return (double)r.y[1][i] - (double)b.offset - (double)b.slope_per_s * t;
}

static double mean(uint32_t from, uint32_t n)
{
    double sum = 0.0;
    for (uint32_t i = from; i < from + n; i++)
        sum += at(i);
    return sum / n;
}

/* Points from the one after an edge to the next edge. */
static void halves(uint32_t from, uint32_t to, double *first, double *second)
{
    uint32_t sixth = (to - from) / 6, middle = (from + to) / 2;
    double half = mean(middle - sixth / 2, sixth);
    *first = half - at(from);
    *second = mean(to - sixth, sixth) - half;
}

static double end_of(uint32_t from, uint32_t to)
{
    uint32_t quarter = (to - from) / 4;
    return mean(to - quarter, quarter);
}

#define NEAR(wanted, value) TEST_ASSERT_DOUBLE_WITHIN(1e-4, wanted, (double)(value))

static void check(double amplitude, double drift)
{
    const uint32_t *edge[3] = {&r.input.edge[0].sample, &r.input.edge[1].sample,
                               &r.input.edge[2].sample};
    uint32_t from[3], to[3];
    for (unsigned i = 0; i < 3; i++) {
        from[i] = *edge[i] / r.block + 1;
        to[i] = (i < 2 ? *edge[i + 1] : r.samples) / r.block;
    }
    test_verdict_of(&r, 1, &b, (real_t)amplitude, (real_t)drift, &v);
    double first[2], second[2], noise = (double)b.noise_sd / sqrt(r.block);
    uint32_t up = to[0] - from[0], down = to[1] - from[1], shorter = down < up ? down : up;
    for (unsigned i = 0; i < 2; i++)
        halves(from[i], to[i], &first[i], &second[i]);
    double one = fabs(first[0] - first[1]), two = fabs(second[0] - second[1]);
    NEAR(one, v.first);
    NEAR(two, v.second);
    NEAR(2.0 * noise / sqrt(shorter / 6), v.change_sd);
    TEST_ASSERT_EQUAL(one + two > 6.0 * noise, v.moves);
    double climbs = one + two > 6.0 * noise ? two / fmax(one, noise) : 0.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * (1.0 + climbs), climbs, (double)v.climbs);
    double u = end_of(from[0], to[0]), d = end_of(from[1], to[1]), rest = end_of(from[2], to[2]);
    double gain[3] = {u / amplitude, (u - d) / (2.0 * amplitude), (rest - d) / amplitude};
    double size = 1e-4 * (fabs(gain[0]) + fabs(gain[1]) + fabs(gain[2]) + 1.0);
#define ALIKE(wanted, value) TEST_ASSERT_DOUBLE_WITHIN(size, wanted, (double)(value))
    ALIKE(fmax(gain[0], fmax(gain[1], gain[2])) - fmin(gain[0], fmin(gain[1], gain[2])), v.spread);
    ALIKE(gain[1], v.level);
    ALIKE(fabs(rest) / (2.0 * amplitude), v.left);
    double level_noise = (double)b.noise_sd / sqrt((double)r.block * (shorter / 4));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * level_noise / amplitude, level_noise / sqrt(2.0) / amplitude,
                              (double)v.level_sd);
    double uncertain =
        sqrt(3.0 * level_noise * level_noise + (double)b.offset_sd * (double)b.offset_sd);
    double explained = 3.0 * uncertain + drift * (to[0] - from[0]) * r.block * (double)r.h_s;
    double apart = fabs(gain[0] - gain[2]) * amplitude;
    if (fabs(apart - explained) > 1e-4 * (apart + explained))
        ALIKE(apart > explained ? gain[0] - gain[2] : 0.0, v.asymmetry);
}

static void every_number_is_that_of_its_definition(void)
{
    for (unsigned n = 0; n < 400; n++) {
        setUp();
        r.block = 1u << random_below(&source, 3);
        uint32_t up = random_below(&source, 20),
                 half = (14 + random_below(&source, 10)) * r.block + random_below(&source, 4);
        uint32_t later = random_below(&source, 10); /* the way down may be longer */
        edges(up, up + half, up + 2 * half + later, up + 2 * half + later + 12 * r.block + n % 20);
        double levels[4] = {0, uniform(&source, -1, 1), uniform(&source, -1, 1),
                            uniform(&source, -0.1, 0.1)};
        for (uint32_t i = 0; i < r.points; i++) {
            unsigned part = i * r.block >= up + 2 * half + later ? 3
                            : i * r.block >= up + half           ? 2
                            : i * r.block >= up                  ? 1
                                                                 : 0;
            r.y[1][i] = (real_t)(0.1 * (levels[part] * (1.0 + 0.01 * i) + 0.2 * normal(&source)));
        }
        b.offset = (real_t)uniform(&source, -0.01, 0.01);
        b.slope_per_s = (real_t)uniform(&source, -1e-5, 1e-5);
        b.noise_sd = (real_t)spread_over(&source, 1e-4, 0.03);
        b.offset_sd = (real_t)spread_over(&source, 1e-5, 0.02);
        check(uniform(&source, 0.02, 0.2),
              random_below(&source, 2) ? spread_over(&source, 1e-6, 1e-3) : 0.0);
    }
}

/* ---- what is too short ---- */

static void judged(void)
{
    for (uint32_t i = 0; i < r.points; i++)
        r.y[1][i] = (real_t)(0.1 * sin(i));
    test_verdict_of(&r, 1, &b, REAL_C(0.1), 0, &v);
}

static void halves_take_twelve_points_and_levels_eight(void)
{
    for (unsigned n = 6; n < 15; n++)
        for (unsigned part = 0; part < 3; part++) {
            uint32_t length[3] = {60, 60, 60};
            length[part] = 2 * (n + 1); /* of n points, the one of the edge apart */
            setUp();
            edges(10, 10 + length[0], 10 + length[0] + length[1],
                  10 + length[0] + length[1] + length[2]);
            judged();
            bool cut_short = part == 1; /* by more than two points: its end is no level */
            TEST_ASSERT_EQUAL(part == 2 || n >= 12, v.first > 0);
            TEST_ASSERT_EQUAL(n >= 8 && !cut_short, v.spread > 0);
        }
    for (unsigned shorter = 0; shorter < 4; shorter++) {
        setUp();
        edges(10, 70, 130 - 2 * shorter, 190);
        judged();
        TEST_ASSERT_EQUAL(shorter <= 2, v.spread > 0);
    }
    for (unsigned n = 7; n < 10; n++) { /* both short */
        setUp();
        edges(10, 10 + 2 * (n + 1), 10 + 4 * (n + 1), 100);
        judged();
        TEST_ASSERT_EQUAL(n >= 8, v.spread > 0);
    }
    setUp();
    edges(10, 70, 130, 190);
    r.input.edges = 2;
    judged();
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)v.spread);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)v.first);
}

static void the_last_three_edges_are_those_of_the_double_step(void)
{
    setUp();
    edges(10, 70, 130, 190);
    judged();
    struct test_verdict alone = v;
    r.input.edges = 5;
    for (unsigned i = 5; i-- > 2;)
        r.input.edge[i] = r.input.edge[i - 2];
    r.input.edge[0].sample = 2;
    r.input.edge[1].sample = 6;
    judged();
    TEST_ASSERT_EQUAL_MEMORY(&alone, &v, sizeof v);
    TEST_ASSERT_TRUE(v.spread > 0 && v.first > 0);
}

/* ---- what levels show of a lag ---- */

static void a_lag_shows_this_much_of_itself_at_the_end_of_its_levels(void)
{
    for (unsigned n = 0; n < 200; n++) {
        setUp();
        uint32_t up = 20 + random_below(&source, 200), down = 20 + random_below(&source, 200);
        edges(7, 7 + up, 7 + up + down, 1000);
        double dead = uniform(&source, 0, 100), lag = spread_over(&source, 1, 1000);
        double left_up = 0.875 * up * 2.0 - dead, left_down = 0.875 * down * 2.0 - dead;
        double high = 1.0 - exp(-left_up / lag), from = 1.0 - exp(-(up * 2.0 - dead) / lag);
        double low = -1.0 + (1.0 + from) * exp(-left_down / lag);
        double wanted = left_up <= 0 || left_down <= 0 ? 0.0 : 0.5 * (high - low);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, wanted,
                                  (double)test_verdict_level_of(&r, (real_t)dead, (real_t)lag));
    }
    TEST_ASSERT_EQUAL_FLOAT(1.0f, (float)test_verdict_level_of(&r, 0, 0));
    r.input.edges = 2;
    TEST_ASSERT_EQUAL_FLOAT(1.0f, (float)test_verdict_level_of(&r, 1000, 10));
}

int main(void)
{
    printf("seed %u\n", SEED);
    UNITY_BEGIN();
    RUN_TEST(every_number_is_that_of_its_definition);
    RUN_TEST(halves_take_twelve_points_and_levels_eight);
    RUN_TEST(the_last_three_edges_are_those_of_the_double_step);
    RUN_TEST(a_lag_shows_this_much_of_itself_at_the_end_of_its_levels);
    return UNITY_END();
}

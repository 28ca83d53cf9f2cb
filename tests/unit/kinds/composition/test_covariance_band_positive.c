/* No variance of the banded covariance (kinds/composition/covariance_band.h) becomes 0 or less, or grows without bound, whatever is measured: 1e5
 * steps with sensors that come and go, without noise, and with numbers of many decades. */
#include "band_bench.h"

#define SEED   20261126u
#define STAGES 10

void setUp(void)
{
    source.state = SEED;
}

void tearDown(void) {}

static void is_positive(double most_allowed)
{
    real_t least, most;
    for (size_t i = 0; i < band.stages * band.m; i++)
        TEST_ASSERT_TRUE(at_stage(i / band.m)[i % band.m * (band.m + 1)] > 0);
    covariance_band_extremes(&band, &least, &most);
    TEST_ASSERT_TRUE(least > 0);
    TEST_ASSERT_TRUE((double)most <= most_allowed);
}

/* Sensors come and go; their noise is between what P is and a millionth of a millionth of it. */
static void runs_positive(unsigned count, double most_allowed)
{
    real_t slope[SENSORS][M_MOST];
    struct covariance_measurement z[SENSORS];
    for (unsigned k = 0; k < SENSORS; k++) {
        z[k] = draw_measurement(slope[k]);
        z[k].variance = (real_t)pow(10, -4 * (double)k);
    }
    for (unsigned k = 0; k < count; k++) {
        uint32_t mask = random_below(&source, 1u << SENSORS);
        while (covariance_band_carry_piece(&band, &step, AT_ONCE)) {
        }
        TEST_ASSERT_EQUAL(ERR_OK, band.err);
        is_positive(most_allowed);
        for (unsigned sensor = 0; sensor < SENSORS; sensor++) {
            if (!(mask >> sensor & 1))
                continue;
            real_t of = covariance_band_of(&band, &z[sensor]);
            TEST_ASSERT_TRUE(of >= 0);
            real_t alpha = covariance_band_take(&band, &z[sensor], gain);
            TEST_ASSERT_TRUE(alpha >= z[sensor].variance);
        }
        is_positive(most_allowed);
    }
}

static void variances_stay_positive_with_noise(void)
{
    for (size_t m = 2; m <= M_MOST; m++) {
        bench_band(STAGES, m, 3);
        runs_positive(20000, 1e3);
    }
}

static void variances_stay_positive_without_noise(void)
{
    for (size_t m = 2; m <= M_MOST; m++) {
        bench_band(STAGES, m, 3);
        step.noise_count = 0;
        for (size_t e = 0; e < 3; e++)
            grown[e] = 0;
        runs_positive(50000, 1e3);
    }
}

/* Holdups of seven decades, as of a reboiler beside trays of an hour's step. */
static void variances_stay_positive_where_numbers_are_stiff(void)
{
    for (unsigned kind = 0; kind < 20; kind++) {
        bench_band(STAGES, 2, 3);
        for (size_t s = 0; s < STAGES; s++) {
            real_t *of = &factors[s * column_transition_stride(2)];
            double part = pow(10, between(-7, 0));
            for (size_t i = 0; i < 4; i++)
                of[i] *= (real_t)part;
            of[12] /= (real_t)part; /* what flows in stays a part of what is there */
        }
        for (size_t i = 0; i < 2 * STAGES; i++)
            noise[i] = kind % 2 ? 0 : (real_t)pow(10, between(-15, -3));
        runs_positive(5000, 1e6);
    }
}

/* No step between them gives variances back what rounding takes. */
static void variances_stay_positive_where_measurements_come_without_steps(void)
{
    real_t slope[M_MOST], least, most;
    for (size_t m = 1; m <= M_MOST; m++) {
        bench_band(STAGES, m, 3);
        while (covariance_band_carry_piece(&band, &step, AT_ONCE)) {
        }
        covariance_band_extremes(&band, &least, &most);
        for (unsigned k = 0; k < 20000; k++) {
            struct covariance_measurement z = draw_measurement(slope);
            z.variance = (real_t)pow(10, between(-14, -2));
            TEST_ASSERT_TRUE(covariance_band_of(&band, &z) >= 0);
            TEST_ASSERT_TRUE(covariance_band_take(&band, &z, gain) >= z.variance);
            is_positive((double)most);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    printf("seed %u\n", SEED);
    RUN_TEST(variances_stay_positive_with_noise);
    RUN_TEST(variances_stay_positive_without_noise);
    RUN_TEST(variances_stay_positive_where_numbers_are_stiff);
    RUN_TEST(variances_stay_positive_where_measurements_come_without_steps);
    return UNITY_END();
}

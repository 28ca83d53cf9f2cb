/* block/feedforward.[ch].
 *
 * Contract                                              float32       Q7.24
 *   gain at rest                                        2e-7          2e-7
 *   step response against the recursion in double       1e-6          1e-6
 *   disturbance of a plant it fits exactly: largest
 *     deviation, with against without                   below 0.02    below 0.02 (sampling remains)
 */
#include <math.h>
#include <string.h>

#include "block/feedforward.h"
#include "fopdt_plant.h"
#include "formats.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static num_t ring[2048];

static struct feedforward make(struct feedforward_settings c, float h_s)
{
    struct feedforward ff;
    TEST_ASSERT_EQUAL_INT(ERR_OK, feedforward_init(&ff, &c, h_s, ring, sizeof ring));
    return ff;
}

static void at_rest_the_output_is_gain_times_the_deviation_from_the_reference(void)
{
    struct feedforward_settings c = feedforward_default_config();
    c.gain = -0.8f;
    c.lead_s = 12.0f;
    c.lag_s = 40.0f;
    c.dead_time_s = 7.3f;
    c.reference = 0.4f;
    struct feedforward ff = make(c, 0.5f);
    feedforward_reset(&ff, N(0.65));
    for (int k = 0; k < 100; k++)
        TEST_ASSERT_DOUBLE_WITHIN(2e-7, -0.8 * 0.25, D(feedforward_step(&ff, N(0.65))));
}

static void at_the_reference_nothing_is_called_for(void)
{
    struct feedforward_settings c = feedforward_default_config();
    c.gain = 100.0f;
    c.reference = 0.37f;
    struct feedforward ff = make(c, 1.0f);
    TEST_ASSERT_TRUE(num_eq(num_zero(), feedforward_step(&ff, N((double)0.37f))));
}

static void a_step_is_delayed_then_shaped(void)
{
    struct feedforward_settings c = feedforward_default_config();
    c.gain = 0.5f;
    c.lead_s = 30.0f;
    c.lag_s = 10.0f;
    c.dead_time_s = 4.0f;
    struct feedforward ff = make(c, 1.0f);
    feedforward_reset(&ff, num_zero());
    double y = 0.0, last = 0.0;
    for (int k = 0; k < 200; k++) {
        double x = k >= 4 ? D(N(0.2)) : 0.0;
        y += 1.0 / 11.0 * (x - y) + 30.0 / 11.0 * (x - last);
        last = x;
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5 * y, D(feedforward_step(&ff, N(0.2))));
    }
}

static void it_begins_as_if_the_disturbance_had_always_been_at_the_reference(void)
{
    struct feedforward_settings c = feedforward_default_config();
    c.gain = 2.0f;
    c.reference = 0.5f;
    c.lag_s = 10.0f;
    c.dead_time_s = 4.0f;
    memset(ring, 0x33, sizeof ring); /* whatever was there before */
    struct feedforward ff = make(c, 1.0f);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, D(ff.output));
    for (int k = 0; k < 4; k++)
        TEST_ASSERT_DOUBLE_WITHIN(0, 0, D(feedforward_step(&ff, N(0.75))));
    TEST_ASSERT_TRUE(D(feedforward_step(&ff, N(0.75))) > 0.0);
}

static void the_output_stays_within_its_own_limits(void)
{
    struct feedforward_settings c = feedforward_default_config();
    c.gain = 5.0f;
    c.lead_s = 50.0f;
    c.lag_s = 5.0f;
    c.out_lo = -0.1f;
    c.out_hi = 0.15f;
    struct feedforward ff = make(c, 1.0f);
    for (int k = 0; k < 500; k++) {
        double u = D(feedforward_step(&ff, N(sin(0.3 * k))));
        TEST_ASSERT_TRUE(u >= D(N((double)-0.1f)) && u <= D(N((double)0.15f)));
    }
}

static void a_gain_of_zero_is_off(void)
{
    struct feedforward ff = make(feedforward_default_config(), 1.0f);
    for (int k = 0; k < 10; k++)
        TEST_ASSERT_TRUE(num_eq(num_zero(), feedforward_step(&ff, N(0.1 * k))));
}

/* Disturbance 0.5 e^{-15s}/(50s+1), input 1.0 e^{-10s}/(30s+1): gain -0.5, lead 30, lag 50, dead time 5. */
static double largest_deviation(float gain)
{
    static struct fopdt_plant through_d, through_u;
    struct feedforward_settings c = feedforward_default_config();
    c.gain = gain;
    c.lead_s = 30.0f;
    c.lag_s = 50.0f;
    c.dead_time_s = 5.0f;
    struct feedforward ff = make(c, 0.25f);
    feedforward_reset(&ff, num_zero());
    fopdt_plant_init(&through_d, 0.5, 50.0, 60, 0.25, 0.0, 0.0);
    fopdt_plant_init(&through_u, 1.0, 30.0, 40, 0.25, 0.0, 0.0);
    double worst = 0.0;
    for (int k = 0; k < 4000; k++) {
        double d = 0.1;
        double y = fopdt_plant_step(&through_d, d) +
                   fopdt_plant_step(&through_u, D(feedforward_step(&ff, N(d))));
        worst = fmax(worst, fabs(y));
    }
    return worst;
}

static void a_disturbance_it_fits_is_cancelled(void)
{
    double without = largest_deviation(0.0f), with = largest_deviation(-0.5f);
    printf("deviation without %.4f, with %.6f\n", without, with);
    TEST_ASSERT_TRUE(with < 0.02 * without);
}

static void bad_settings_are_refused_by_name(void)
{
    const struct {
        float gain, lead, lag, dead, reference, lo, hi, h;
        enum err err;
        const char *field, *wanted;
    } bad[] = {
        {nanf(""), 0, 0, 0, 0, -1, 1, 1, ERR_NOT_FINITE, "gain", "-100 to 100"},
        {101, 0, 0, 0, 0, -1, 1, 1, ERR_RANGE, "gain", "-100 to 100"},
        {1, nanf(""), 0, 0, 0, -1, 1, 1, ERR_NOT_FINITE, "lead", "0 to 1e6 s"},
        {1, 101, 0, 0, 0, -1, 1, 1, ERR_RANGE, "lead", "at most 100 times (lag_s + step interval)"},
        {1, 0, -1, 0, 0, -1, 1, 1, ERR_RANGE, "lag", "0 to 1e6 s"},
        {-100.5f, 0, 0, 0, 0, -1, 1, 1, ERR_RANGE, "gain", "-100 to 100"},
        {1, 1.01e6f, 1e6f, 0, 0, -1, 1, 1, ERR_RANGE, "lead", "0 to 1e6 s"},
        {1, -0.5f, 0, 0, 0, -1, 1, 1, ERR_RANGE, "lead", "0 to 1e6 s"},
        {1, 0, 1.01e6f, 0, 0, -1, 1, 1, ERR_RANGE, "lag", "0 to 1e6 s"},
        {1, 0, 0, 1.01e6f, 0, -1, 1, 1e5f, ERR_RANGE, "dead", "0 to 1e6 s"},
        {1, 0, 0, -0.5f, 0, -1, 1, 1, ERR_RANGE, "dead", "0 to 1e6 s"},
        {1, 0, 0, 0, -1.01f, -1, 1, 1, ERR_RANGE, "reference", "-1 to 2"},
        {1, 0, 0, 0, 2.01f, -1, 1, 1, ERR_RANGE, "reference", "-1 to 2"},
        {1, 0, 0, 0, 0, -2.01f, 1, 1, ERR_RANGE, "lo", "-2 to 2"},
        {1, 0, 0, 0, 0, 2.01f, 3, 1, ERR_RANGE, "lo", "-2 to 2"},
        {1, 0, 0, 0, 0, -1, 2.01f, 1, ERR_RANGE, "hi", "-2 to 2"},
        {1, 0, 0, 0, 0, -1, -2.01f, 1, ERR_RANGE, "hi", "-2 to 2"},
        {1, 0, 0, nanf(""), 0, -1, 1, 1, ERR_NOT_FINITE, "dead", "0 to 1e6 s"},
        {1, 0, 0, 1e6f, 0, -1, 1, 1, ERR_RANGE, "dead", "at most 100000 step intervals"},
        {1, 0, 0, 0, 3, -1, 1, 1, ERR_RANGE, "reference", "-1 to 2"},
        {1, 0, 0, 0, 0, -3, 1, 1, ERR_RANGE, "lo", "-2 to 2"},
        {1, 0, 0, 0, 0, 1, 1, 1, ERR_RANGE, "hi", "above out_lo, to 2"},
        {1, 0, 0, 0, 0, -1, nanf(""), 1, ERR_NOT_FINITE, "hi", "-2 to 2"},
        {1, 0, 0, 0, 0, -1, 1, 0, ERR_RANGE, "", "0.001 to 1e5 s"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct feedforward_settings c = {bad[i].gain,      bad[i].lead, bad[i].lag, bad[i].dead,
                                         bad[i].reference, bad[i].lo,   bad[i].hi};
        struct feedforward ff, was;
        memset(&ff, 0x33, sizeof ff);
        memcpy(&was, &ff, sizeof ff);
        const char *field = "", *wanted = "";
        TEST_ASSERT_EQUAL_INT(bad[i].err, feedforward_validate(&c, bad[i].h, &field, &wanted));
        TEST_ASSERT_EQUAL_STRING(bad[i].field, field);
        TEST_ASSERT_EQUAL_STRING(bad[i].wanted, wanted);
        TEST_ASSERT_EQUAL_INT(bad[i].err, feedforward_init(&ff, &c, bad[i].h, ring, sizeof ring));
        TEST_ASSERT_EQUAL_MEMORY(&was, &ff, sizeof ff);
        TEST_ASSERT_EQUAL_UINT(0, feedforward_bytes(&c, bad[i].h));
    }
}

static void settings_at_the_ends_of_their_ranges_are_taken(void)
{
    static const float ends[][8] = {
        /* gain, lead, lag, dead, reference, lo, hi, h */
        {-100, 100, 0, 0, 0, -1, 1, 1},    {100, 300, 2, 0, 0, -1, 1, 1},
        {1, 0, 1e6f, 0, -1, -2, 2, 1},     {1, 1e6f, 1e4f, 0, 2, 1.99f, 2, 1},
        {1, 0, 0, 1e5f, 0, -2, -1.99f, 1}, {1, 0, 0, 100, 0, -1, 1, 1e-3f},
        {1, 0, 0, 1e6f, 0, -1, 1, 1e5f},
    };
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++) {
        const float *e = ends[i];
        const struct feedforward_settings c = {e[0], e[1], e[2], e[3], e[4], e[5], e[6]};
        const char *field = "";
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, feedforward_validate(&c, e[7], &field, NULL), field);
        TEST_ASSERT_TRUE(feedforward_bytes(&c, e[7]) > 0);
    }
}

static void it_begins_at_rest_at_its_reference(void)
{
    struct feedforward_settings c = feedforward_default_config();
    TEST_ASSERT_EQUAL_FLOAT(-1.0f, c.out_lo);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, c.out_hi);
    c.gain = 2.0f;
    c.reference = 0.25f;
    c.out_lo = 0.125f; /* not even where that is against its limits */
    struct feedforward ff = make(c, 1.0f);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.125, D(ff.output));
}

static void a_ring_that_is_too_small_is_refused(void)
{
    struct feedforward_settings c = feedforward_default_config();
    c.dead_time_s = 60.0f;
    struct feedforward ff;
    size_t bytes = feedforward_bytes(&c, 1.0f);
    TEST_ASSERT_EQUAL_UINT(62 * sizeof(num_t), bytes);
    TEST_ASSERT_EQUAL_INT(ERR_MEMORY, feedforward_init(&ff, &c, 1.0f, ring, bytes - 1));
    TEST_ASSERT_EQUAL_INT(ERR_OK, feedforward_init(&ff, &c, 1.0f, ring, bytes));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(at_rest_the_output_is_gain_times_the_deviation_from_the_reference);
    RUN_TEST(at_the_reference_nothing_is_called_for);
    RUN_TEST(a_step_is_delayed_then_shaped);
    RUN_TEST(it_begins_as_if_the_disturbance_had_always_been_at_the_reference);
    RUN_TEST(the_output_stays_within_its_own_limits);
    RUN_TEST(a_gain_of_zero_is_off);
    RUN_TEST(a_disturbance_it_fits_is_cancelled);
    RUN_TEST(bad_settings_are_refused_by_name);
    RUN_TEST(settings_at_the_ends_of_their_ranges_are_taken);
    RUN_TEST(it_begins_at_rest_at_its_reference);
    RUN_TEST(a_ring_that_is_too_small_is_refused);
    return UNITY_END();
}

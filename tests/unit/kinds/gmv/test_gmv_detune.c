/* The search for lambda: a trial on a model whose law needs a larger one, a record of the PI that says how noisy the sensor is.
 * The model is y(t+1) = 0.9 y + 0.05 u; the PI is slow. */
#include <string.h>

#include "gmv_bench.h"
#include "kinds/gmv/gmv_detune_state.h"
#include "kinds/gmv/gmv_trial_state.h"
#include "unity.h"

#define BETTER      0.05f
#define PIECES_MOST 20000u
#define W           0.5f

static struct gmv_bench b;
static struct gmv_trial trial;
static struct gmv_detune d;
static struct gmv_record record[GMV_LOOPS];
static const struct gmv_trial_pi pi[GMV_LOOPS] = {{.gain = 4, .integral = 0.4f},
                                                  {.gain = 4, .integral = 0.4f}};

void setUp(void)
{
    memset(&b, 0, sizeof b);
    memset(record, 0, sizeof record);
    b.config = gmv_plain_config(1);
    b.config.theta[0][0] = 0.9f;
    b.config.theta[0][1] = 0.05f;
}

void tearDown(void) {}

/* The PI at rest under sensor noise; its MV moves by a tenth of a percent. */
static void pi_has_acted(float noise)
{
    uint32_t lottery = 1;
    for (unsigned k = 0; k < 600; k++) {
        lottery = lottery * 1664525u + 1013904223u;
        float uniform = (float)(lottery >> 8) / 8388608.0f - 1;
        gmv_record_pi(&record[0], W, uniform * noise, 0.001f, 10);
    }
}

static const struct gmv_outcome *search(float lambda, float margin, float from, float most)
{
    unsigned pieces = 0;
    b.config.lambda[0] = lambda;
    gmv_bench_begin(&b, 0);
    gmv_detune_begin(&d, from, most, BETTER, record);
    gmv_trial_take(&trial, b.gmv, 1, margin, pi);
    while (gmv_detune_piece(&d, &trial))
        TEST_ASSERT_TRUE(pieces++ < PIECES_MOST);
    return &d.best;
}

static void a_lambda_that_is_good_as_it_is_set_stays(void)
{
    const struct gmv_outcome *best = search(0.05f, 1.25f, 1, 64);
    TEST_ASSERT_TRUE(gmv_outcome_passes(best, BETTER));
    TEST_ASSERT_EQUAL_FLOAT(1, best->times);
}

/* With lambda 0 times g it is deadbeat, and twice the gain of the plant is the end of it. */
static void a_law_that_would_not_bear_its_margin_gets_a_larger_lambda(void)
{
    TEST_ASSERT_FALSE(gmv_outcome_passes(search(0.01f, 3, 1, 1), BETTER));
    const struct gmv_outcome *best = search(0.01f, 3, 1, 64);
    TEST_ASSERT_TRUE(gmv_outcome_passes(best, BETTER));
    TEST_ASSERT_TRUE(best->times > 2);
    TEST_ASSERT_TRUE(best->decay <= GMV_SLOWEST_DECAY);
}

static void a_law_that_would_shake_the_mv_gets_a_larger_lambda(void)
{
    pi_has_acted(0.0004f);
    const struct gmv_outcome *best = search(0.01f, 1.25f, 1, 1);
    TEST_ASSERT_TRUE(best->shakes);
    best = search(0.01f, 1.25f, 1, 64);
    TEST_ASSERT_FALSE(best->shakes);
    TEST_ASSERT_TRUE(best->times > 2);
}

static void noise_counts_twice_while_a_lambda_is_looked_for(void)
{
    float noise = 0;
    bool both = true;
    for (noise = 0.0001f; both && noise < 0.01f; noise *= 1.02f) {
        setUp();
        pi_has_acted(noise);
        both = !search(0.05f, 1.25f, 1, 1)->shakes;
        if (both && search(0.05f, 1.25f, 1, 1.1f)->shakes)
            return; /* between the two limits */
    }
    TEST_FAIL_MESSAGE("there is no noise between the two limits");
}

/* From 0.001 to 0.0014 the error hardly changes. */
static void of_two_that_save_about_as_much_the_larger_lambda_is_taken(void)
{
    float least = search(0.001f, 1.25f, 1, 1)->ratio;
    const struct gmv_outcome *best = search(0.001f, 1.25f, 1, 64);
    TEST_ASSERT_TRUE(best->times > 1.2f);
    TEST_ASSERT_TRUE(best->ratio > least);
    TEST_ASSERT_TRUE(best->ratio <= 1.05f * least);
}

/* A trial that is over, with these mean squares of the PV after noise; the PI's is 0.5. Moves are 1 % of span r.m.s. */
static bool shakes_with(float noise_of_law)
{
    memset(&trial, 0, sizeof trial);
    trial.run = GMV_TRIAL_RUNS;
    trial.loops = 1;
    trial.loop[0].acts = true;
    trial.sums[0][0] = (struct gmv_trial_sums){
        .setpoint = 0.5f, .noise = noise_of_law, .moves = 1e-4f / gmv_record_noise(&record[0])};
    trial.sums[1][0] = (struct gmv_trial_sums){.setpoint = 1, .noise = 0.5f};
    gmv_detune_begin(&d, 1, 1, BETTER, record);
    TEST_ASSERT_FALSE(gmv_detune_piece(&d, &trial));
    return d.best.shakes;
}

static void moves_for_which_noise_disturbs_the_pv_less_than_under_the_pi_are_no_shaking(void)
{
    pi_has_acted(0.002f);
    TEST_ASSERT_TRUE(shakes_with(0.6f));
    TEST_ASSERT_FALSE(shakes_with(0.4f));
}

static void where_none_is_good_the_first_one_is_told(void)
{
    b.config.theta[0][1] = -0.05f; /* no lambda of this sign helps */
    const struct gmv_outcome *best = search(0.2f, 1.25f, 1, 64);
    TEST_ASSERT_FALSE(gmv_outcome_passes(best, BETTER));
    TEST_ASSERT_EQUAL_FLOAT(1, best->times);
}

static void a_law_that_acts_is_tried_with_the_lambda_it_has(void)
{
    const struct gmv_outcome *best = search(0.01f, 3, 4, 4);
    TEST_ASSERT_EQUAL_FLOAT(4, best->times);
    TEST_ASSERT_FALSE(gmv_outcome_passes(best, BETTER)); /* it is 0.01 that was tried */
}

static void no_lambda_is_beyond_the_most_that_is_allowed(void)
{
    (void)search(0.001f, 3, 1, 5);
    TEST_ASSERT_TRUE(d.times <= 5);
    TEST_ASSERT_TRUE(d.best.times <= 5);
}

/* A tick may clear the state during a piece. */
static void a_search_of_nothing_ends(void)
{
    unsigned pieces = 0;
    memset(&d, 0, sizeof d);
    memset(&trial, 0, sizeof trial);
    while (gmv_detune_piece(&d, &trial))
        TEST_ASSERT_TRUE(pieces++ < PIECES_MOST);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_lambda_that_is_good_as_it_is_set_stays);
    RUN_TEST(a_law_that_would_not_bear_its_margin_gets_a_larger_lambda);
    RUN_TEST(a_law_that_would_shake_the_mv_gets_a_larger_lambda);
    RUN_TEST(noise_counts_twice_while_a_lambda_is_looked_for);
    RUN_TEST(of_two_that_save_about_as_much_the_larger_lambda_is_taken);
    RUN_TEST(moves_for_which_noise_disturbs_the_pv_less_than_under_the_pi_are_no_shaking);
    RUN_TEST(where_none_is_good_the_first_one_is_told);
    RUN_TEST(a_law_that_acts_is_tried_with_the_lambda_it_has);
    RUN_TEST(no_lambda_is_beyond_the_most_that_is_allowed);
    RUN_TEST(a_search_of_nothing_ends);
    return UNITY_END();
}

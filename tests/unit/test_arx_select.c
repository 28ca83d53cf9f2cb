/* Orders of models, on records of which they are known. */
#include <math.h>
#include <string.h>

#include "identify/arx_select.h"
#include "kotyk_record.h"
#include "unity.h"

static struct arx_search search;

void setUp(void) {}
void tearDown(void) {}

static const struct arx_orders *best(void)
{
    return &search.trial[search.best].orders;
}

static void test_without_noise_the_orders_of_the_papers_model_are_found(void)
{
    const struct arx_data data = kotyk_record(1023, 0, 1);
    for (int criterion = ARX_BIC; criterion <= ARX_AICC; criterion++)
        for (uint8_t i = 0; i < 2; i++) {
            TEST_ASSERT_EQUAL(ERR_OK, arx_select(&data, i, 4, 5, false,
                                                 (enum arx_criterion)criterion, 0, 1023, &search));
            TEST_ASSERT_EQUAL(2, best()->na);
            for (int j = 0; j < 2; j++) {
                TEST_ASSERT_EQUAL(1, best()->first[j]);
                TEST_ASSERT_EQUAL(2, best()->last[j]);
            }
        }
}

/* y(k) = 0.7 y(k-1) + u1(k-3) - 0.5 u2(k-1) + 0.3 u2(k-2) + white e */
static struct arx_data late_record(real_t noise)
{
    const struct arx_data data = kotyk_record(1023, 0, 1);
    struct random random = random_from(9);
    for (int k = 0; k < 1023; k++) {
        kotyk_y[k][0] = noise * random_normal(&random);
        if (k >= 3)
            kotyk_y[k][0] += REAL_C(0.7) * kotyk_y[k - 1][0] + kotyk_u[k - 3][0] -
                             REAL_C(0.5) * kotyk_u[k - 1][1] + REAL_C(0.3) * kotyk_u[k - 2][1];
    }
    return data;
}

static void test_dead_time_of_one_input_is_found_under_noise(void)
{
    const struct arx_data data = late_record(REAL_C(0.2));
    TEST_ASSERT_EQUAL(ERR_OK, arx_select(&data, 0, 3, 6, false, ARX_BIC, 0, 1023, &search));
    TEST_ASSERT_EQUAL(1, best()->na);
    TEST_ASSERT_EQUAL(3, best()->first[0]);
    TEST_ASSERT_EQUAL(3, best()->last[0]);
    TEST_ASSERT_EQUAL(1, best()->first[1]);
    TEST_ASSERT_EQUAL(2, best()->last[1]);
}

static void test_an_input_without_effect_is_left_out(void)
{
    const struct arx_data data = late_record(REAL_C(0.2));
    for (int k = 0; k < 1023; k++)
        kotyk_y[k][1] = k < 1 ? 0 : REAL_C(0.8) * kotyk_y[k - 1][1] + kotyk_u[k - 1][1];
    TEST_ASSERT_EQUAL(ERR_OK, arx_select(&data, 1, 3, 3, false, ARX_BIC, 0, 1023, &search));
    TEST_ASSERT_EQUAL(0, best()->last[0]);
    TEST_ASSERT_EQUAL(1, best()->last[1]);
}

static void test_a_trial_has_the_squares_of_the_fit_of_its_orders(void)
{
    const struct arx_data data = late_record(REAL_C(0.2));
    static struct arx_work work;
    static struct arx_fit fit;
    TEST_ASSERT_EQUAL(ERR_OK, arx_select(&data, 0, 2, 4, true, ARX_BIC, 10, 900, &search));
    const struct arx_trial *t = &search.trial[search.best];
    uint32_t rows;
    fit.orders = t->orders;
    TEST_ASSERT_EQUAL(ERR_OK, arx_collect(&data, 0, &fit.orders, 10, 900, 4, &work, &rows));
    fit.rows = rows;
    TEST_ASSERT_EQUAL(ERR_OK, arx_take(&work.triangle, &fit));
    TEST_ASSERT_EQUAL_UINT32(886, search.rows);
    TEST_ASSERT_EQUAL_UINT32(886, rows);
    TEST_ASSERT_DOUBLE_WITHIN(886 * (double)REAL_EPSILON * (double)t->squares, (double)t->squares,
                              (double)fit.squares);
}

static void test_the_criteria_are_those_of_their_authors(void)
{
    const struct arx_data data = late_record(REAL_C(0.2));
    for (int criterion = ARX_BIC; criterion <= ARX_AICC; criterion++) {
        TEST_ASSERT_EQUAL(ERR_OK, arx_select(&data, 0, 1, 1, false, (enum arx_criterion)criterion,
                                             0, 100, &search));
        const struct arx_trial *t = &search.trial[0]; /* na 0, one of each input */
        double n = 99, p = 2;
        double wanted = n * log((double)t->squares / n) +
                        (criterion == ARX_BIC ? p * log(n) : 2 * p + 2 * p * (p + 1) / (n - p - 1));
        TEST_ASSERT_EQUAL(2, t->parameters);
        TEST_ASSERT_DOUBLE_WITHIN(8 * (double)REAL_EPSILON * (n * 5 + 20), wanted,
                                  (double)t->criterion);
    }
}

static void test_nothing_is_tried_twice(void)
{
    const struct arx_data data = late_record(REAL_C(0.2));
    TEST_ASSERT_EQUAL(ERR_OK, arx_select(&data, 0, 4, 8, true, ARX_AICC, 0, 1023, &search));
    TEST_ASSERT_GREATER_THAN(40, search.trials);
    for (int a = 0; a < search.trials; a++)
        for (int b = 0; b < a; b++)
            TEST_ASSERT_FALSE(
                search.trial[a].orders.na == search.trial[b].orders.na &&
                memcmp(search.trial[a].orders.first, search.trial[b].orders.first, 2) == 0 &&
                memcmp(search.trial[a].orders.last, search.trial[b].orders.last, 2) == 0);
}

static void test_inputs_at_rest_tell_no_model(void)
{
    const struct arx_data data = late_record(REAL_C(0.2));
    memset(kotyk_u, 0, sizeof kotyk_u);
    TEST_ASSERT_EQUAL(ERR_SINGULAR, arx_select(&data, 0, 0, 3, false, ARX_BIC, 0, 1023, &search));
}

static void test_sizes_that_do_not_fit_are_refused(void)
{
    const struct arx_data data = late_record(REAL_C(0.2));
    TEST_ASSERT_EQUAL(ERR_RANGE, arx_select(&data, 0, 5, 3, false, ARX_BIC, 0, 1023, &search));
    TEST_ASSERT_EQUAL(ERR_RANGE, arx_select(&data, 0, 2, 0, false, ARX_BIC, 0, 1023, &search));
    TEST_ASSERT_EQUAL(ERR_RANGE, arx_select(&data, 0, 2, 9, false, ARX_BIC, 0, 1023, &search));
    TEST_ASSERT_EQUAL(ERR_EMPTY, arx_select(&data, 0, 2, 8, false, ARX_BIC, 0, 27, &search));
}

static void test_in_pieces_every_trial_is_the_one_it_is_at_once(void)
{
    static struct arx_search pieces;
    const struct arx_data data = kotyk_record(1023, REAL_C(0.005), 4);
    for (uint8_t i = 0; i < 2; i++) {
        struct arx_searching s;
        memset(&search, 0, sizeof search);
        memset(&pieces, 0, sizeof pieces);
        TEST_ASSERT_EQUAL(ERR_OK, arx_select(&data, i, 3, 6, true, ARX_AICC, 3, 800, &search));
        arx_select_begin(&s, &data, i, 3, 6, true, ARX_AICC, 3, 800, &pieces);
        while (arx_select_piece(&s, 7))
            ;
        TEST_ASSERT_EQUAL(ERR_OK, s.err);
        TEST_ASSERT_EQUAL(search.best, pieces.best);
        TEST_ASSERT_EQUAL(search.trials, pieces.trials);
        TEST_ASSERT_EQUAL_MEMORY(search.trial, pieces.trial, sizeof search.trial);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_without_noise_the_orders_of_the_papers_model_are_found);
    RUN_TEST(test_dead_time_of_one_input_is_found_under_noise);
    RUN_TEST(test_an_input_without_effect_is_left_out);
    RUN_TEST(test_a_trial_has_the_squares_of_the_fit_of_its_orders);
    RUN_TEST(test_the_criteria_are_those_of_their_authors);
    RUN_TEST(test_nothing_is_tried_twice);
    RUN_TEST(test_inputs_at_rest_tell_no_model);
    RUN_TEST(test_sizes_that_do_not_fit_are_refused);
    RUN_TEST(test_in_pieces_every_trial_is_the_one_it_is_at_once);
    return UNITY_END();
}

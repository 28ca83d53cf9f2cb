/* The recursive form of identify/arx.h: its regressor with identify/rls.h, as a block has it. */
#include <stdalign.h>

#include "identify/rls.h"
#include "kotyk_record.h"
#include "unity.h"

static struct arx_work work;
static struct arx_fit fit;
static const struct arx_orders two = {.na = 2, .first = {1, 1}, .last = {2, 2}};

void setUp(void) {}
void tearDown(void) {}

static void test_the_recursive_form_with_the_same_regressor_ends_at_the_same_parameters(void)
{
    const struct arx_data data = kotyk_record(1023, REAL_C(0.02), 5);
    static alignas(8) char memory[2048];
    struct rls *rls = (struct rls *)(void *)memory;
    float p0[6] = {1e6f, 1e6f, 1e6f, 1e6f, 1e6f, 1e6f};
    const struct rls_settings settings = {
        .n = 6, .forget = 1, .forget_least = 1, .sigma0 = 1, .memory = 1, .trace = 1, .p0 = p0};
    num_t none[6] = {num_zero(), num_zero(), num_zero(), num_zero(), num_zero(), num_zero()};
    struct arx_history h = {0};
    TEST_ASSERT_TRUE(rls_bytes(6) <= sizeof memory);
    TEST_ASSERT_EQUAL(ERR_OK, rls_check(&settings, NULL, NULL));
    rls_init(rls, &settings, none);
    for (size_t k = 0; k < 1023; k++) {
        real_t phi[6];
        num_t of_num[6];
        arx_regressor(&two, 2, &h, phi);
        for (int i = 0; i < 6; i++)
            of_num[i] = num_from_float((float)phi[i]);
        (void)rls_step(rls, of_num, num_from_float((float)kotyk_y[k][0]), k >= 2);
        arx_push(&h, 2, kotyk_y[k][0], kotyk_u[k], 0);
    }
    TEST_ASSERT_EQUAL(ERR_OK, arx_fit(&data, 0, &two, ARX_LS, 0, 1023, &work, &fit));
    for (unsigned i = 0; i < 6; i++) /* bound of test_rls_cases.c, and P(0) */
        TEST_ASSERT_DOUBLE_WITHIN(5e-5, (double)fit.theta[i],
                                  (double)num_to_float(rls_theta(rls, i)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_recursive_form_with_the_same_regressor_ends_at_the_same_parameters);
    return UNITY_END();
}

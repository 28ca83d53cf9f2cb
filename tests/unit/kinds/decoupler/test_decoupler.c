/* Static decoupler: u = D v over the loops that act, and its back-calculation.
 *
 * Accuracy (against products in double): forward and back within 1e-6 (float) and 1.5e-6 (fixed) of the exact
 * product for matrices with entries and inverses up to 10; there and back within 1e-5. */
#include <stdlib.h>

#include "formats.h"
#include "kinds/decoupler/decoupler.h"
#include "random_source.h"
#include "unity.h"

#define PRODUCT BY_FORMAT(1e-5, 1.5e-6)
#define ROUND   BY_FORMAT(2e-5, 1e-4)

static float matrix[DECOUPLER_MAX][DECOUPLER_MAX];
static struct decoupler decoupler;

void setUp(void)
{
    for (unsigned i = 0; i < DECOUPLER_MAX; i++)
        for (unsigned j = 0; j < DECOUPLER_MAX; j++)
            matrix[i][j] = i == j ? 1.0f : 0.0f;
}
void tearDown(void) {}

static void select_loops(uint8_t mask)
{
    TEST_ASSERT_EQUAL(ERR_OK, decoupler_select(&decoupler, matrix, mask));
}

static void a_selection_multiplies_by_its_own_rows_and_columns_only(void)
{
    num_t v[8], u[8];
    matrix[0][1] = 0.5f;
    matrix[1][0] = -0.25f;
    matrix[0][2] = 9.0f; /* loop 3 does not take part */
    for (unsigned i = 0; i < 8; i++)
        v[i] = N(0.1 * (i + 1)), u[i] = N(7);
    select_loops(0x03);
    decoupler_forward(&decoupler, v, u);
    TEST_ASSERT_DOUBLE_WITHIN(PRODUCT, 0.1 + 0.5 * 0.2, D(u[0]));
    TEST_ASSERT_DOUBLE_WITHIN(PRODUCT, 0.2 - 0.25 * 0.1, D(u[1]));
    for (unsigned i = 2; i < 8; i++)
        TEST_ASSERT_DOUBLE_WITHIN(0, 7, D(u[i]));
}

static void loops_that_are_not_neighbours_can_be_selected(void)
{
    num_t v[8] = {0}, u[8] = {0};
    matrix[1][6] = 0.75f;
    select_loops(0x42);
    v[1] = N(0.2);
    v[6] = N(0.4);
    decoupler_forward(&decoupler, v, u);
    TEST_ASSERT_DOUBLE_WITHIN(PRODUCT, 0.2 + 0.75 * 0.4, D(u[1]));
    TEST_ASSERT_DOUBLE_WITHIN(PRODUCT, 0.4, D(u[6]));
}

static void the_way_back_undoes_the_way_forward_for_every_selection(void)
{
    struct random_source r = {20260101};
    for (unsigned trial = 0; trial < 300; trial++) {
        uint8_t mask = (uint8_t)(1u + random_below(&r, 255));
        for (unsigned i = 0; i < 8; i++)
            for (unsigned j = 0; j < 8; j++)
                matrix[i][j] = i == j ? 1.0f : (float)random_below(&r, 2000) / 1e4f - 0.1f;
        num_t v[8], u[8] = {0}, back[8] = {0};
        for (unsigned i = 0; i < 8; i++)
            v[i] = N((double)random_below(&r, 1000) / 1000);
        select_loops(mask);
        decoupler_forward(&decoupler, v, u);
        decoupler_back(&decoupler, u, back);
        for (unsigned i = 0; i < 8; i++)
            if (mask & (1u << i))
                TEST_ASSERT_DOUBLE_WITHIN(ROUND, D(v[i]), D(back[i]));
    }
}

static void no_difference_goes_back_as_exactly_no_difference(void)
{
    num_t du[8] = {0}, dv[8];
    matrix[0][1] = 1.0f / 3.0f;
    matrix[1][0] = 0.7f;
    select_loops(0x03);
    decoupler_back(&decoupler, du, dv);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, D(dv[0]));
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, D(dv[1]));
}

static void a_limited_loop_gives_way_to_where_its_output_stands_and_the_others_stay(void)
{
    num_t du[8] = {0}, dv[8];
    matrix[0][1] = 0.5f;
    matrix[1][0] = -0.25f;
    matrix[2][0] = 0.5f;
    matrix[0][0] = 2.0f;
    select_loops(0x07);
    du[0] = N(-0.1);
    decoupler_give_way(&decoupler, du, dv);
    TEST_ASSERT_DOUBLE_WITHIN(PRODUCT, -0.05, D(dv[0]));
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, D(dv[1]));
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, D(dv[2]));
}

static void limited_loops_give_way_together_for_every_selection(void)
{
    struct random_source r = {20261126};
    for (unsigned trial = 0; trial < 300; trial++) {
        uint8_t limited = (uint8_t)(1u + random_below(&r, 255));
        for (unsigned i = 0; i < 8; i++)
            for (unsigned j = 0; j < 8; j++)
                matrix[i][j] = i == j ? 1.0f : (float)random_below(&r, 2000) / 1e4f - 0.1f;
        num_t du[8] = {0}, dv[8], back[8];
        for (unsigned i = 0; i < 8; i++)
            if (limited & (1u << i))
                du[i] = N((double)(1 + random_below(&r, 1000)) / 1000);
        select_loops(0xFF);
        decoupler_give_way(&decoupler, du, dv);
        decoupler_forward(&decoupler, dv, back);
        for (unsigned i = 0; i < 8; i++)
            TEST_ASSERT_DOUBLE_WITHIN(ROUND, D(limited & (1u << i) ? du[i] : dv[i]),
                                      D(limited & (1u << i) ? back[i] : num_zero()));
    }
}

static void a_matrix_without_an_inverse_is_refused_and_nothing_changes(void)
{
    select_loops(0x01);
    struct decoupler before = decoupler;
    matrix[0][1] = matrix[1][0] = 1.0f;
    TEST_ASSERT_EQUAL(ERR_SINGULAR, decoupler_select(&decoupler, matrix, 0x03));
    TEST_ASSERT_EQUAL_MEMORY(&before, &decoupler, sizeof before);
}

static void a_nearly_singular_matrix_with_a_huge_inverse_is_refused(void)
{
    matrix[0][1] = 1.0f;
    matrix[1][0] = 0.995f; /* inverse has entries of 200 */
    TEST_ASSERT_EQUAL(ERR_SINGULAR, decoupler_select(&decoupler, matrix, 0x03));
}

static void a_zero_on_the_diagonal_is_no_obstacle_while_the_whole_has_an_inverse(void)
{
    num_t v[8] = {N(0.25), N(0.5)}, u[8] = {0};
    matrix[0][0] = matrix[1][1] = 0.0f;
    matrix[0][1] = matrix[1][0] = 1.0f;
    select_loops(0x03);
    decoupler_forward(&decoupler, v, u);
    TEST_ASSERT_DOUBLE_WITHIN(PRODUCT, 0.5, D(u[0]));
    TEST_ASSERT_DOUBLE_WITHIN(PRODUCT, 0.25, D(u[1]));
}

static enum err check(uint8_t there, uint8_t *worst)
{
    const struct matrix_settings settings = {matrix};
    struct block_setup setup = {.settings = &settings, .members = DECOUPLER_MAX, .present = there};
    for (uint8_t i = 0; i < DECOUPLER_MAX; i++)
        setup.member[i] = (struct block_member){.loop = i, .out_reach = 1.0f};
    return decoupler_check(&setup, worst);
}

static void the_check_finds_a_part_that_is_singular_although_the_whole_is_not(void)
{
    uint8_t worst = 0;
    matrix[0][0] = matrix[1][1] = 0.0f;
    matrix[0][1] = matrix[1][0] = 1.0f;
    TEST_ASSERT_EQUAL(ERR_SINGULAR, check(0x03, &worst));
    TEST_ASSERT_EQUAL_HEX8(0x01, worst); /* loop 1 alone has nothing to act with */
}

static void the_check_passes_a_diagonally_dominant_matrix_of_full_size(void)
{
    uint8_t worst = 0;
    for (unsigned i = 0; i < 8; i++)
        for (unsigned j = 0; j < 8; j++)
            matrix[i][j] = i == j ? 1.0f : -0.1f;
    TEST_ASSERT_EQUAL(ERR_OK, check(0xFF, &worst));
}

static void nobody_selected_is_a_decoupler_that_does_nothing(void)
{
    num_t v[8] = {0}, u[8] = {N(0.3)};
    select_loops(0);
    decoupler_forward(&decoupler, v, u);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.3, D(u[0]));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_selection_multiplies_by_its_own_rows_and_columns_only);
    RUN_TEST(loops_that_are_not_neighbours_can_be_selected);
    RUN_TEST(the_way_back_undoes_the_way_forward_for_every_selection);
    RUN_TEST(no_difference_goes_back_as_exactly_no_difference);
    RUN_TEST(a_limited_loop_gives_way_to_where_its_output_stands_and_the_others_stay);
    RUN_TEST(limited_loops_give_way_together_for_every_selection);
    RUN_TEST(a_matrix_without_an_inverse_is_refused_and_nothing_changes);
    RUN_TEST(a_nearly_singular_matrix_with_a_huge_inverse_is_refused);
    RUN_TEST(a_zero_on_the_diagonal_is_no_obstacle_while_the_whole_has_an_inverse);
    RUN_TEST(the_check_finds_a_part_that_is_singular_although_the_whole_is_not);
    RUN_TEST(the_check_passes_a_diagonally_dominant_matrix_of_full_size);
    RUN_TEST(nobody_selected_is_a_decoupler_that_does_nothing);
    return UNITY_END();
}

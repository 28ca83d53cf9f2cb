/* design/polynomial_decoupler.[ch]; built in float and in double. eps is REAL_EPSILON.
 *
 * Contract
 *   B G            200 random models of each size: off the diagonal 0, on it h, to 64 eps of the largest sum of its terms'
 *                  magnitudes; 64 times that of three and four loops, where minors are sums of which most may cancel
 *   G              1 at rest on the diagonal, to 32 eps of the sum of its magnitudes; no delay that a whole column shares
 *   Kotyk          G from the printed numbers; zeros 0.3085 and -3.6e-5 to the digits given
 *   refusals       each with its reason: not square, singular, singular at rest, zero outside, elements, config, no number
 */
#include <math.h>
#include <string.h>

#include "design/polynomial_decoupler.h"
#include "kotyk_model.h"
#include "random_matrix.h"
#include "unity.h"

#define EPS ((double)REAL_EPSILON)

static struct difference_model model;
static struct polynomial_decoupler_config config;
static struct polynomial_decoupler_work work;
static struct polynomial_decoupler d;
static struct polynomial_decoupler_refusal why;

void setUp(void)
{
    model = kotyk_column();
    polynomial_decoupler_config_default(&config);
}
void tearDown(void) {}

static enum err design_saying(struct polynomial_decoupler_refusal *reason)
{
    enum err err = polynomial_decoupler_check(&model, &config, reason);
    return err ? err : polynomial_decoupler_design(&model, &config, &work, &d, reason);
}

static enum err design(void)
{
    return design_saying(&why);
}

static double coefficient(const struct polynomial *p, unsigned k)
{
    return k < p->n ? (double)p->value[k] : 0.0;
}

/* Coefficient k of element i, j of B G, and of the sum of its terms' magnitudes. */
static double of_product(unsigned i, unsigned j, unsigned k, double *size)
{
    double sum = 0;
    *size = 0;
    for (unsigned l = 0; l < model.inputs; l++)
        for (unsigned a = 0; a < model.nb && a + 1 <= k; a++) {
            double term = (double)model.b[i][l][a] * coefficient(&d.g.value[l][j], k - 1 - a);
            sum += term;
            *size += fabs(term);
        }
    return sum;
}

static void assert_diagonal(void)
{
    for (unsigned i = 0; i < model.outputs; i++)
        for (unsigned j = 0; j < model.outputs; j++) {
            double most = 0, size;
            for (unsigned k = 0; k < POLYNOMIAL_MOST; k++) {
                (void)of_product(i, j, k, &size);
                most = fmax(most, size);
            }
            double bound = 64 * EPS * most * (model.outputs > 2 ? 64 : 1);
            for (unsigned k = 0; k < POLYNOMIAL_MOST; k++) {
                double wanted = i == j ? coefficient(&d.h[i], k) : 0;
                TEST_ASSERT_DOUBLE_WITHIN(bound, wanted, of_product(i, j, k, &size));
            }
        }
}

static void draw_model(struct random_source *r, unsigned n)
{
    model.outputs = model.inputs = (uint8_t)n;
    model.na = 0;
    model.nb = (uint8_t)(1 + random_below(r, 8));
    for (unsigned i = 0; i < n; i++)
        for (unsigned j = 0; j < n; j++) {
            unsigned dead = random_below(r, 3);
            for (unsigned k = 0; k < model.nb; k++)
                model.b[i][j][k] = (real_t)(k < dead ? 0 : random_fraction(r) + (i == j ? 2 : 0));
        }
}

static void the_column_of_the_paper_is_decoupled(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, design());
    assert_diagonal();
    /* Eq. 6, columns divided by their diagonal elements at rest. */
    static const double adj[2][2][2] = {{{-0.01990, 0.00157}, {0.01062, 0.00192}},
                                        {{-0.01262, -0.00316}, {0.03851, -0.00386}}};
    static const double rest[2] = {-0.01990 + 0.00157, 0.03851 - 0.00386};
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++)
            for (unsigned k = 0; k < 2; k++)
                TEST_ASSERT_DOUBLE_WITHIN(16 * EPS, adj[i][j][k] / rest[j],
                                          (double)d.g.value[i][j].value[k]);
}

static void the_zeros_of_the_papers_determinant_are_reported(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_decoupler_zeros(&d));
    TEST_ASSERT_EQUAL_UINT8(2, d.zeros.n);
    double far = fmax((double)d.zeros.value[0].re, (double)d.zeros.value[1].re);
    double near = fmin((double)d.zeros.value[0].re, (double)d.zeros.value[1].re);
    TEST_ASSERT_DOUBLE_WITHIN(5e-5, 0.3085, far);
    TEST_ASSERT_DOUBLE_WITHIN(5e-7, -3.6e-5, near);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.3085, (double)d.outermost);
    TEST_ASSERT_EQUAL_UINT8(2, d.delay);
    TEST_ASSERT_TRUE(d.recursive);
}

static void models_of_every_size_are_decoupled(void)
{
    struct random_source r = {17};
    config.zero_hi = (real_t)1e6;
    config.element_hi = (real_t)127;
    for (unsigned n = 1; n <= 4; n++) {
        unsigned made = 0;
        for (unsigned draw = 0; draw < 200; draw++) {
            draw_model(&r, n);
            enum err err = design();
            if (err == ERR_SINGULAR)
                continue;
            TEST_ASSERT_EQUAL(ERR_OK, err);
            assert_diagonal();
            made++;
            for (unsigned k = 0; k < n; k++) {
                unsigned least = POLYNOMIAL_MOST;
                for (unsigned i = 0; i < n; i++)
                    if (d.g.value[i][k].n && polynomial_delay(&d.g.value[i][k]) < least)
                        least = polynomial_delay(&d.g.value[i][k]);
                TEST_ASSERT_EQUAL_UINT(0, least);
                double rest = 0;
                for (unsigned l = 0; l < d.g.value[k][k].n; l++)
                    rest += (double)d.g.value[k][k].value[l];
                TEST_ASSERT_DOUBLE_WITHIN(32 * EPS * (double)polynomial_size(&d.g.value[k][k]), 1,
                                          rest);
            }
        }
        TEST_ASSERT_TRUE(made >= 50);
    }
}

static void other_units_of_an_output_change_neither_decoupler_nor_zeros(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_decoupler_zeros(&d));
    struct polynomial_decoupler before = d;
    for (unsigned j = 0; j < 2; j++)
        for (unsigned k = 0; k < 2; k++)
            model.b[0][j][k] *= (real_t)16384;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_decoupler_zeros(&d));
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++)
            TEST_ASSERT_EQUAL_MEMORY(before.g.value[i][j].value, d.g.value[i][j].value,
                                     2 * sizeof(real_t));
    TEST_ASSERT_TRUE(before.outermost == d.outermost);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * fabs((double)d.h[0].value[1]),
                              16384 * (double)before.h[0].value[1], (double)d.h[0].value[1]);
    TEST_ASSERT_TRUE(before.h[1].value[1] == d.h[1].value[1]);
}

static void a_dead_time_of_a_whole_row_stays_in_its_loop_and_in_no_other(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, design());
    struct polynomial_decoupler before = d;
    model.nb = 5;
    for (unsigned j = 0; j < 2; j++) {
        memmove(&model.b[0][j][3], &model.b[0][j][0], 2 * sizeof(real_t));
        memset(&model.b[0][j][0], 0, 3 * sizeof(real_t));
    }
    TEST_ASSERT_EQUAL(ERR_OK, design());
    assert_diagonal();
    TEST_ASSERT_EQUAL_UINT(4, polynomial_delay(&d.h[0]));
    TEST_ASSERT_EQUAL_UINT(1, polynomial_delay(&d.h[1]));
    TEST_ASSERT_EQUAL_UINT8(before.delay + 3, d.delay);
    TEST_ASSERT_TRUE(d.recursive);
}

static void where_dead_times_stand_crosswise_no_first_coefficients_have_an_inverse(void)
{
    model.nb = 3; /* the diagonal is one sample later than the rest of its rows */
    model.b[0][0][2] = model.b[0][0][0];
    model.b[0][0][0] = model.b[0][0][1] = (real_t)0;
    model.b[1][1][2] = model.b[1][1][0];
    model.b[1][1][0] = model.b[1][1][1] = (real_t)0;
    model.b[0][1][1] = model.b[1][0][1] = (real_t)0;
    model.b[0][1][0] = (real_t)-0.001;
    model.b[1][0][0] = (real_t)0;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    assert_diagonal();
    TEST_ASSERT_FALSE(d.recursive);
}

/* ---- refusals ---- */

static void assert_refused(enum err err, const char *field)
{
    TEST_ASSERT_EQUAL(err, design());
    TEST_ASSERT_EQUAL_STRING(field, why.field);
    TEST_ASSERT_TRUE(strlen(why.wanted) > 0);
    TEST_ASSERT_EQUAL(err, design_saying(NULL));
}

static void one_that_is_not_square_is_refused(void)
{
    model.inputs = 1;
    assert_refused(ERR_RANGE, "outputs");
}

static void one_whose_inputs_do_the_same_is_refused(void)
{
    for (unsigned i = 0; i < 2; i++)
        for (unsigned k = 0; k < 2; k++)
            model.b[i][1][k] = model.b[i][0][k] * (real_t)-0.7;
    assert_refused(ERR_SINGULAR, "determinant");
}

static void one_whose_inputs_do_nearly_the_same_at_rest_is_refused(void)
{
    model.b[1][1][0] = (real_t)-0.0072;
    assert_refused(ERR_SINGULAR, "determinant");
}

static void a_zero_outside_is_refused_and_told_and_may_be_allowed(void)
{
    model.b[0][0][1] = (real_t)-0.06; /* B11 has one at 1.56 */
    assert_refused(ERR_RANGE, "zero");
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_decoupler_zeros(&d));
    TEST_ASSERT_TRUE((double)d.outermost > 1);
    TEST_ASSERT_EQUAL_UINT8(2, d.zeros.n);
    config.zero_hi = (real_t)10;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    assert_diagonal();
    TEST_ASSERT_FALSE(d.recursive);
}

static void an_element_out_of_range_is_refused_with_its_place(void)
{
    model.b[1][0][0] = (real_t)3;
    assert_refused(ERR_SINGULAR, "element");
    TEST_ASSERT_EQUAL_UINT8(1, why.output);
    TEST_ASSERT_EQUAL_UINT8(0, why.input);
}

static void a_config_out_of_range_is_refused(void)
{
    config.element_hi = (real_t)0.5;
    assert_refused(ERR_RANGE, "element_hi");
    polynomial_decoupler_config_default(&config);
    config.determinant_lo = (real_t)NAN;
    assert_refused(ERR_RANGE, "determinant_lo");
    polynomial_decoupler_config_default(&config);
    config.zero_hi = (real_t)0;
    assert_refused(ERR_RANGE, "zero_hi");
    polynomial_decoupler_config_default(&config);
    config.recursion_hi = (real_t)1;
    assert_refused(ERR_RANGE, "recursion_hi");
}

static void a_model_that_is_none_is_refused(void)
{
    model.b[1][0][1] = (real_t)NAN;
    assert_refused(ERR_NOT_FINITE, "b");
    model = kotyk_column();
    model.nb = 0;
    assert_refused(ERR_RANGE, "nb");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_column_of_the_paper_is_decoupled);
    RUN_TEST(the_zeros_of_the_papers_determinant_are_reported);
    RUN_TEST(models_of_every_size_are_decoupled);
    RUN_TEST(other_units_of_an_output_change_neither_decoupler_nor_zeros);
    RUN_TEST(a_dead_time_of_a_whole_row_stays_in_its_loop_and_in_no_other);
    RUN_TEST(where_dead_times_stand_crosswise_no_first_coefficients_have_an_inverse);
    RUN_TEST(one_that_is_not_square_is_refused);
    RUN_TEST(one_whose_inputs_do_the_same_is_refused);
    RUN_TEST(one_whose_inputs_do_nearly_the_same_at_rest_is_refused);
    RUN_TEST(a_zero_outside_is_refused_and_told_and_may_be_allowed);
    RUN_TEST(an_element_out_of_range_is_refused_with_its_place);
    RUN_TEST(a_config_out_of_range_is_refused);
    RUN_TEST(a_model_that_is_none_is_refused);
    return UNITY_END();
}

/* Whatever a design of design/ refuses, it gives the field and what would be right. The reason holds a mark before each call; a design
 * that returns an error and leaves the mark has not said why. Models are drawn with coefficients from 1e-30 to 1e30, because
 * overflow and underflow lead to the errors that are rarest. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "design/detune.h"
#include "design/pole_placement.h"
#include "design/polynomial_decoupler.h"
#include "interact_plants.h"
#include "random_source.h"
#include "state_design.h"
#include "unity.h"

#define SEED  32u
#define DRAWN 4000u

static const char mark[] = "mark";
static struct random_source from;
static unsigned refused;

void setUp(void)
{
    from = (struct random_source){SEED};
    refused = 0;
}
void tearDown(void) {}

static double fraction(void)
{
    return (double)(random_next(&from) >> 40) / 8388608.0 - 1.0;
}

/* Draws a number of either sign, sometimes 0, sometimes of extreme size. */
static real_t coefficient(double decades)
{
    unsigned kind = random_below(&from, 8);
    double x = fraction();
    return (real_t)(kind == 0 ? 0.0 : kind == 1 ? x * pow(10.0, decades * fraction()) : x);
}

static void assert_says_why(enum err err, const char *field, const char *wanted, unsigned drawn)
{
    if (!err)
        return;
    char text[64];
    (void)snprintf(text, sizeof text, "seed %u, case %u: error %d", SEED, drawn, (int)err);
    refused++;
    TEST_ASSERT_TRUE_MESSAGE(field != mark && wanted != mark, text);
    TEST_ASSERT_TRUE_MESSAGE(field && field[0] && wanted && wanted[0], text);
}

static void draw_matrix(struct matrix *a, unsigned rows, unsigned cols)
{
    set_size(a, rows, cols);
    for (unsigned i = 0; i < rows; i++)
        for (unsigned j = 0; j < cols; j++)
            a->value[i][j] = coefficient(30.0);
}

static void test_a_refused_state_decoupler_says_why(void)
{
    for (unsigned drawn = 0; drawn < DRAWN; drawn++) {
        unsigned n = 1 + random_below(&from, 4), loops = 1 + random_below(&from, n);
        memset(&model, 0, sizeof model);
        draw_matrix(&model.a, n, n);
        draw_matrix(&model.b, n, loops);
        draw_matrix(&model.c, loops, n);
        set_size(&model.e, n, 0);
        model.period_s = (real_t)(drawn % 2 ? pow(10.0, 6.0 * fraction()) : 0.0);
        state_decoupler_config_default(&config);
        memset(&goal, 0, sizeof goal);
        for (unsigned i = 0; i < loops; i++) {
            goal.integral_s[i] = (real_t)(drawn % 3 ? pow(10.0, 6.0 * fraction()) : 0.0);
            for (unsigned p = 0; p < STATE_POLES; p++)
                goal.pole[i][p].re = (real_t)(drawn % 2 ? 0.5 : -1.0);
        }
        goal.hold_s = (real_t)(drawn % 5 ? 0.0 : 1.0);
        why = (struct state_decoupler_refusal){mark, mark, 0};
        enum err err = design();
        assert_says_why(err, why.field, why.wanted, drawn);
    }
    TEST_ASSERT_GREATER_THAN_UINT(100, refused);
}

/* Each part by itself, because a block takes up the design between ticks with a reason of its own. */
static void test_each_part_of_a_refused_state_decoupler_says_why(void)
{
    set_size(&model.a, 1, 1);
    set_size(&model.b, 1, 1);
    set_size(&model.c, 1, 1);
    set_size(&model.e, 1, 0);
    model.a.value[0][0] = (real_t)0.5;
    model.b.value[0][0] = model.c.value[0][0] = (real_t)1;
    model.period_s = (real_t)1;
    state_decoupler_config_default(&config);
    memset(&goal, 0, sizeof goal);
    goal.pole[0][0].re = (real_t)0.5;
    state_decoupler_begin(&work);
    enum err err = ERR_BUSY;
    for (unsigned part = 0; part < 2; part++) {
        err = state_decoupler_part(&model, &config, &goal, &work, &d, &why);
        TEST_ASSERT_EQUAL(ERR_BUSY, err);
    }
    d.g.value[0][0] = (real_t)NAN; /* the loop's modes cannot be found */
    why = (struct state_decoupler_refusal){mark, mark, 0};
    err = state_decoupler_part(&model, &config, &goal, &work, &d, &why);
    TEST_ASSERT_NOT_EQUAL(ERR_OK, err);
    assert_says_why(err, why.field, why.wanted, 0);
    TEST_ASSERT_EQUAL_UINT8(STATE_LOOP_NONE, why.loop);
}

static void test_a_refused_pole_placement_says_why(void)
{
    static struct pole_placement_work room;
    static struct pole_placement result;
    for (unsigned drawn = 0; drawn < DRAWN; drawn++) {
        struct pole_placement_goal wanted;
        pole_placement_goal_default(&wanted);
        wanted.settling_s = (real_t)(2.0 + 100.0 * fabs(fraction()));
        wanted.overshoot = (real_t)(drawn % 3 ? 0.1 : 0.0);
        real_t a[POLYNOMIAL_MOST] = {(real_t)1}, b[POLYNOMIAL_MOST] = {(real_t)0};
        unsigned na = 1 + random_below(&from, 9), nb = 2 + random_below(&from, 9);
        for (unsigned k = 1; k < na; k++)
            a[k] = coefficient(30.0);
        for (unsigned k = 1; k < nb; k++)
            b[k] = coefficient(30.0);
        struct polynomial den, num;
        polynomial_set(&den, a, na);
        polynomial_set(&num, b, nb);
        struct pole_placement_refusal reason = {mark, mark};
        enum err err =
            pole_placement_design(&den, &num, (real_t)1, &wanted, &room, &result, &reason);
        assert_says_why(err, reason.field, reason.wanted, drawn);
    }
    TEST_ASSERT_GREATER_THAN_UINT(100, refused);
}

static void test_a_refused_polynomial_decoupler_says_why(void)
{
    static struct polynomial_decoupler_work room;
    static struct polynomial_decoupler result;
    for (unsigned drawn = 0; drawn < DRAWN; drawn++) {
        struct polynomial_decoupler_config c;
        polynomial_decoupler_config_default(&c);
        unsigned n = 1 + random_below(&from, DIFFERENCE_MOST);
        struct difference_model m = {
            .outputs = (uint8_t)n, .inputs = (uint8_t)n, .period_s = (real_t)1};
        m.na = (uint8_t)random_below(&from, DIFFERENCE_A_MOST + 1);
        m.nb = (uint8_t)(1 + random_below(&from, DIFFERENCE_B_MOST));
        for (unsigned i = 0; i < n; i++) {
            for (unsigned k = 0; k < m.na; k++)
                m.a[i][k] = coefficient(2.0);
            for (unsigned j = 0; j < n; j++)
                for (unsigned k = 0; k < m.nb; k++)
                    m.b[i][j][k] = coefficient(30.0);
        }
        struct polynomial_decoupler_refusal reason = {mark, mark, 0, 0};
        enum err err = polynomial_decoupler_check(&m, &c, &reason);
        err = err ? err : polynomial_decoupler_design(&m, &c, &room, &result, &reason);
        assert_says_why(err, reason.field, reason.wanted, drawn);
    }
    TEST_ASSERT_GREATER_THAN_UINT(100, refused);
}

static void test_a_refused_detuning_says_why(void)
{
    static struct detune search;
    for (unsigned drawn = 0; drawn < DRAWN; drawn++) {
        struct detune_config c;
        detune_config_default(&c);
        static struct interact_plant plant;
        memset(&plant, 0, sizeof plant);
        plant.outputs = plant.inputs = 2;
        for (unsigned i = 0; i < 2; i++)
            for (unsigned j = 0; j < 2; j++) {
                plant.element[i][j].gain = coefficient(9.0);
                plant.element[i][j].dead_time_s = (real_t)fabs((double)coefficient(6.0));
                plant.element[i][j].time_constant_s = (real_t)fabs((double)coefficient(6.0));
            }
        struct pairs pairs = {.n = 2, .output = {0, 1}, .input = {0, 1}};
        struct interact_refusal reason = {mark, mark, 0, 0};
        enum err err = detune_begin(&search, &plant, &pairs, (real_t)1, NULL, &c, &reason);
        assert_says_why(err == ERR_BUSY ? ERR_OK : err, reason.field, reason.wanted, drawn);
    }
    TEST_ASSERT_GREATER_THAN_UINT(100, refused);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_refused_state_decoupler_says_why);
    RUN_TEST(test_each_part_of_a_refused_state_decoupler_says_why);
    RUN_TEST(test_a_refused_pole_placement_says_why);
    RUN_TEST(test_a_refused_polynomial_decoupler_says_why);
    RUN_TEST(test_a_refused_detuning_says_why);
    return UNITY_END();
}

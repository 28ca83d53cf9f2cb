/* The compensator `polynomial` (kinds/polynomial/polynomial.h). Contract, for outputs of up to two spans and the decoupler of Kotyk's column:
 * MVs to 4e-6 of a span of the sum in double, in both formats: a coefficient and an input are rounded once each to 2^-24 of 1, elements
 * of G add up to 7, and the sum is rounded once. */
#include <math.h>
#include <stdalign.h>
#include <string.h>

#include "formats.h"
#include "kinds/polynomial/polynomial.h"
#include "unity.h"

#define EXACT 4e-6
#define MOST  4

static alignas(8) char state[2048];
static struct polynomial_settings settings;
static struct block_setup setup;
static struct block_fault fault;
static num_t in[MOST], out[MOST];
static struct block_io io;

/* Kotyk and Machacek (1995), Eq. 6, columns divided by their diagonal elements at rest. */
static const double adj[2][2][2] = {{{-0.01990, 0.00157}, {0.01062, 0.00192}},
                                    {{-0.01262, -0.00316}, {0.03851, -0.00386}}};
static double g_of(unsigned i, unsigned j, unsigned k)
{
    return k < 2 ? adj[i][j][k] / (adj[j][j][0] + adj[j][j][1]) : 0;
}

static void take_kotyk(void)
{
    memset(settings.g, 0, sizeof settings.g);
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++)
            for (unsigned k = 0; k < 2; k++)
                settings.g[2 * i + j][k] = (float)g_of(i, j, k);
}

void setUp(void)
{
    settings = (struct polynomial_settings){.period_s = 0};
    memset(&setup, 0, sizeof setup);
    setup.settings = &settings;
    setup.interval_s = 120;
    setup.members = 2;
    setup.present = 3;
    for (unsigned k = 0; k < MOST; k++)
        setup.member[k].out_reach = 2;
    take_kotyk();
    io = (struct block_io){.members.acting = 3, .members.in = in, .members.out = out};
}
void tearDown(void) {}

static void put_in(double first, double second)
{
    in[0] = N(first);
    in[1] = N(second);
}

static void configure(bool retune)
{
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_kind.check(&setup, &fault));
    TEST_ASSERT_TRUE(polynomial_kind.bytes(&setup) <= sizeof state);
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_kind.configure(state, &setup, retune));
}

/* At rest where the MVs are as given. */
static void begin_at(double first, double second)
{
    configure(false);
    io.members.going_on = 0;
    put_in(first, second);
    polynomial_kind.follow(state, &io);
}

static void stepped(double first, double second)
{
    put_in(first, second);
    polynomial_kind.step(state, &io);
}

static void told(double first, double second)
{
    put_in(first, second);
    polynomial_kind.back_calculate(state, &io);
}

static void assert_out(double first, double second)
{
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, first, D(out[0]));
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, second, D(out[1]));
}

/* What G makes of v now and v one sample before. */
static double made_of(unsigned i, const double now[2], const double before[2])
{
    double sum = 0;
    for (unsigned j = 0; j < 2; j++)
        sum += g_of(i, j, 0) * now[j] + g_of(i, j, 1) * before[j];
    return sum;
}

/* ---- forwards ---- */

static void mvs_are_g_times_what_the_controllers_ask_for_now_and_before(void)
{
    static const double v[][2] = {{0.1, 0.2}, {0.15, 0.2}, {0.15, -0.3}, {1, 0.7}, {1, 0.7}};
    begin_at(0, 0);
    double before[2] = {0, 0};
    for (unsigned t = 0; t < 5; t++) {
        stepped(v[t][0], v[t][1]);
        assert_out(made_of(0, v[t], before), made_of(1, v[t], before));
        told(0, 0);
        assert_out(0, 0);
        memcpy(before, v[t], sizeof before);
    }
}

static void four_loops_and_eight_coefficients_are_added_up(void)
{
    double h[8][4] = {{0}};
    setup.members = 4;
    setup.present = 15;
    io.members.acting = 15;
    settings.limits = POLYNOMIAL_SCALE;
    for (unsigned row = 0; row < 16; row++)
        for (unsigned k = 0; k < 8; k++)
            settings.g[row][k] = (row % 5 ? 0.01f : 0.3f) * (float)(1 + (row * 7 + k * 3) % 11) / 8;
    configure(false);
    memset(in, 0, sizeof in);
    polynomial_kind.follow(state, &io);
    for (unsigned t = 0; t < 20; t++) {
        memmove(h[1], h[0], sizeof h - sizeof h[0]);
        for (unsigned j = 0; j < 4; j++)
            in[j] = N(h[0][j] = (double)((t * 5 + j * 3) % 16) / 16 - 0.3);
        polynomial_kind.step(state, &io);
        for (unsigned i = 0; i < 4; i++) {
            double sum = 0;
            for (unsigned j = 0; j < 4; j++)
                for (unsigned k = 0; k < 8; k++)
                    sum += (double)settings.g[4 * i + j][k] * h[k][j];
            TEST_ASSERT_DOUBLE_WITHIN(EXACT, sum, D(out[i]));
        }
    }
}

/* Controllers move in the sixth tick of a period of twelve, after less than a period of rest: it ends by count. In one tick settings are
 * taken anew. */
static void course_of_a_long_period(unsigned ticks, unsigned retuned_in)
{
    static const double low[2] = {0.2, 0.1}, high[2] = {0.6, 0.3};
    setup.interval_s = 10;
    settings.period_s = 120;
    begin_at(made_of(0, low, low), made_of(1, low, low));
    for (unsigned t = 0; t < ticks; t++) {
        const double *now = t < 5 ? low : high, *before = t < 12 ? low : high;
        if (t == retuned_in) {
            configure(true);
            io.members.going_on = 3;
            put_in(made_of(0, now, before), made_of(1, now, before));
            polynomial_kind.follow(state, &io);
        }
        stepped(now[0], now[1]);
        assert_out(made_of(0, now, before), made_of(1, now, before));
        told(0, 0);
    }
}

static void of_a_long_period_the_past_moves_once_a_period(void)
{
    course_of_a_long_period(36, 36);
}

static void a_change_of_settings_amid_a_period_leaves_its_end_where_it_is(void)
{
    course_of_a_long_period(24, 8);
}

/* Controllers of the same period that move in its fourth tick: the past has to move when they do. */
static void a_period_begins_where_the_controllers_move_after_a_period_of_rest(void)
{
    double now[2] = {0.2, 0.1}, before[2] = {0.2, 0.1};
    setup.interval_s = 10;
    settings.period_s = 120;
    begin_at(made_of(0, now, now), made_of(1, now, now));
    for (unsigned t = 0; t < 100; t++) {
        if (t >= 16 && t % 12 == 4) {
            memcpy(before, now, sizeof before);
            now[0] = 0.2 + 0.001 * t;
            now[1] = 0.1 - 0.0007 * t;
        }
        stepped(now[0], now[1]);
        assert_out(made_of(0, now, before), made_of(1, now, before));
        told(0, 0);
    }
}

/* ---- who comes and goes ---- */

static void it_begins_at_rest_where_the_mvs_are(void)
{
    begin_at(0.37, 0.81);
    double v[2] = {D(out[0]), D(out[1])};
    for (unsigned t = 0; t < 4; t++) {
        stepped(v[0], v[1]);
        assert_out(0.37, 0.81);
        told(0, 0);
    }
}

static void a_loop_in_manual_neither_moves_nor_is_moved(void)
{
    begin_at(0.5, 0.5);
    io.members.acting = 1;
    put_in(0.5, 0.7);
    polynomial_kind.follow(state, &io);
    double v = D(out[0]);
    out[1] = N(0.123);
    stepped(v, 0.7);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 0.5, D(out[0]));
    TEST_ASSERT_TRUE(num_eq(N(0.123), out[1]));
    told(0, 0);
    stepped(v + 0.1, 0.9);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 0.5 + 0.1 * g_of(0, 0, 0), D(out[0]));
}

static void a_loop_that_joins_bumps_nothing_and_what_is_under_way_goes_on(void)
{
    begin_at(0.5, 0.5);
    io.members.acting = 1;
    put_in(0.5, 0.5);
    polynomial_kind.follow(state, &io);
    double v = D(out[0]);
    stepped(v + 0.1, 0.5); /* of which the second coefficient is still to come */
    double u = D(out[0]);
    told(0, 0);
    io.members.acting = 3;
    io.members.going_on = 1;
    put_in(u, 0.5);
    polynomial_kind.follow(state, &io);
    double joined[2] = {D(out[0]), D(out[1])};
    stepped(joined[0], joined[1]);
    assert_out(u, 0.5);
    told(0, 0);
    /* What loop 1 asks for in place of it shows in the next sample. */
    stepped(joined[0], joined[1]);
    double more = g_of(0, 0, 1) * (joined[0] - (v + 0.1));
    assert_out(u + more, 0.5 + g_of(1, 0, 1) * (joined[0] - (v + 0.1)));
}

static void other_settings_move_no_mv(void)
{
    begin_at(0.3, 0.6);
    stepped(0.4, 0.2);
    double u[2] = {D(out[0]), D(out[1])};
    told(0, 0);
    settings.g[1][0] *= 0.7f;
    configure(true);
    io.members.going_on = 3;
    put_in(u[0], u[1]);
    polynomial_kind.follow(state, &io);
    stepped(D(out[0]), D(out[1]));
    assert_out(u[0], u[1]);
}

/* What an MV has under way after v[] once what loops asked for before is past. */
static double under_way(unsigned i, const double v[2], const double before[2])
{
    double sum = 0;
    for (unsigned j = 0; j < 2; j++)
        sum += (double)settings.g[2 * i + j][1] * (v[j] - before[j]);
    return sum;
}

static void other_coefficients_let_what_is_under_way_go_on(void)
{
    static const double asked[2] = {0.4, 0.2};
    begin_at(0.3, 0.6);
    stepped(asked[0], asked[1]);
    double u[2] = {D(out[0]), D(out[1])};
    told(0, 0);
    settings.g[1][0] *= 0.7f;
    configure(true);
    io.members.going_on = 3;
    put_in(u[0], u[1]);
    polynomial_kind.follow(state, &io);
    double v[2] = {D(out[0]), D(out[1])};
    stepped(v[0], v[1]);
    assert_out(u[0], u[1]);
    told(0, 0);
    stepped(v[0], v[1]);
    TEST_ASSERT_TRUE(fabs(under_way(0, v, asked)) > 0.01);
    assert_out(u[0] + under_way(0, v, asked), u[1] + under_way(1, v, asked));
}

/* Both loops go on, and their MVs stay where they are when what the past had under way would be due. */
static void all_are_at_rest_where_they_are(const char *what)
{
    double u[2] = {D(out[0]), D(out[1])};
    io.members.going_on = 3;
    put_in(u[0], u[1]);
    polynomial_kind.follow(state, &io);
    double v[2] = {D(out[0]), D(out[1])};
    for (unsigned t = 0; t < 8; t++) {
        stepped(v[0], v[1]);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(EXACT, u[0], D(out[0]), what);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(EXACT, u[1], D(out[1]), what);
        told(0, 0);
    }
}

static void with_another_period_or_more_coefficients_all_begin_at_rest(void)
{
    for (unsigned more = 0; more < 2; more++) {
        setUp();
        begin_at(0.3, 0.6);
        stepped(0.4, 0.2);
        num_t u[2] = {out[0], out[1]};
        told(0, 0);
        if (more)
            settings.g[0][2] = 0.01f;
        else
            settings.period_s = 240;
        configure(true);
        memcpy(out, u, sizeof u);
        all_are_at_rest_where_they_are(more ? "more coefficients" : "another period");
    }
}

static void scaling_all_begin_at_rest_whatever_is_under_way(void)
{
    settings.limits = POLYNOMIAL_SCALE;
    begin_at(0.3, 0.6);
    stepped(0.4, 0.2);
    num_t u[2] = {out[0], out[1]};
    told(0, 0);
    memcpy(out, u, sizeof u);
    all_are_at_rest_where_they_are("scale");
}

/* Its memory has been another block's, and its loops have acted before. */
static void a_new_one_begins_at_rest_whatever_was_in_its_memory(void)
{
    memset(state, 0x3F, sizeof state); /* numbers of 0.75 */
    configure(false);
    out[0] = N(0.3);
    out[1] = N(0.6);
    all_are_at_rest_where_they_are("new");
}

/* ---- an MV at its limit ---- */

/* Controllers that ask for something else in every sample, and an MV that stays where it is: the past of its loop is what would have given
 * that, and the other loop has what it asked for. */
static void recursing_the_loop_at_its_limit_gives_way_and_the_other_does_not(void)
{
    double before[2] = {0, 0};
    unsigned limited = 0;
    begin_at(0, 0);
    for (unsigned t = 0; t < 200; t++) {
        double v[2] = {0.4 + 0.1 * sin(0.3 * t), 0.2 - 0.1 * cos(0.2 * t)};
        stepped(v[0], v[1]);
        double u[2] = {D(out[0]), D(out[1])};
        TEST_ASSERT_DOUBLE_WITHIN(10 * EXACT, made_of(1, v, before), u[1]);
        double at_most = fmin(u[0], 0.45);
        limited += at_most < u[0];
        told(at_most - u[0], 0);
        double effective[2] = {v[0] + D(out[0]), v[1] + D(out[1])};
        TEST_ASSERT_DOUBLE_WITHIN(10 * EXACT, at_most, made_of(0, effective, before));
        TEST_ASSERT_EQUAL_DOUBLE(v[1], effective[1]);
        memcpy(before, effective, sizeof before);
    }
    TEST_ASSERT_TRUE(limited > 50 && limited < 200);
}

/* Both MVs at a limit: both pasts are those that would have given what took effect. */
static void recursing_with_all_mvs_at_a_limit_the_past_is_what_took_effect(void)
{
    double before[2] = {0, 0};
    begin_at(0, 0);
    for (unsigned t = 0; t < 100; t++) {
        double v[2] = {0.4 + 0.1 * sin(0.3 * t), 0.2 - 0.1 * cos(0.2 * t)};
        stepped(v[0], v[1]);
        double u[2] = {D(out[0]), D(out[1])};
        told(0.1 - u[0], 0.05 - u[1]);
        double effective[2] = {v[0] + D(out[0]), v[1] + D(out[1])};
        TEST_ASSERT_DOUBLE_WITHIN(10 * EXACT, 0.1, made_of(0, effective, before));
        TEST_ASSERT_DOUBLE_WITHIN(10 * EXACT, 0.05, made_of(1, effective, before));
        memcpy(before, effective, sizeof before);
    }
}

/* Loop 1 has an element of its own with a zero at 1.3: what it is run backwards would grow. */
static void take_one_that_cannot_give_way(void)
{
    settings.limits = POLYNOMIAL_SCALE;
    settings.g[0][1] = -1.3f * settings.g[0][0];
}

static double of_g(unsigned i, unsigned j)
{
    double sum = 0;
    for (unsigned k = 0; k < 8; k++)
        sum += (double)settings.g[2 * i + j][k];
    return sum;
}

static void scaling_all_moves_are_shortened_to_the_same_part(void)
{
    take_one_that_cannot_give_way();
    TEST_ASSERT_TRUE(fabs(of_g(0, 0) * of_g(1, 1) - of_g(0, 1) * of_g(1, 0)) > 0.01);
    begin_at(0.2, 0.2);
    double v[2] = {D(out[0]), D(out[1])};
    stepped(v[0], v[1]);
    told(0, 0);
    stepped(v[0] + 0.1, v[1] - 0.06);
    double move = D(out[0]) - 0.2;
    told(-0.75 * move, 0);
    TEST_ASSERT_DOUBLE_WITHIN(20 * EXACT, -0.075, D(out[0]));
    TEST_ASSERT_DOUBLE_WITHIN(20 * EXACT, 0.045, D(out[1]));
    /* Nothing further that way: no part of the next move is left. */
    stepped(v[0] + 0.125, v[1] - 0.06);
    told(0.2 + 0.25 * move - D(out[0]), 0);
    TEST_ASSERT_DOUBLE_WITHIN(20 * EXACT, -0.1, D(out[0]));
    TEST_ASSERT_DOUBLE_WITHIN(20 * EXACT, 0.045, D(out[1]));
}

static void scaling_what_happens_to_the_mv_of_a_loop_in_manual_shortens_nothing(void)
{
    settings.limits = POLYNOMIAL_SCALE;
    begin_at(0.5, 0.5);
    io.members.acting = 1;
    put_in(0.5, 0.7);
    polynomial_kind.follow(state, &io);
    double v = D(out[0]);
    stepped(v, 0.7);
    told(0, 0);
    stepped(v + 0.1, 0.7);
    told(-0.5 * (D(out[0]) - 0.5), 0.4);
    TEST_ASSERT_DOUBLE_WITHIN(20 * EXACT, -0.05, D(out[0]));
}

static void scaling_one_that_can_gives_way_alone_as_where_all_can(void)
{
    for (unsigned k = 0; k < 2; k++) {
        double came[2][2];
        for (unsigned limits = 0; limits < 2; limits++) {
            settings.limits = (uint8_t)limits;
            begin_at(0.2, 0.2);
            double v[2] = {D(out[0]), D(out[1])};
            for (unsigned t = 0; t < 10; t++) {
                stepped(v[0] + 0.3, v[1] - 0.1);
                told(k ? 0 : 0.25 - D(out[0]), k ? 0.15 - D(out[1]) : 0);
            }
            came[limits][0] = D(out[0]);
            came[limits][1] = D(out[1]);
        }
        TEST_ASSERT_TRUE(fabs(came[POLYNOMIAL_RECURSE][k]) > 0.01);
        TEST_ASSERT_DOUBLE_WITHIN(0, came[POLYNOMIAL_RECURSE][k], came[POLYNOMIAL_SCALE][k]);
        TEST_ASSERT_DOUBLE_WITHIN(0, 0, came[POLYNOMIAL_SCALE][1 - k]);
    }
}

static void scaling_one_that_no_longer_can_does_not_give_way_alone(void)
{
    settings.limits = POLYNOMIAL_SCALE;
    begin_at(0.2, 0.2);
    take_one_that_cannot_give_way();
    configure(true);
    put_in(0.2, 0.2);
    polynomial_kind.follow(state, &io);
    double v[2] = {D(out[0]), D(out[1])};
    stepped(v[0], v[1]);
    told(0, 0);
    stepped(v[0] + 0.1, v[1] - 0.06);
    told(-0.75 * (D(out[0]) - 0.2), 0);
    TEST_ASSERT_DOUBLE_WITHIN(20 * EXACT, -0.075, D(out[0]));
    TEST_ASSERT_DOUBLE_WITHIN(20 * EXACT, 0.045, D(out[1]));
}

/* Loop 1 moves its own MV a sample late: what is lacking of it now nothing can give. */
static void scaling_one_without_an_element_of_its_own_at_first_does_not_give_way_alone(void)
{
    settings.limits = POLYNOMIAL_SCALE;
    settings.g[0][1] += settings.g[0][0];
    settings.g[0][0] = 0;
    begin_at(0.2, 0.2);
    double v[2] = {D(out[0]), D(out[1])};
    stepped(v[0], v[1]);
    told(0, 0);
    stepped(v[0] + 0.1, v[1] - 0.06);
    told(-0.75 * (D(out[0]) - 0.2), 0);
    TEST_ASSERT_DOUBLE_WITHIN(20 * EXACT, -0.075, D(out[0]));
    TEST_ASSERT_DOUBLE_WITHIN(20 * EXACT, 0.045, D(out[1]));
}

static void scaling_two_that_are_limited_are_shortened_with_all(void)
{
    settings.limits = POLYNOMIAL_SCALE;
    begin_at(0.2, 0.2);
    double v[2] = {D(out[0]), D(out[1])};
    stepped(v[0] + 0.1, v[1] - 0.06);
    double move[2] = {D(out[0]) - 0.2, D(out[1]) - 0.2};
    told(-0.5 * move[0], -0.25 * move[1]);
    TEST_ASSERT_DOUBLE_WITHIN(20 * EXACT, -0.05, D(out[0]));
    TEST_ASSERT_DOUBLE_WITHIN(20 * EXACT, 0.03, D(out[1]));
}

static void nothing_limited_comes_to_nothing_exactly(void)
{
    for (unsigned limits = 0; limits < 2; limits++) {
        settings.limits = (uint8_t)limits;
        begin_at(0.3, 0.6);
        stepped(0.77, -0.123);
        told(0, 0);
        TEST_ASSERT_TRUE(num_eq(num_zero(), out[0]) && num_eq(num_zero(), out[1]));
    }
}

/* ---- refusals ---- */

static void assert_refused(const char *field)
{
    TEST_ASSERT_NOT_EQUAL(ERR_OK, polynomial_kind.check(&setup, &fault));
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_TRUE(strlen(fault.wanted) > 0);
}

static void one_without_an_inverse_at_rest_is_refused(void)
{
    memset(settings.g, 0, sizeof settings.g);
    assert_refused("g");
    settings.g[0][0] = settings.g[1][0] = settings.g[2][0] = settings.g[3][0] = 1;
    assert_refused("g");
}

static void one_of_which_a_loop_alone_has_no_inverse_is_refused_with_the_loop(void)
{
    memset(settings.g, 0, sizeof settings.g);
    settings.g[0][0] = 1;
    settings.g[1][0] = settings.g[2][0] = 1;
    assert_refused("g");
    TEST_ASSERT_EQUAL_UINT8(1, fault.member);
}

static void one_whose_inputs_could_not_be_numbers_is_refused(void)
{
    setup.member[0].out_reach = INFINITY;
    assert_refused("g");
    setup.member[0].out_reach = 100;
    assert_refused("g");
}

static void one_that_cannot_be_run_backwards_has_to_be_scaled(void)
{
    settings.g[0][1] = -1.3f * settings.g[0][0]; /* loop 1 alone has a zero at 1.3 */
    assert_refused("limits");
    settings.limits = POLYNOMIAL_SCALE;
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_kind.check(&setup, &fault));
    take_kotyk();
    settings.limits = POLYNOMIAL_RECURSE;
    settings.g[0][2] = settings.g[0][0] + settings.g[0][1];
    settings.g[0][0] = settings.g[0][1] = 0; /* later than the rest of its column */
    assert_refused("limits");
}

static void zeros_up_to_two_per_cent_within_the_circle_are_run_backwards_and_none_outside(void)
{
    setup.members = 1;
    setup.present = 1;
    memset(settings.g, 0, sizeof settings.g);
    settings.g[0][0] = 1;
    for (int sign = -1; sign <= 1; sign += 2) {
        settings.g[0][1] = 0.98f * (float)sign;
        TEST_ASSERT_EQUAL(ERR_OK, polynomial_kind.check(&setup, &fault));
        settings.g[0][1] = 0.999f * (float)sign;
        assert_refused(sign < 0 ? "g" : "limits");
        settings.g[0][1] = 1.02f * (float)sign;
        assert_refused("limits");
        settings.g[0][1] = 100.0f * (float)sign;
        assert_refused("limits");
    }
}

static void a_period_that_is_no_whole_number_of_ticks_is_refused(void)
{
    settings.period_s = 300;
    assert_refused("period");
    settings.period_s = 60;
    assert_refused("period");
    settings.period_s = 360;
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_kind.check(&setup, &fault));
    setup.interval_s = 0.001f;
    assert_refused("period");
    TEST_ASSERT_EQUAL_UINT8(0, fault.member); /* it is of no loop */
}

static void five_loops_are_refused(void)
{
    setup.members = 5;
    setup.present = 31;
    assert_refused("loops");
}

/* G is singular, as half of one may be. */
static void an_incomplete_g_is_not_computed_with(void)
{
    settings.limits = POLYNOMIAL_INCOMPLETE;
    for (unsigned row = 0; row < 4; row++)
        for (unsigned k = 0; k < POLYNOMIAL_TAPS; k++)
            settings.g[row][k] = 1;
    begin_at(0.3, -0.2);
    stepped(0.4, -0.2);
    assert_out(0.4, -0.2);
    TEST_ASSERT_EQUAL(1, io.requests.raised);
    told(-0.1, 0); /* only the loop whose MV is limited gives way */
    assert_out(-0.1, 0);
    settings.limits = POLYNOMIAL_RECURSE;
    take_kotyk();
    configure(true);
    stepped(0.4, -0.2);
    TEST_ASSERT_EQUAL(0, io.requests.raised);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(mvs_are_g_times_what_the_controllers_ask_for_now_and_before);
    RUN_TEST(four_loops_and_eight_coefficients_are_added_up);
    RUN_TEST(of_a_long_period_the_past_moves_once_a_period);
    RUN_TEST(a_change_of_settings_amid_a_period_leaves_its_end_where_it_is);
    RUN_TEST(a_period_begins_where_the_controllers_move_after_a_period_of_rest);
    RUN_TEST(it_begins_at_rest_where_the_mvs_are);
    RUN_TEST(a_loop_in_manual_neither_moves_nor_is_moved);
    RUN_TEST(a_loop_that_joins_bumps_nothing_and_what_is_under_way_goes_on);
    RUN_TEST(other_settings_move_no_mv);
    RUN_TEST(other_coefficients_let_what_is_under_way_go_on);
    RUN_TEST(with_another_period_or_more_coefficients_all_begin_at_rest);
    RUN_TEST(scaling_all_begin_at_rest_whatever_is_under_way);
    RUN_TEST(a_new_one_begins_at_rest_whatever_was_in_its_memory);
    RUN_TEST(recursing_the_loop_at_its_limit_gives_way_and_the_other_does_not);
    RUN_TEST(recursing_with_all_mvs_at_a_limit_the_past_is_what_took_effect);
    RUN_TEST(scaling_all_moves_are_shortened_to_the_same_part);
    RUN_TEST(scaling_one_that_can_gives_way_alone_as_where_all_can);
    RUN_TEST(scaling_one_that_no_longer_can_does_not_give_way_alone);
    RUN_TEST(scaling_one_without_an_element_of_its_own_at_first_does_not_give_way_alone);
    RUN_TEST(scaling_two_that_are_limited_are_shortened_with_all);
    RUN_TEST(scaling_what_happens_to_the_mv_of_a_loop_in_manual_shortens_nothing);
    RUN_TEST(nothing_limited_comes_to_nothing_exactly);
    RUN_TEST(one_without_an_inverse_at_rest_is_refused);
    RUN_TEST(one_of_which_a_loop_alone_has_no_inverse_is_refused_with_the_loop);
    RUN_TEST(one_whose_inputs_could_not_be_numbers_is_refused);
    RUN_TEST(one_that_cannot_be_run_backwards_has_to_be_scaled);
    RUN_TEST(zeros_up_to_two_per_cent_within_the_circle_are_run_backwards_and_none_outside);
    RUN_TEST(a_period_that_is_no_whole_number_of_ticks_is_refused);
    RUN_TEST(five_loops_are_refused);
    RUN_TEST(an_incomplete_g_is_not_computed_with);
    return UNITY_END();
}

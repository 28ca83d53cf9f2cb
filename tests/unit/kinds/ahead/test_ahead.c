/* The controller `ahead` (kinds/ahead/column_ahead.h) on the pilot column. Contract: temperatures 30 s later, in three steps, off by a tenth of the
 * move on average and by 1 K at most, of what an integration in double precision says (tests/reference/column_ahead_reference.py), half of
 * that in twice as many steps, since the method is of first order; in a closed loop with states that are told, w + exp(-h/tau) (y - w) within a
 * tenth of a step, the other loop within what a step of its own as large a move of the MVs would be. */
#include "ahead_bench.h"
#include "csv.h"

void setUp(void)
{
    bench_pilot();
}

void tearDown(void) {}

/* ---- predictions ---- */

struct misses {
    double most, mean, moves;
};

static struct misses misses_in(unsigned parts)
{
    struct misses found = {0, 0, 0};
    double v[18];
    unsigned n = 0;
    FILE *f = csv_open("reference/column_ahead.csv");
    bench_pilot();
    settings.parts = (uint16_t)parts;
    begin();
    struct ahead_model *m = &block()->m;
    while (csv_row(f, v, 18)) {
        struct column_inputs told = m->inputs;
        column_drive_take(&m->table, &told, DRIVE_REFLUX, (real_t)v[0]);
        column_drive_take(&m->table, &told, DRIVE_HEAT, (real_t)v[1]);
        column_drive_take(&m->table, &told, DRIVE_FEED, (real_t)v[2]);
        ahead_model_take_fraction(&told, 2, 0, (real_t)v[3]);
        for (unsigned i = 0; i < 12; i++)
            m->x[i] = (real_t)v[4 + i];
        TEST_ASSERT_EQUAL(ERR_OK, ahead_model_look(m, m->x));
        double before[2] = {(double)m->column.temperature[10], (double)m->column.temperature[1]};
        TEST_ASSERT_EQUAL(ERR_OK, ahead_model_predict(m, &told));
        for (unsigned i = 0; i < 2; i++) {
            double off = fabs((double)m->column.temperature[i ? 1 : 10] - v[16 + i]);
            found.most = fmax(found.most, off);
            found.mean += off / 120;
            found.moves += fabs(v[16 + i] - before[i]) / 120;
        }
        n++;
    }
    fclose(f);
    printf("%u parts, %u cases: off by %.3f K at most, %.3f K on average of %.2f K\n", parts, n,
           found.most, found.mean, found.moves);
    TEST_ASSERT_EQUAL(60, n);
    return found;
}

static void predictions_are_those_of_an_integration_in_double_precision(void)
{
    struct misses three = misses_in(3), six = misses_in(6);
    TEST_ASSERT_TRUE(three.most < 1 && three.mean < three.moves / 10);
    TEST_ASSERT_TRUE(six.mean < 0.6 * three.mean);
}

/* ---- closed loop ---- */

static void each_loop_goes_to_its_setpoint_as_its_time_constant_says(void)
{
    begin();
    double top = at_top(), bottom = at_bottom(), pole = exp(-30.0 / 60);
    ask_for(top + 0.3, bottom);
    for (unsigned k = 1; k <= 9; k++) {
        double left = pow(pole, k);
        tick();
        TEST_ASSERT_DOUBLE_WITHIN(0.03, top + 0.3 * (1 - left), at_top());
        TEST_ASSERT_DOUBLE_WITHIN(0.3, bottom, at_bottom());
    }
    ask_for(top + 0.3, bottom - 1.5);
    for (unsigned k = 1; k <= 9; k++) {
        double left = pow(pole, k);
        tick();
        TEST_ASSERT_DOUBLE_WITHIN(0.03, top + 0.3, at_top());
        TEST_ASSERT_DOUBLE_WITHIN(0.15, bottom - 1.5 * (1 - left), at_bottom());
    }
}

static void nothing_moves_where_the_column_stands_at_its_setpoints(void)
{
    begin();
    double first[2] = {mv[TOP], mv[BOTTOM]};
    ticks(20);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, first[0], mv[TOP]);
    TEST_ASSERT_DOUBLE_WITHIN(0.001, first[1], mv[BOTTOM]);
}

static void no_offset_stays_after_a_load_that_nobody_measures(void)
{
    begin();
    double top = at_top(), bottom = at_bottom();
    plant.inputs.feed_fraction[0] += REAL_C(0.05);
    plant.inputs.feed_fraction[1] -= REAL_C(0.05);
    ticks(60);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, top, at_top());
    TEST_ASSERT_DOUBLE_WITHIN(0.01, bottom, at_bottom());
}

static void no_offset_stays_where_thermometers_are_off_the_model(void)
{
    settings.miss_s = 100;
    begin();
    double top = at_top(), bottom = at_bottom();
    settings.pv_si[TOP][AHEAD_ZERO] = 0.4f; /* the model is told 0.4 K more than there is */
    configure(true);
    ticks(80);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, top, at_top());
    TEST_ASSERT_DOUBLE_WITHIN(0.02, bottom, at_bottom());
}

static void a_load_that_is_measured_is_met_before_it_is_seen(void)
{
    double worst[2] = {0, 0};
    for (unsigned told = 0; told < 2; told++) {
        bench_pilot();
        begin();
        double bottom = at_bottom();
        tick();
        plant.inputs.feed_flow *= REAL_C(1.2);
        for (unsigned k = 0; k < 10; k++) {
            measure();
            if (!told)
                input[IN_FEED] = N(0.5);
            kind->step(state, &io);
            apply();
            plant_runs((double)INTERVAL_S);
            worst[told] = fmax(worst[told], fabs(at_bottom() - bottom));
        }
    }
    printf("bottom off by %.3f K, where the feed is told %.3f K\n", worst[0], worst[1]);
    TEST_ASSERT_TRUE(worst[1] < worst[0] / 5);
}

/* ---- beginning and ending ---- */

static void it_begins_with_the_outputs_in_effect_whatever_the_setpoints_are(void)
{
    begin();
    ask_for(at_top() + 1, at_bottom() - 5);
    follow();
    double before[2] = {D(out[0]), D(out[1])};
    kind->step(state, &io);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, before[0], D(out[0]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, before[1], D(out[1]));
}

static void what_a_feedforward_adds_is_not_its_own(void)
{
    added[TOP] = 0.6;
    begin();
    kind->step(state, &io);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, (2.6 - 0.6) / 12, D(out[0]));
    apply();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 2.6, mv[TOP]);
}

static void what_a_feedforward_adds_later_is_not_its_own_either(void)
{
    begin();
    tick();
    double before = mv[TOP];
    added[TOP] = 0.6;
    tick();
    TEST_ASSERT_TRUE(mv[TOP] > before + 0.5);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(0.2, before, mv[TOP]);
}

static void new_settings_hold_the_outputs_for_a_step_and_then_count(void)
{
    begin();
    ask_for(at_top() + 0.5, at_bottom());
    ticks(2);
    double before = mv[TOP];
    settings.tau_s[TOP] = 600;
    configure(true);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, before, mv[TOP]);
    double left = at_top();
    tick();
    TEST_ASSERT_TRUE(at_top() < left + 0.1 * 0.5);
}

static void a_loop_by_hand_leaves_the_other_to_its_setpoint(void)
{
    begin();
    io.members.acting = 2;
    double bottom = at_bottom();
    mv[TOP] += 1;
    ticks(40);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, bottom, at_bottom());
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 3.6, mv[TOP]);
}

/* ---- limits ---- */

static void a_loop_whose_mv_is_limited_gives_way_alone(void)
{
    begin();
    double top = at_top(), bottom = at_bottom();
    mv_hi[BOTTOM] = 0.66;
    ask_for(top, bottom + 2);
    ticks(40);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.66, mv[BOTTOM]);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, top, at_top());
}

static void it_leaves_a_limit_as_soon_as_there_is_no_need_of_it(void)
{
    begin();
    double top = at_top(), bottom = at_bottom();
    mv_hi[BOTTOM] = 0.66;
    ask_for(top, bottom + 2);
    ticks(20);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.66, mv[BOTTOM]);
    ask_for(top, bottom);
    tick();
    TEST_ASSERT_TRUE(mv[BOTTOM] < 0.655);
}

static void limits_that_widen_are_found(void)
{
    begin();
    double top = at_top(), bottom = at_bottom();
    mv_hi[BOTTOM] = 0.66;
    ask_for(top, bottom + 2);
    ticks(10);
    mv_hi[BOTTOM] = 1.25;
    ticks(20);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, bottom + 2, at_bottom());
    TEST_ASSERT_DOUBLE_WITHIN(0.02, top, at_top());
}

/* ---- what it says ---- */

static void a_pv_that_is_not_where_it_was_predicted_is_told(void)
{
    settings.alarm[TOP] = 0.5f;
    begin();
    ticks(3);
    TEST_ASSERT_EQUAL(0, io.requests.raised);
    in[TOP] = N(D(in[TOP]) + 2.0 / 60);
    kind->step(state, &io);
    TEST_ASSERT_EQUAL(1, io.requests.raised);
    TEST_ASSERT_EQUAL_FLOAT(1, event_value[0]);
}

/* The MV of a loop by hand moves in the tick of the step: predictions of both PVs are of what took effect. */
static void a_move_by_hand_is_part_of_what_is_predicted(void)
{
    static const double move[LOOPS] = {0.4, 0.05};
    for (unsigned by_hand = 0; by_hand < LOOPS; by_hand++) {
        bench_pilot();
        begin();
        io.members.acting = (uint8_t)(1u << (1u - by_hand));
        ticks(3);
        double at[LOOPS] = {at_top(), at_bottom()};
        double missed[LOOPS] = {(double)shown("missed_1"), (double)shown("missed_2")};
        measure();
        kind->step(state, &io);
        mv[by_hand] += move[by_hand];
        apply();
        plant_runs((double)INTERVAL_S);
        measure();
        kind->step(state, &io);
        for (unsigned i = 0; i < LOOPS; i++) {
            double moved = fabs((i ? at_bottom() : at_top()) - at[i]) / 60; /* of the span */
            TEST_ASSERT_TRUE(moved > 1e-3);
            TEST_ASSERT_DOUBLE_WITHIN(0.1 * moved, missed[i],
                                      (double)shown(i ? "missed_2" : "missed_1"));
        }
    }
}

static void it_gives_up_where_the_mv_of_an_input_is_not_that_of_the_loop(void)
{
    const struct applied_history *one = (const struct applied_history *)(const void *)&settings;
    const struct applied_history *two = (const struct applied_history *)(const void *)&setup;
    const struct applied_history *of_loops[LOOPS] = {one, two};
    const struct applied_history *of_inputs[IN_ALL] = {NULL};
    of_inputs[IN_REFLUX] = one;
    of_inputs[IN_HEAT] = two;
    begin();
    io.members.applied = of_loops;
    io.inputs.applied = of_inputs;
    tick();
    of_loops[TOP] = two;
    kind->step(state, &io);
    TEST_ASSERT_EQUAL_STRING("other_mv", io.requests.gives_up);
}

static void a_column_without_a_solution_makes_it_give_up(void)
{
    begin();
    tick();
    block()->m.x[3] = (real_t)NAN;
    measure();
    kind->step(state, &io);
    TEST_ASSERT_NOT_NULL(io.requests.gives_up);
}

static void after_a_failure_it_begins_anew(void)
{
    a_column_without_a_solution_makes_it_give_up();
    io.requests.gives_up = NULL;
    follow();
    TEST_ASSERT_NULL(io.requests.gives_up);
    ticks(5);
    TEST_ASSERT_TRUE(isfinite(mv[TOP]));
}

/* Steps until it gives up while setpoints go to and fro; most: it has not. */
static unsigned steps_until_given_up(unsigned most)
{
    for (unsigned k = 0; k < most; k++) {
        if (k % 40 == 39)
            ask_for(at_top() + (k % 80 == 79 ? 0.5 : -0.5), at_bottom());
        measure();
        kind->step(state, &io);
        if (io.requests.gives_up)
            return k;
        apply();
        plant_runs((double)INTERVAL_S);
    }
    return most;
}

/* Twice the heat that there is, for the model: its predictions miss whatever it does. */
static void a_model_that_is_of_no_use_is_given_up(void)
{
    settings.si[IN_HEAT][AHEAD_FACTOR] = 2000;
    begin();
    ask_for(at_top() + 0.5, at_bottom() - 2);
    TEST_ASSERT_TRUE(steps_until_given_up(200) < 200);
    TEST_ASSERT_EQUAL_STRING("model", io.requests.gives_up);
}

static void no_model_is_given_up_before_it_has_been_watched_for_forty_steps(void)
{
    settings.si[IN_HEAT][AHEAD_FACTOR] = 2000;
    settings.doubt = 0.01f;
    begin();
    ask_for(at_top() + 0.5, at_bottom() - 2);
    TEST_ASSERT_EQUAL(40, steps_until_given_up(200));
    TEST_ASSERT_EQUAL_STRING("model", io.requests.gives_up);
}

static void a_model_that_has_been_of_use_is_given_up_when_it_is_no_longer(void)
{
    begin();
    ticks(60);
    settings.si[IN_HEAT][AHEAD_FACTOR] = 2000;
    configure(true);
    ask_for(at_top() + 0.5, at_bottom() - 2);
    TEST_ASSERT_TRUE(steps_until_given_up(200) < 200);
    TEST_ASSERT_EQUAL_STRING("model", io.requests.gives_up);
}

static void where_it_shall_not_doubt_it_goes_on(void)
{
    settings.si[IN_HEAT][AHEAD_FACTOR] = 2000;
    settings.doubt = 0;
    begin();
    ask_for(at_top() + 0.5, at_bottom() - 2);
    ticks(200);
    TEST_ASSERT_TRUE(shown("doubt_1") > 0.2f && shown("doubt_2") > 0.2f);
}

static void a_model_that_is_right_is_not_in_doubt(void)
{
    begin();
    for (unsigned k = 0; k < 8; k++) {
        ask_for(at_top() + (k % 2 ? 0.3 : -0.3), at_bottom() + (k % 3 ? 1.0 : -2.0));
        ticks(25);
        TEST_ASSERT_TRUE(shown("doubt_1") < 0.2f && shown("doubt_2") < 0.2f);
    }
}

static void values_are_shown_by_name(void)
{
    begin();
    ticks(2);
    TEST_ASSERT_TRUE(shown("b_11") < 0);
    TEST_ASSERT_TRUE(shown("b_22") > 0);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 2.6f / 12, shown("given_1"));
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 0, shown("bias_2"));
}

/* The supervisor moves states between ticks. */
static void it_may_be_moved_to_another_place(void)
{
    static alignas(8) char elsewhere[sizeof state];
    begin();
    ask_for(at_top() + 0.3, at_bottom());
    ticks(2);
    memcpy(elsewhere, state, sizeof state);
    memset(state, 0x55, sizeof state);
    measure();
    kind->step(elsewhere, &io);
    num_t given = out[TOP];
    memcpy(state, elsewhere, sizeof state);
    TEST_ASSERT_TRUE(D(given) > 0 && D(given) < 1);
    TEST_ASSERT_NULL(io.requests.gives_up);
}

/* A loop of it comes or goes in the tick in which it has been moved. */
static void it_may_be_moved_before_it_follows(void)
{
    static alignas(8) char elsewhere[sizeof state];
    begin();
    ticks(2);
    memcpy(elsewhere, state, sizeof state);
    memset(state, 0x55, sizeof state);
    measure();
    num_t before[LOOPS] = {out[TOP], out[BOTTOM]};
    kind->follow(elsewhere, &io);
    TEST_ASSERT_NULL(io.requests.gives_up);
    kind->step(elsewhere, &io);
    TEST_ASSERT_NULL(io.requests.gives_up);
    for (unsigned i = 0; i < LOOPS; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, D(before[i]), D(out[i]));
    for (size_t i = 0; i < sizeof state; i++)
        TEST_ASSERT_EQUAL_HEX8(0x55, state[i]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(predictions_are_those_of_an_integration_in_double_precision);
    RUN_TEST(each_loop_goes_to_its_setpoint_as_its_time_constant_says);
    RUN_TEST(nothing_moves_where_the_column_stands_at_its_setpoints);
    RUN_TEST(no_offset_stays_after_a_load_that_nobody_measures);
    RUN_TEST(no_offset_stays_where_thermometers_are_off_the_model);
    RUN_TEST(a_load_that_is_measured_is_met_before_it_is_seen);
    RUN_TEST(it_begins_with_the_outputs_in_effect_whatever_the_setpoints_are);
    RUN_TEST(what_a_feedforward_adds_is_not_its_own);
    RUN_TEST(what_a_feedforward_adds_later_is_not_its_own_either);
    RUN_TEST(new_settings_hold_the_outputs_for_a_step_and_then_count);
    RUN_TEST(a_loop_by_hand_leaves_the_other_to_its_setpoint);
    RUN_TEST(a_loop_whose_mv_is_limited_gives_way_alone);
    RUN_TEST(it_leaves_a_limit_as_soon_as_there_is_no_need_of_it);
    RUN_TEST(limits_that_widen_are_found);
    RUN_TEST(a_pv_that_is_not_where_it_was_predicted_is_told);
    RUN_TEST(a_move_by_hand_is_part_of_what_is_predicted);
    RUN_TEST(it_gives_up_where_the_mv_of_an_input_is_not_that_of_the_loop);
    RUN_TEST(a_column_without_a_solution_makes_it_give_up);
    RUN_TEST(after_a_failure_it_begins_anew);
    RUN_TEST(a_model_that_is_of_no_use_is_given_up);
    RUN_TEST(no_model_is_given_up_before_it_has_been_watched_for_forty_steps);
    RUN_TEST(a_model_that_has_been_of_use_is_given_up_when_it_is_no_longer);
    RUN_TEST(where_it_shall_not_doubt_it_goes_on);
    RUN_TEST(a_model_that_is_right_is_not_in_doubt);
    RUN_TEST(values_are_shown_by_name);
    RUN_TEST(it_may_be_moved_to_another_place);
    RUN_TEST(it_may_be_moved_before_it_follows);
    return UNITY_END();
}

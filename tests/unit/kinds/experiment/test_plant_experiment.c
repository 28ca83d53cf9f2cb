/* Models from records (kinds/experiment/plant_model.h), and the settings of the kind `experiment`. */
#include <math.h>
#include <stdalign.h>
#include <string.h>

#include "base/channel.h"
#include "base/workspace.h"
#include "block_defaults.h"
#include "kinds/experiment/experiment_job.h"
#include "kinds/experiment/experiment_loops.h"
#include "kinds/experiment/experiment_record.h"
#include "kinds/experiment/experiment_state.h"
#include "kinds/experiment/plant_model.h"
#include "kotyk_record.h"
#include "unity.h"

static struct plant_finding finding;

void setUp(void) {}
void tearDown(void) {}

static const struct plant_wanted wanted = {
    .method = ARX_IV, .criterion = ARX_BIC, .na = 2, .nb = 4, .fit = REAL_C(0.5), .memory = 200};

static unsigned find(const struct arx_data *data, const struct plant_wanted *w, uint32_t most)
{
    unsigned pieces = 1;
    plant_finding_begin(&finding, data, w);
    while (plant_finding_piece(&finding, most))
        pieces++;
    return pieces;
}

/* ---- roots ---- */

static void roots_are_within_the_circle_or_they_are_not(void)
{
    const real_t complex[2] = {REAL_C(-1.6) * REAL_C(0.5), REAL_C(0.64)}; /* of radius 0.8 */
    TEST_ASSERT_TRUE(plant_roots_within(complex, 2, REAL_C(0.81)));
    TEST_ASSERT_FALSE(plant_roots_within(complex, 2, REAL_C(0.79)));
    const real_t real[3] = {REAL_C(-1.0), REAL_C(0.19), REAL_C(0.03)}; /* 0.6, 0.5, -0.1 */
    TEST_ASSERT_TRUE(plant_roots_within(real, 3, REAL_C(0.61)));
    TEST_ASSERT_FALSE(plant_roots_within(real, 3, REAL_C(0.59)));
    const real_t integrates[1] = {REAL_C(-1.0)};
    TEST_ASSERT_FALSE(plant_roots_within(integrates, 1, REAL_C(0.99)));
    TEST_ASSERT_TRUE(plant_roots_within(integrates, 0, REAL_C(0.5)));
}

/* ---- the model ---- */

static void without_noise_the_papers_coefficients_are_found(void)
{
    const struct arx_data data = kotyk_record(600, 0, 1);
    struct plant_wanted w = wanted;
    w.method = ARX_LS;
    (void)find(&data, &w, 50);
    const struct plant_output *y2 = &finding.found[1];
    TEST_ASSERT_EQUAL(PLANT_USABLE, y2->verdict);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -1.06726, (double)y2->a[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.14709, (double)y2->a[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.01262, (double)y2->b[0][0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -0.0199, (double)y2->b[1][0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -0.01833 / 0.07983, (double)y2->gain[1]);
}

static void however_it_is_cut_into_pieces_the_model_is_the_same(void)
{
    static struct plant_output first[2];
    const struct arx_data data = kotyk_record(500, REAL_C(0.01), 2);
    unsigned coarse = find(&data, &wanted, 500);
    memcpy(first, finding.found, sizeof first);
    unsigned fine = find(&data, &wanted, 8);
    TEST_ASSERT_GREATER_THAN(10 * coarse, fine);
    TEST_ASSERT_EQUAL_MEMORY(first, finding.found, sizeof first);
}

static void where_the_gains_are_those_of_a_level_that_wandered_it_is_not_usable(void)
{
    const struct arx_data data = kotyk_record(600, REAL_C(0.002), 3);
    for (int k = 400; k < 600; k++)
        kotyk_y[k][0] += REAL_C(0.002) * (real_t)(k - 400);
    (void)find(&data, &wanted, 100);
    TEST_ASSERT_NOT_EQUAL(PLANT_USABLE, finding.found[0].verdict);
    TEST_ASSERT_EQUAL(PLANT_USABLE, finding.found[1].verdict);
}

static void inputs_at_rest_are_untold(void)
{
    const struct arx_data data = kotyk_record(300, REAL_C(0.01), 3);
    memset(kotyk_u, 0, sizeof kotyk_u);
    (void)find(&data, &wanted, 100);
    for (int i = 0; i < 2; i++)
        TEST_ASSERT_TRUE(finding.found[i].verdict > PLANT_USABLE);
}

static void inputs_that_move_together_are_untold(void)
{
    const struct arx_data data = kotyk_record(300, REAL_C(0.01), 3);
    for (int k = 0; k < 300; k++)
        kotyk_u[k][1] = kotyk_u[k][0];
    (void)find(&data, &wanted, 100);
    for (int i = 0; i < 2; i++)
        TEST_ASSERT_EQUAL(PLANT_UNTOLD, finding.found[i].verdict);
}

/* Half the first input's answer comes in 33 samples, by a lag that a model of this order does not have. */
static void where_a_slow_part_of_the_answer_is_left_out_it_is_unsure(void)
{
    struct plant_wanted w = wanted;
    w.nb = 2;
    for (unsigned has_part = 0; has_part < 2; has_part++) {
        const struct arx_data data = kotyk_record(600, REAL_C(0.002), 3);
        real_t slow = 0;
        for (int k = 0; k < 600 && has_part; k++) {
            kotyk_y[k][1] += slow;
            slow += REAL_C(0.03) * (REAL_C(0.1) * kotyk_u[k][0] - slow);
        }
        (void)find(&data, &w, 100);
        TEST_ASSERT_EQUAL(has_part ? PLANT_UNSURE : PLANT_USABLE, finding.found[1].verdict);
    }
}

static void where_two_thirds_of_the_record_say_another_gain_it_is_unsure(void)
{
    const struct arx_data data = kotyk_record(600, REAL_C(0.002), 3);
    struct plant_wanted w = wanted;
    w.fit = REAL_C(0.2);
    for (int k = 400; k < 600; k++)
        kotyk_y[k][1] *= REAL_C(2.5);
    (void)find(&data, &w, 100);
    TEST_ASSERT_EQUAL(PLANT_UNSURE, finding.found[1].verdict);
    TEST_ASSERT_TRUE(finding.found[1].apart > REAL_C(0.25));
}

static void what_does_not_settle_within_the_sequences_memory_is_slow(void)
{
    const struct arx_data data = kotyk_record(600, REAL_C(0.002), 3);
    struct plant_wanted w = wanted;
    w.memory = 25; /* y2 takes 4 of its 9.7 samples */
    (void)find(&data, &w, 100);
    TEST_ASSERT_EQUAL(PLANT_USABLE, finding.found[0].verdict);
    TEST_ASSERT_EQUAL(PLANT_SLOW, finding.found[1].verdict);
}

/* ---- settings ---- */

static struct experiment_settings settings;
static struct block_setup setup;
static struct block_fault fault;

static void defaults(void)
{
    block_put_defaults(&settings, &experiment_kind);
    setup = (struct block_setup){.settings = &settings, .interval_s = 60, .inputs = 4};
    for (unsigned k = 0; k < 4; k++) {
        setup.input[k] = (struct block_signal){0, 100, k >= 2};
        settings.amplitude[k] = 5;
        settings.band[k] = 20;
    }
}

static const char *refused(void)
{
    memset(&fault, 0, sizeof fault);
    return experiment_kind.check(&setup, &fault) ? fault.field : "";
}

static void what_cannot_be_right_is_refused_by_name(void)
{
    defaults();
    TEST_ASSERT_EQUAL_STRING("", refused());
    setup.inputs = 3;
    TEST_ASSERT_EQUAL_STRING("inputs", refused());
    setup.inputs = 0;
    TEST_ASSERT_EQUAL_STRING("inputs", refused());
    defaults();
    setup.input[1].is_mv = true;
    TEST_ASSERT_EQUAL_STRING("inputs", refused());
    defaults();
    settings.period_s = 90;
    TEST_ASSERT_EQUAL_STRING("period", refused());
    settings.period_s = 30;
    TEST_ASSERT_EQUAL_STRING("period", refused());
    defaults();
    settings.amplitude[1] = 0;
    TEST_ASSERT_EQUAL_STRING("amplitude", refused());
    settings.amplitude[1] = 51;
    TEST_ASSERT_EQUAL_STRING("amplitude", refused());
    defaults();
    settings.reach[0] = 4;
    TEST_ASSERT_EQUAL_STRING("reach", refused());
    defaults();
    settings.band[1] = 0;
    TEST_ASSERT_EQUAL_STRING("band", refused());
}

static void a_record_that_has_no_room_is_refused_and_one_that_is_too_short(void)
{
    defaults();
    settings.periods = 100;
    TEST_ASSERT_EQUAL_STRING("bits", refused());
    settings.bits = 10;
    settings.clock = 1000;
    TEST_ASSERT_EQUAL_STRING("bits", refused());
    settings.bits = 3;
    settings.clock = 2;
    settings.periods = 1;
    TEST_ASSERT_EQUAL_STRING("bits", refused());
}

static void a_cutoff_is_none_or_one_that_the_filter_takes(void)
{
    defaults();
    settings.cutoff = 0.005f;
    TEST_ASSERT_EQUAL_STRING("cutoff", refused());
    settings.cutoff = 0.01f;
    TEST_ASSERT_EQUAL_STRING("", refused());
    settings.cutoff = 0;
    TEST_ASSERT_EQUAL_STRING("", refused());
}

static void what_it_takes_of_the_workspace_grows_with_samples_and_signals(void)
{
    defaults();
    settings.clock = 1;
    float before = 0;
    for (unsigned n = 1; n <= 4; n++) {
        float state[600] = {0}, value = 0;
        setup.inputs = (uint8_t)(2 * n);
        for (unsigned k = 0; k < 2 * n; k++)
            setup.input[k] = (struct block_signal){0, 100, k >= n};
        TEST_ASSERT_EQUAL_STRING("", refused());
        TEST_ASSERT_TRUE(experiment_kind.bytes(&setup) <= sizeof state);
        TEST_ASSERT_EQUAL(ERR_OK, experiment_kind.configure(state, &setup, false));
        TEST_ASSERT_EQUAL_STRING("bytes", experiment_kind.describe(state, 7, &value));
        TEST_ASSERT_TRUE(value >= before + 254 * 2 * 4);
        TEST_ASSERT_TRUE(value <= WORKSPACE_BYTES);
        before = value;
    }
}

static void its_state_has_room_for_the_model_and_begins_without_a_past(void)
{
    static float state[600];
    defaults();
    for (unsigned n = 1; n <= 4; n++) {
        float stage = -1;
        size_t needs = sizeof(struct plant_experiment) +
                       (n * DIFFERENCE_A_MOST + n * n * DIFFERENCE_B_MOST) * sizeof(float);
        setup.inputs = (uint8_t)(2 * n);
        for (unsigned k = 0; k < 2 * n; k++)
            setup.input[k] = (struct block_signal){0, 100, k >= n};
        TEST_ASSERT_TRUE(experiment_kind.bytes(&setup) >= needs);
        TEST_ASSERT_TRUE(experiment_kind.bytes(&setup) < needs + 8);
        TEST_ASSERT_EQUAL(0, experiment_kind.bytes(&setup) % 8);
        memset(state, 0x3F, sizeof state); /* another block's */
        TEST_ASSERT_EQUAL(ERR_OK, experiment_kind.configure(state, &setup, false));
        TEST_ASSERT_EQUAL_STRING("stage", experiment_kind.describe(state, 0, &stage));
        TEST_ASSERT_EQUAL_FLOAT(0, stage);
    }
}

/* ---- readings that are missing ---- */

static void three_samples_without_a_reading_in_a_row_or_a_tenth_of_all_may_be_missing(void)
{
    static struct plant_experiment e;
    num_t input[4] = {num_zero()};
    uint8_t quality[4] = {QUALITY_GOOD, QUALITY_GOOD, QUALITY_GOOD, QUALITY_GOOD};
    struct block_io io = {.inputs.value = input, .inputs.quality = quality};
    for (unsigned row = 3; row <= 7; row++) {
        enum experiment_reason reason = REASON_NONE;
        unsigned missing = 0;
        memset(&e, 0, sizeof e);
        e.context.n = 2;
        e.context.ticks = 2;
        e.context.wanted = 127;
        for (unsigned k = 0; k < 400 && !reason; k++) {
            quality[1] = k % 10 < row ? QUALITY_BAD : QUALITY_GOOD;
            missing += k % 10 < row;
            reason = experiment_read(&e.record, &e.context, &io, false, &e.stages.at_fault);
        }
        TEST_ASSERT_EQUAL(REASON_MEASUREMENT, reason);
        TEST_ASSERT_EQUAL_UINT8(2, e.stages.at_fault);
        TEST_ASSERT_EQUAL_UINT(row <= 6 ? 127 * 2 / 10 + 1 : 7, missing);
    }
}

/* ---- the recursive estimate ---- */

/* y(t) + a1 y(t-1) + a2 y(t-2) = b1 u1(t-1) + ... in fractions of spans of 100 and 50. */
static void the_gain_of_the_recursive_estimate_is_that_at_rest_and_0_of_what_integrates(void)
{
    static const struct {
        float a1, a2, gain;
    } rows[] = {{-0.5f, 0, 2 * 0.3f / 0.5f},
                {-1.2f, 0.4f, 2 * 0.3f / 0.2f},
                {-1, 0, 0},
                {-1.5f, 0.5f, 0},
                {-1.25f, 0, 0}};
    static struct experiment_context c;
    static struct experiment_rows record;
    static alignas(8) char memory[8192];
    TEST_ASSERT_TRUE(experiment_rows_bytes(1, 10) <= sizeof memory);
    memset(&c, 0, sizeof c);
    c.n = 1;
    c.wanted = 10;
    c.input[0] = (struct block_signal){0, 100, false};
    c.input[1] = (struct block_signal){0, 50, true};
    experiment_rows_begin(&record, &c, memory);
    for (unsigned k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        num_t theta[RLS_MAX] = {num_from_float(rows[k].a1), num_from_float(rows[k].a2),
                                num_from_float(0.1f), num_from_float(0.2f)};
        rls_set(record.rls[0], theta);
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, rows[k].gain, experiment_live_gain(&record, &c, 0, 0));
    }
}

/* ---- the test signal ---- */

static void the_signal_goes_as_far_as_reach_says_or_twice_its_amplitude(void)
{
    static struct plant_experiment e;
    struct block_excitation excite[BLOCK_INPUTS_MAX] = {{0}};
    struct block_io io = {.requests.excite = excite};
    memset(&e, 0, sizeof e);
    e.context.n = 2;
    for (unsigned k = 0; k < 4; k++)
        e.context.input[k] = (struct block_signal){(float)(10 * k), (float)(10 * k + 50), k >= 2};
    e.context.s.amplitude[0] = 2.5f;
    e.context.s.amplitude[1] = 0.25f;
    e.context.s.reach[1] = 0.75f;
    e.record.rest[0] = REAL_C(0.5);
    e.record.rest[1] = REAL_C(0.4);
    e.record.signal[0] = REAL_C(0.05);
    TEST_ASSERT_FALSE(experiment_ask_signal(&e.record, &e.context, &io));
    TEST_ASSERT_EQUAL(EXCITE_NOTHING, excite[0].what); /* no sample yet */
    e.record.samples = 1;
    TEST_ASSERT_TRUE(experiment_ask_signal(&e.record, &e.context, &io));
    TEST_ASSERT_EQUAL_UINT8(2, excite[0].which);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.05f, num_to_float(excite[0].value));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.05f, num_to_float(excite[0].amplitude));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.5f - 0.1f, num_to_float(excite[0].lo));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.5f + 0.1f, num_to_float(excite[0].hi));
    TEST_ASSERT_EQUAL_UINT8(3, excite[1].which);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.4f - 0.015f, num_to_float(excite[1].lo));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.4f + 0.015f, num_to_float(excite[1].hi));
    TEST_ASSERT_EQUAL(EXCITE_NOTHING, excite[2].what);
}

/* ---- controllers that are proposed ---- */

static void a_controller_waits_until_the_experiments_own_proposal_is_gone(void)
{
    static struct plant_experiment e;
    static struct block_proposal room;
    memset(&e, 0, sizeof e);
    e.context.n = 1;
    e.context.s.place[0] = 3;
    room.n = 1;
    room.manner = PROPOSAL_AT_ONCE;
    TEST_ASSERT_TRUE(experiment_loops_propose(&e.loops, &e.context, &room));
    TEST_ASSERT_EQUAL_UINT8(1, room.n);
    TEST_ASSERT_EQUAL_UINT8(PROPOSAL_AT_ONCE, room.manner);
    memset(&room, 0, sizeof room);
    TEST_ASSERT_TRUE(experiment_loops_propose(&e.loops, &e.context, &room));
    TEST_ASSERT_EQUAL_UINT8(PROPOSAL_MAX, room.n); /* all of the controller */
    TEST_ASSERT_FALSE(
        experiment_loops_propose(&e.loops, &e.context, memset(&room, 0, sizeof room)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(roots_are_within_the_circle_or_they_are_not);
    RUN_TEST(without_noise_the_papers_coefficients_are_found);
    RUN_TEST(however_it_is_cut_into_pieces_the_model_is_the_same);
    RUN_TEST(where_the_gains_are_those_of_a_level_that_wandered_it_is_not_usable);
    RUN_TEST(inputs_at_rest_are_untold);
    RUN_TEST(inputs_that_move_together_are_untold);
    RUN_TEST(where_a_slow_part_of_the_answer_is_left_out_it_is_unsure);
    RUN_TEST(where_two_thirds_of_the_record_say_another_gain_it_is_unsure);
    RUN_TEST(what_does_not_settle_within_the_sequences_memory_is_slow);
    RUN_TEST(what_cannot_be_right_is_refused_by_name);
    RUN_TEST(a_record_that_has_no_room_is_refused_and_one_that_is_too_short);
    RUN_TEST(a_cutoff_is_none_or_one_that_the_filter_takes);
    RUN_TEST(what_it_takes_of_the_workspace_grows_with_samples_and_signals);
    RUN_TEST(its_state_has_room_for_the_model_and_begins_without_a_past);
    RUN_TEST(three_samples_without_a_reading_in_a_row_or_a_tenth_of_all_may_be_missing);
    RUN_TEST(the_gain_of_the_recursive_estimate_is_that_at_rest_and_0_of_what_integrates);
    RUN_TEST(the_signal_goes_as_far_as_reach_says_or_twice_its_amplitude);
    RUN_TEST(a_controller_waits_until_the_experiments_own_proposal_is_gone);
    return UNITY_END();
}

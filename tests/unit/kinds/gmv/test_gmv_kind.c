/* The kind `gmv` with two loops that compute with the parameters of their settings, on the plant that these describe: what a limit of an MV
 * does to the other loop, and where loops are solved one by one. Everything in fractions of span. */
#include <math.h>
#include <stdalign.h>
#include <string.h>

#include "base/channel.h"
#include "block_defaults.h"
#include "formats.h"
#include "kinds/gmv/gmv_kind.h"
#include "kinds/gmv/gmv_kind_state.h"
#include "kinds/gmv/gmv_settings.h"
#include "unity.h"

#define LOOPS GMV_LOOPS
#define DEPTH 64
#define REST  0.5

static alignas(8) char state[16384];
static struct {
    alignas(8) char bytes[sizeof(struct applied_history) + DEPTH * sizeof(num_t)];
} ring[LOOPS];
static const struct applied_history *applied[LOOPS];
static struct gmv_settings settings;
static struct block_setup setup;
static struct block_io io;
static num_t setpoint[LOOPS], in[LOOPS], out[LOOPS], input[LOOPS];
static uint8_t clamp[LOOPS], limited[LOOPS], quality[LOOPS];
static float age_s[LOOPS], event_value[BLOCK_EVENTS_MAX];

/* y(t+1) = a y + b u + c, at rest where y and u are REST. */
static double a, b[LOOPS][LOOPS], y[LOOPS], w[LOOPS], least[LOOPS], most[LOOPS];
static double given[LOOPS]; /* by the block, before limits */

static struct applied_history *ring_of(unsigned j)
{
    return (struct applied_history *)(void *)ring[j].bytes;
}

/* Not supervised, and sure of its parameters: it computes with them from its first step on. */
static void begin(double g11, double g12, double g21, double g22)
{
    const double g[LOOPS][LOOPS] = {{g11, g12}, {g21, g22}};
    struct block_fault fault;
    block_put_defaults(&settings, &gmv_kind);
    a = 0.9;
    settings.nb = 1;
    settings.supervise = 0;
    settings.tune_time_s = 0;
    settings.p0[0] = settings.p0[1] = 1e-6f;
    memset(&setup, 0, sizeof setup);
    setup.settings = &settings;
    setup.interval_s = 30;
    setup.members = setup.inputs = LOOPS;
    setup.present = 3;
    for (unsigned i = 0; i < LOOPS; i++) {
        settings.tau_p_s[i] = 0;
        settings.tune_gain[i] = 1;
        settings.theta[i][0] = (float)a;
        settings.theta[i][1] = (float)g[i][i]; /* own MV first */
        settings.theta[i][2] = (float)g[i][1 - i];
        setup.member[i] = (struct block_member){
            .loop = (uint8_t)i, .drives_mv = true, .pv_span = 1, .out_reach = 1};
        setup.pv[i] = setup.input[i] = (struct block_signal){0, 1, false};
        applied_history_begin(ring_of(i), DEPTH, N(REST));
        applied[i] = ring_of(i);
        y[i] = w[i] = REST;
        least[i] = 0;
        most[i] = 1;
        out[i] = N(REST);
        quality[i] = QUALITY_GOOD;
    }
    memcpy(b, g, sizeof b);
    io = (struct block_io){.members.acting = 3,
                           .members.setpoint = setpoint,
                           .members.in = in,
                           .members.out = out,
                           .members.clamp = clamp,
                           .members.limited = limited,
                           .inputs.value = input,
                           .inputs.quality = quality,
                           .inputs.age_s = age_s,
                           .requests.event_value = event_value,
                           .members.applied = applied,
                           .members.divisor = 1};
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, gmv_kind.check(&setup, &fault), fault.wanted);
    TEST_ASSERT_TRUE(gmv_kind.bytes(&setup) <= sizeof state);
    TEST_ASSERT_TRUE(gmv_kind.history(&setup) <= DEPTH);
    TEST_ASSERT_EQUAL(ERR_OK, gmv_kind.configure(state, &setup, false));
    for (unsigned i = 0; i < LOOPS; i++)
        in[i] = input[i] = setpoint[i] = N(REST);
    gmv_kind.follow(state, &io);
}

static void step(void)
{
    double next[LOOPS], u[LOOPS];
    for (unsigned i = 0; i < LOOPS; i++) {
        in[i] = input[i] = N(y[i]);
        setpoint[i] = N(w[i]);
    }
    io.requests.raised = 0;
    gmv_kind.step(state, &io);
    TEST_ASSERT_NULL_MESSAGE(io.requests.gives_up, io.requests.gives_up);
    for (unsigned j = 0; j < LOOPS; j++) {
        given[j] = D(out[j]);
        u[j] = fmin(fmax(given[j], least[j]), most[j]);
        out[j] = N(u[j]);
        applied_history_append(ring_of(j), out[j]);
    }
    gmv_kind.back_calculate(state, &io);
    for (unsigned i = 0; i < LOOPS; i++) {
        next[i] = REST + a * (y[i] - REST);
        for (unsigned j = 0; j < LOOPS; j++)
            next[i] += b[i][j] * (u[j] - REST);
    }
    memcpy(y, next, sizeof y);
}

static void steps(unsigned n)
{
    while (n--)
        step();
}

void setUp(void) {}
void tearDown(void) {}

static bool raises(const char *code)
{
    for (unsigned i = 0; i < gmv_kind.events; i++)
        if (strcmp(gmv_kind.event[i].code, code) == 0)
            return io.requests.raised & (1u << i);
    TEST_FAIL_MESSAGE(code);
    return false;
}

static void both_pvs_come_to_their_setpoints(void)
{
    begin(0.1, 0.05, 0.06, 0.1);
    w[0] = 0.55;
    w[1] = 0.45;
    steps(300);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.55, y[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.45, y[1]);
    TEST_ASSERT_TRUE(raises("adopted"));
    TEST_ASSERT_FALSE(raises("singular"));
}

static void a_test_lasts_the_time_of_its_setting_and_ten_steps_at_least(void)
{
    static const struct {
        float interval_s, check_s;
        uint32_t steps;
    } rows[] = {{30, 1800, 60}, {600, 1800, 10}, {30, 0, 10}, {180, 1800, 10}, {150, 1800, 12}};
    begin(0.1, 0.05, 0.05, 0.1);
    for (unsigned k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        struct gmv_supervise_config c;
        struct block_fault fault;
        setup.interval_s = rows[k].interval_s;
        settings.check_time_s = rows[k].check_s;
        TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, gmv_kind.check(&setup, &fault), fault.wanted);
        gmv_supervise_config_of(&setup, &c);
        TEST_ASSERT_EQUAL_UINT32(rows[k].steps, c.check_steps);
    }
}

static void a_state_has_a_whole_number_of_places_of_eight_bytes(void)
{
    begin(0.1, 0.05, 0.05, 0.1);
    for (unsigned loops = 1; loops <= LOOPS; loops++)
        for (unsigned nb = 1; nb <= 4; nb++) {
            setup.members = setup.inputs = (uint8_t)loops;
            settings.nb = (uint16_t)nb;
            TEST_ASSERT_EQUAL(0, gmv_kind.bytes(&setup) % 8);
            TEST_ASSERT_TRUE(gmv_kind.bytes(&setup) >= sizeof(struct gmv_block));
        }
}

static void a_weight_is_on_the_mv_or_on_its_move(void)
{
    static const struct {
        uint8_t word, weight;
    } rows[] = {{GMV_WORD_DELTA, GMV_WEIGHT_DELTA},
                {GMV_WORD_SCALAR, GMV_WEIGHT_SCALAR},
                {GMV_WORD_RELATIVE, GMV_WEIGHT_DELTA}};
    begin(0.1, 0.05, 0.05, 0.1);
    for (unsigned k = 0; k < 3; k++) {
        struct gmv_config c;
        settings.weight = rows[k].word;
        gmv_config_of(&setup, &c);
        TEST_ASSERT_EQUAL(rows[k].weight, c.shape.weight);
    }
}

static void at_rest_no_mv_moves_when_the_law_takes_over(void)
{
    begin(0.1, 0.05, 0.05, 0.1);
    for (unsigned t = 0; t < 30; t++) {
        step();
        for (unsigned i = 0; i < LOOPS; i++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, REST, D(out[i]));
    }
    TEST_ASSERT_EQUAL(GMV_SELF_TUNING,
                      ((const struct gmv_block *)(const void *)state)->watch.status.state);
}

/* A request beyond one MV's limit must not move the other MV. */
static void
a_limit_of_one_mv_leaves_the_other_loop_at_its_setpoint_and_is_forgotten_when_it_ends(void)
{
    for (unsigned k = 0; k < LOOPS; k++)
        for (int side = -1; side <= 1; side += 2) {
            begin(0.1, 0.05, 0.06, 0.1);
            least[k] = side < 0 ? 0.4 : 0;
            most[k] = side < 0 ? 1 : 0.6;
            w[k] = REST + 0.25 * side;
            steps(300);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, REST + 0.1 * side, D(out[k]));
            TEST_ASSERT_TRUE(fabs(y[k] - REST) < 0.2);
            TEST_ASSERT_DOUBLE_WITHIN(2e-3, REST, y[1 - k]);
            least[k] = 0;
            most[k] = 1;
            steps(300);
            TEST_ASSERT_DOUBLE_WITHIN(2e-3, w[k], y[k]);
            TEST_ASSERT_DOUBLE_WITHIN(2e-3, REST, y[1 - k]);
        }
}

/* Both MVs are shut when the law takes over, and both loops have as far to go then. */
static void two_loops_that_begin_alike_go_on_alike(void)
{
    begin(0.05, 0.02, 0.02, 0.05);
    for (unsigned i = 0; i < LOOPS; i++) {
        applied_history_begin(ring_of(i), DEPTH, num_zero());
        out[i] = num_zero();
        y[i] = REST - 0.07 / (1 - a) * REST;
        w[i] = y[i];
    }
    gmv_kind.follow(state, &io);
    steps(30);
    TEST_ASSERT_TRUE(raises("adopted"));
    w[0] = w[1] = y[0] + 0.1;
    for (unsigned t = 0; t < 60; t++) {
        step();
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, D(out[0]), D(out[1]));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, w[0], y[0]);
}

static void loops_that_are_alike_are_solved_one_by_one_and_it_says_so(void)
{
    begin(0.1, 0.0999, 0.0999, 0.1);
    settings.lambda[0] = settings.lambda[1] = 0;
    TEST_ASSERT_EQUAL(ERR_OK, gmv_kind.configure(state, &setup, true));
    steps(20);
    TEST_ASSERT_TRUE(raises("singular"));
}

static float shown(const char *name)
{
    float value = 0;
    const char *found;
    for (size_t i = 0; (found = gmv_kind.describe(state, i, &value)) != NULL; i++)
        if (strcmp(found, name) == 0)
            return value;
    TEST_FAIL_MESSAGE(name);
    return 0;
}

static void tell(const char *verb)
{
    for (unsigned i = 0; i < gmv_kind.verbs; i++)
        if (strcmp(gmv_kind.verb[i].name, verb) == 0) {
            TEST_ASSERT_NULL(gmv_kind.verb[i].run(state, NULL));
            return;
        }
    TEST_FAIL_MESSAGE(verb);
}

/* Supervised, with everything to learn. */
static void begin_to_tune(void)
{
    begin(0.1, 0.05, 0.06, 0.1);
    memset(settings.theta, 0, sizeof settings.theta);
    settings.supervise = 1;
    settings.tune_time_s = settings.check_time_s = 600;
    settings.p0[0] = settings.p0[1] = 1e6f;
    TEST_ASSERT_EQUAL(ERR_OK, gmv_kind.configure(state, &setup, false));
    gmv_kind.follow(state, &io);
}

/* Step k. Both setpoints move, one every 10 steps and one every 14. */
static void step_with_moving_setpoints(unsigned k)
{
    w[0] = REST + (k / 10 % 2 ? 0.05 : -0.05);
    w[1] = REST + (k / 14 % 2 ? 0.05 : -0.05);
    step();
}

static void told_to_reset_it_is_as_unsure_of_its_parameters_as_at_first(void)
{
    begin_to_tune();
    float first[LOOPS] = {shown("trace_1"), shown("trace_2")};
    for (unsigned k = 0; k < 18; k++)
        step_with_moving_setpoints(k);
    TEST_ASSERT_TRUE(shown("trace_1") < first[0] / 2 && shown("trace_2") < first[1] / 2);
    tell("reset");
    TEST_ASSERT_EQUAL_FLOAT(first[0], shown("trace_1"));
    TEST_ASSERT_EQUAL_FLOAT(first[1], shown("trace_2"));
}

/* The main loop has done a trial by the next step. Returns how many there were. */
static unsigned trials_until_adopted(void)
{
    unsigned trials = 0;
    begin_to_tune();
    for (unsigned k = 0; k < 400 && !raises("adopted"); k++) {
        io.requests.work_done = io.requests.ask_work > 0;
        while (io.requests.work_done && gmv_kind.work(state))
            ;
        io.requests.ask_work = 0;
        step_with_moving_setpoints(k);
        trials += io.requests.ask_work > 0;
    }
    io.requests.work_done = false;
    TEST_ASSERT_TRUE(raises("adopted"));
    return trials;
}

static void a_model_is_tried_once(void)
{
    TEST_ASSERT_EQUAL_UINT(1, trials_until_adopted());
}

/* The plant's gains turn round, so the PVs are on their way when it gives up. */
static void when_it_gives_up_its_pis_go_on_from_the_outputs_in_effect(void)
{
    double before[LOOPS] = {0}, pv[LOOPS] = {0};
    (void)trials_until_adopted();
    for (unsigned i = 0; i < LOOPS; i++)
        for (unsigned j = 0; j < LOOPS; j++)
            b[i][j] = -b[i][j];
    for (unsigned k = 0; k < 400 && raises("adopted"); k++) {
        for (unsigned i = 0; i < LOOPS; i++) {
            before[i] = D(out[i]);
            pv[i] = D(in[i]);
        }
        step_with_moving_setpoints(k);
    }
    TEST_ASSERT_FALSE(raises("adopted"));
    for (unsigned i = 0; i < LOOPS; i++) {
        TEST_ASSERT_TRUE(fabs(D(in[i]) - pv[i]) > 1e-3);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, before[i], given[i]);
    }
}

/* Its PIs hold both PVs where they are: nothing has been learnt that could be tried. */
static void at_rest_no_model_is_tried(void)
{
    begin_to_tune();
    for (unsigned k = 0; k < 200; k++) {
        step();
        TEST_ASSERT_EQUAL(0, io.requests.ask_work);
        TEST_ASSERT_FALSE(raises("adopted") || raises("refused"));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(both_pvs_come_to_their_setpoints);
    RUN_TEST(a_test_lasts_the_time_of_its_setting_and_ten_steps_at_least);
    RUN_TEST(a_state_has_a_whole_number_of_places_of_eight_bytes);
    RUN_TEST(a_weight_is_on_the_mv_or_on_its_move);
    RUN_TEST(at_rest_no_mv_moves_when_the_law_takes_over);
    RUN_TEST(a_limit_of_one_mv_leaves_the_other_loop_at_its_setpoint_and_is_forgotten_when_it_ends);
    RUN_TEST(two_loops_that_begin_alike_go_on_alike);
    RUN_TEST(loops_that_are_alike_are_solved_one_by_one_and_it_says_so);
    RUN_TEST(told_to_reset_it_is_as_unsure_of_its_parameters_as_at_first);
    RUN_TEST(a_model_is_tried_once);
    RUN_TEST(when_it_gives_up_its_pis_go_on_from_the_outputs_in_effect);
    RUN_TEST(at_rest_no_model_is_tried);
    return UNITY_END();
}

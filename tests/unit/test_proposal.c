/* commission/proposal.[ch]: a proposal as a configuration.
 *
 * Contract
 *   random plants (200)   whatever is written is accepted by plan_build, within the ranges of the parameters, and survives
 *                         being printed and read back; other loops and channels stay as they are
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "commission/proposal.h"
#include "commission_space.h"
#include "plan/plan_build.h"
#include "random_source.h"
#include "supervise/arena.h"
#include "supervisor_bench.h"

#define SEED 20240712u

static struct commission c;
static struct supervisor supervisor;
static struct config config, before, again;
static struct plan plan;

static void channels(unsigned outputs, unsigned inputs)
{
    char name[24], value[24];
    memset(&bench, 0, sizeof bench);
    parameters_defaults(&bench.config);
    for (unsigned i = 1; i <= outputs; i++) {
        snprintf(name, sizeof name, "meas%u.name", i);
        snprintf(value, sizeof value, "y%u", i);
        put(name, value);
        snprintf(name, sizeof name, "meas%u.hi", i);
        put(name, "50");
    }
    for (unsigned i = 1; i <= inputs; i++) {
        snprintf(name, sizeof name, "mv%u.name", i);
        snprintf(value, sizeof value, "u%u", i);
        put(name, value);
        snprintf(name, sizeof name, "mv%u.hi", i);
        put(name, "4");
        snprintf(name, sizeof name, "mv%u.max", i);
        put(name, "4");
    }
}

/* As if the tests of all channels had just been made, with this plant for a result. */
static void begin(unsigned outputs, unsigned inputs)
{
    memset(&c, 0, sizeof c);
    commission_lease(&c);
    c.outputs.n = (uint8_t)outputs;
    c.inputs.n = (uint8_t)inputs;
    for (uint8_t i = 0; i < outputs; i++)
        c.outputs.measurement[i] = i;
    for (uint8_t i = 0; i < inputs; i++) {
        c.inputs.input[i].output = c.analysis_job.column[i] = i;
        c.inputs.input[i].rounds = 1;
    }
    c.work->analysis.plant.outputs = c.outputs.n;
    c.work->analysis.plant.inputs = c.inputs.n;
    c.outputs.channels = commission_channels(&bench.config);
}

static void analyse(double h_s)
{
    struct analysis_config settings = {.h_s = (real_t)h_s,
                                       .confidence = REAL_C(0.95),
                                       .floor = REAL_C(0.01),
                                       .step = REAL_C(0.05),
                                       .loops_max = CONFIG_LOOPS};
    TEST_ASSERT_EQUAL_INT(ERR_OK, analysis_begin(&c.work->analysis, &settings));
    enum err err;
    while ((err = analysis_step(&c.work->analysis)) == ERR_BUSY)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    c.status.phase = COMMISSION_READY;
    c.status.analysed = true;
}

/* Diagonal of first order, a little of it everywhere else. */
static void simple(unsigned n)
{
    begin(n, n);
    for (unsigned j = 0; j < n; j++)
        for (unsigned i = 0; i < n; i++) {
            c.work->analysis.plant.element[j][i] =
                (struct fopdt){.gain = i == j ? REAL_C(1.0) : REAL_C(0.1),
                               .time_constant_s = 300,
                               .dead_time_s = 30};
            c.work->analysis.plant.gain_sd[j][i] = REAL_C(0.001);
        }
    analyse(1);
    TEST_ASSERT_TRUE(commission_has_proposal(&c));
}

/* Onto what is configured. */
static void writes(void)
{
    config = bench.config;
    TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_write(&c, &config));
}

static double tick_s;

static void builds(const struct config *settings)
{
    struct config_fault fault;
    if (plan_build(&plan, settings, (float)tick_s, &fault) == ERR_OK)
        return;
    char text[160];
    snprintf(text, sizeof text, "%s%u.%s '%s' %s", fault.group, fault.index, fault.field,
             fault.subject, fault.wanted);
    TEST_FAIL_MESSAGE(text);
}

static void survives(const char *name)
{
    static char value[64];
    struct parameter p;
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, parameter_find(name, &p), name);
    struct text t = text_on(value, sizeof value);
    parameter_value(&p, &config, &t);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, parameter_set(&p, &again, value), name);
}

/* Every parameter of the proposed loops and feedforwards, as a saved configuration would be read back. */
static void survives_being_written_down(void)
{
    static const char *const fed[] = {"from", "to",        "gain", "lead", "lag",
                                      "dead", "reference", "lo",   "hi"};
    static const char *const fields[] = {"name",   "pv",     "out",      "gain",     "ti",
                                         "td",     "n",      "b",        "c",        "out_lo",
                                         "out_hi", "action", "sp_track", "decouple", "divisor"};
    char name[32];
    again = config;
    for (unsigned i = 1; i <= CONFIG_LOOPS; i++) {
        unsigned row = i <= DECOUPLER_MAX ? DECOUPLER_MAX : 0;
        for (unsigned k = 0; k < sizeof fields / sizeof fields[0] + row; k++) {
            bool loop = k < sizeof fields / sizeof fields[0];
            if (loop)
                snprintf(name, sizeof name, "loop%u.%s", i, fields[k]);
            else
                snprintf(name, sizeof name, "decouple%u.d%u", i,
                         k - (unsigned)(sizeof fields / sizeof fields[0]) + 1u);
            survives(name);
        }
    }
    for (unsigned i = 1; i <= CONFIG_FEEDFORWARDS; i++)
        for (unsigned k = 0; k < sizeof fed / sizeof fed[0]; k++) {
            snprintf(name, sizeof name, "ff%u.%s", i, fed[k]);
            survives(name);
        }
    TEST_ASSERT_EQUAL_MEMORY(&config, &again, sizeof config);
}

void setUp(void)
{
    tick_s = 1.0;
}
void tearDown(void) {}

/* ---- whatever the plant ---- */

static void random_plant(struct random_source *r)
{
    unsigned most =
        random_below(r, 20) ? 5 : 12; /* more loops than a decoupler spans, now and then */
    unsigned outputs = 1 + random_below(r, most), inputs = 1 + random_below(r, most);
    double speed = pow(10.0, (double)random_below(r, 700) / 100.0 - 2.0); /* 0.01 to 1e5 s */
    double size = pow(10.0, (double)random_below(r, 800) / 100.0 - 5.0);  /* 1e-5 to 1e3 */
    bool strong = random_below(r, 3) == 0; /* as two temperatures of a column */
    if (strong)
        outputs = inputs = 2;
    channels(outputs, inputs);
    begin(outputs, inputs);
    for (unsigned j = 0; j < outputs; j++)
        for (unsigned i = 0; i < inputs; i++) {
            double gain = size * ((double)random_below(r, 2000) / 1000.0 - 1.0);
            if (random_below(r, 8) == 0)
                gain = 0.0;
            if (strong)
                gain = size * (i == j ? 1.0 : 0.9 + 0.03 * fabs(gain / size));
            else if (i == j)
                gain += gain < 0 ? -1.5 * size : 1.5 * size;
            double lag = random_below(r, 6) ? speed * (0.2 + random_below(r, 1000) / 250.0) : 0.0;
            double dead = random_below(r, 3) ? speed * random_below(r, 1000) / 500.0 : 0.0;
            c.work->analysis.plant.element[j][i] = (struct fopdt){
                .gain = (real_t)gain, .time_constant_s = (real_t)lag, .dead_time_s = (real_t)dead};
            c.work->analysis.plant.gain_sd[j][i] = (real_t)(0.002 * fabs(gain));
        }
    tick_s = 0.05 * pow(10.0, (double)random_below(r, 450) / 100.0); /* to 1600 s */
    analyse(tick_s);
}

static void whatever_is_proposed_is_a_configuration(void)
{
    struct random_source r = {SEED};
    unsigned proposed = 0, decoupled = 0, fed = 0, inner = 0;
    for (int n = 0; n < 200; n++) {
        random_plant(&r);
        config = bench.config;
        if (!commission_has_proposal(&c)) {
            TEST_ASSERT_EQUAL_INT(ERR_STATE, proposal_write(&c, &config));
            TEST_ASSERT_EQUAL_MEMORY(&bench.config, &config, sizeof config);
            continue;
        }
        TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_write(&c, &config));
        builds(&config);
        survives_being_written_down();
        for (uint8_t k = 0; k < c.work->analysis.pairs.n; k++)
            TEST_ASSERT_TRUE(proposal_loop(&c, &config, k) != PLAN_NONE);
        proposed++;
        decoupled += c.work->analysis.decoupler == DECOUPLER_USED;
        fed += config.feedforward[0].from[0] != '\0';
        inner += c.work->analysis.layout.inner_outputs != 0;
    }
    char text[120];
    snprintf(text, sizeof text,
             "200 plants: %u proposals, %u with a decoupler, %u feedforward, %u a cascade",
             proposed, decoupled, fed, inner);
    TEST_MESSAGE(text);
    TEST_ASSERT_TRUE(proposed >= 100 && decoupled >= 10 && fed >= 5 && inner >= 1);
}

/* ---- what was there ---- */

static void settings_come_from_the_design(void)
{
    channels(2, 2);
    simple(2);
    writes();
    for (uint8_t k = 0; k < 2; k++) {
        const struct loop_config *l = &config.loop[proposal_loop(&c, &config, k)];
        const struct tuning *t = &c.work->analysis.loops.tuning[k];
        TEST_ASSERT_EQUAL_FLOAT((float)t->gain, l->own.gain);
        TEST_ASSERT_EQUAL_FLOAT((float)t->ti_s, l->own.ti_s);
        TEST_ASSERT_EQUAL_UINT8(LOOP_REVERSE, l->own.action);
    }
    TEST_ASSERT_EQUAL_STRING("y1", config.loop[0].name);
    TEST_ASSERT_EQUAL_STRING("u1", config.loop[0].out);
}

static void old_loops_on_the_tested_outputs_make_room_with_all_that_hangs_on_them(void)
{
    static const char *const pairs[] = {
        "loop1.name",  "old",       "loop1.pv",     "y2",        "loop1.out",    "u1",
        "loop1.ti",    "50",        "loop2.name",   "outer",     "loop2.pv",     "y1",
        "loop2.out",   "old",       "loop2.ti",     "90",        "loop3.name",   "top",
        "loop3.pv",    "y3",        "loop3.out",    "outer",     "loop3.ti",     "300",
        "ff1.from",    "y3",        "ff1.to",       "u1",        "alarm1.on",    "outer",
        "alarm1.side", "deviation", "alarm1.limit", "5",         "alarm2.on",    "y3",
        "alarm2.side", "hi",        "alarm2.limit", "45",        "loop4.name",   "side",
        "loop4.pv",    "y3",        "loop4.out",    "u3",        "loop4.ti",     "70",
        "alarm3.on",   "side",      "alarm3.side",  "deviation", "alarm3.limit", "4",
        NULL};
    channels(3, 3);
    put_all(pairs);
    builds(&bench.config);
    simple(2); /* y1, y2 by u1, u2: y3 and u3 are not part of it */
    config = before = bench.config;
    TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_write(&c, &config));
    builds(&config);
    TEST_ASSERT_EQUAL_UINT8(PLAN_NONE, config_find_loop(&config, "old"));
    TEST_ASSERT_EQUAL_UINT8(PLAN_NONE, config_find_loop(&config, "outer"));
    TEST_ASSERT_EQUAL_UINT8(PLAN_NONE, config_find_loop(&config, "top"));
    TEST_ASSERT_EQUAL_STRING("", config.feedforward[0].from);
    TEST_ASSERT_EQUAL_STRING("", config.alarm[0].on);
    /* and nothing else does */
    TEST_ASSERT_EQUAL_MEMORY(&before.loop[3], &config.loop[3], sizeof config.loop[3]);
    TEST_ASSERT_EQUAL_STRING("y3", config.alarm[1].on);
    TEST_ASSERT_EQUAL_STRING("side", config.alarm[2].on);
    TEST_ASSERT_EQUAL_MEMORY(before.measurement, config.measurement, sizeof config.measurement);
    TEST_ASSERT_EQUAL_MEMORY(before.mv, config.mv, sizeof config.mv);
}

static void a_skipped_input_keeps_its_loop(void)
{
    static const char *const pairs[] = {"loop1.name", "old",      "loop1.pv", "y1", "loop1.out",
                                        "u2",         "loop1.ti", "50",       NULL};
    channels(2, 2);
    put_all(pairs);
    simple(1);
    c.inputs.n = 2;
    c.inputs.input[1].output = 1;
    c.inputs.input[1].skipped = true;
    writes();
    TEST_ASSERT_EQUAL_STRING("old", config.loop[0].name);
    builds(&config);
}

static void names_that_are_taken_are_not_taken_again(void)
{
    static const char *const pairs[] = {"loop1.name", "y1", "loop1.pv",   "y3",   "loop1.out", "u3",
                                        "loop1.ti",   "70", "loop2.name", "A_u1", "loop2.pv",  "y3",
                                        "loop2.out",  "u4", "loop2.ti",   "70",   NULL};
    channels(3, 4);
    put_all(pairs);
    builds(&bench.config);
    simple(2);
    writes();
    builds(&config);
    uint8_t i = proposal_loop(&c, &config, 0);
    TEST_ASSERT_NOT_EQUAL(PLAN_NONE, i);
    TEST_ASSERT_EQUAL_STRING("B_u1", config.loop[i].name);
}

static void longest_names_are_cut_to_different_ones(void)
{
    static const char *const pairs[] = {"meas1.name", "abcdefghijklmno",
                                        "mv1.name",   "pqrstuvwxyz0123",
                                        "mv2.name",   "pqrstuvwxyz0124",
                                        "meas2.name", "abcdefghijklmnp",
                                        "loop1.name", "abcdefghijklmno",
                                        "loop1.pv",   "y3",
                                        "loop1.out",  "u3",
                                        "loop1.ti",   "50",
                                        "loop2.name", "abcdefghijklmnp",
                                        "loop2.pv",   "y3",
                                        "loop2.out",  "u4",
                                        "loop2.ti",   "50",
                                        NULL};
    channels(3, 4);
    put_all(pairs);
    builds(&bench.config);
    simple(2);
    writes();
    builds(&config);
}

/* The first n loops are others': on u3 and up, the last one on another loop. */
static void taken(unsigned n)
{
    char name[24], value[24];
    channels(9, 16);
    for (unsigned i = 1; i <= n; i++) {
        snprintf(name, sizeof name, "loop%u.name", i);
        snprintf(value, sizeof value, "l%u", i);
        put(name, value);
        snprintf(name, sizeof name, "loop%u.pv", i);
        put(name, "y9");
        snprintf(name, sizeof name, "loop%u.out", i);
        snprintf(value, sizeof value, i == n ? "l1" : "u%u", i + 2);
        put(name, value);
    }
    builds(&bench.config);
}

static void more_loops_than_places_are_refused(void)
{
    taken(CONFIG_LOOPS - 1);
    simple(2);
    config = bench.config;
    TEST_ASSERT_EQUAL_INT(ERR_FULL, proposal_write(&c, &config));
}

static void as_strong_as_two_temperatures_of_a_column(void)
{
    begin(2, 2);
    for (unsigned j = 0; j < 2; j++)
        for (unsigned i = 0; i < 2; i++) {
            c.work->analysis.plant.element[j][i] =
                (struct fopdt){.gain = i == j ? REAL_C(1.0) : REAL_C(0.9),
                               .time_constant_s = 300,
                               .dead_time_s = 30};
            c.work->analysis.plant.gain_sd[j][i] = REAL_C(0.001);
        }
    analyse(1);
    TEST_ASSERT_EQUAL_INT(DECOUPLER_USED, c.work->analysis.decoupler);
}

static void decoupled_loops_take_places_that_the_decoupler_spans(void)
{
    taken(DECOUPLER_MAX - 2);
    as_strong_as_two_temperatures_of_a_column();
    writes();
    builds(&config);
    TEST_ASSERT_EQUAL_UINT8(DECOUPLER_MAX - 2, proposal_loop(&c, &config, 0));
    TEST_ASSERT_EQUAL_UINT8(DECOUPLER_MAX - 1, proposal_loop(&c, &config, 1));
    taken(DECOUPLER_MAX - 1);
    as_strong_as_two_temperatures_of_a_column();
    config = bench.config;
    TEST_ASSERT_EQUAL_INT(ERR_FULL, proposal_write(&c, &config));
}

static void sixteen_loops_are_proposed_without_a_decoupler(void)
{
    channels(16, 16);
    simple(16);
    config = bench.config;
    TEST_ASSERT_EQUAL_INT(DECOUPLER_TOO_MANY, c.work->analysis.decoupler);
    TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_write(&c, &config));
    builds(&config);
    survives_being_written_down();
    for (uint8_t k = 0; k < 16; k++) {
        uint8_t i = proposal_loop(&c, &config, k);
        TEST_ASSERT_NOT_EQUAL(PLAN_NONE, i);
        TEST_ASSERT_EQUAL_UINT8(0, config.loop[i].decouple);
    }
}

static void a_decoupler_leaves_nothing_of_the_old_one_in_its_places(void)
{
    static const char *const pairs[] = {"loop1.name",
                                        "old",
                                        "loop1.pv",
                                        "y1",
                                        "loop1.out",
                                        "u1",
                                        "loop1.ti",
                                        "50",
                                        "loop1.decouple",
                                        "on",
                                        "loop2.name",
                                        "side",
                                        "loop2.pv",
                                        "y3",
                                        "loop2.out",
                                        "u3",
                                        "loop2.ti",
                                        "50",
                                        "loop2.decouple",
                                        "on",
                                        "decouple1.d2",
                                        "0.4",
                                        "decouple2.d1",
                                        "-0.3",
                                        NULL};
    channels(3, 3);
    put_all(pairs);
    builds(&bench.config);
    simple(2);
    writes();
    builds(&config);
    for (uint8_t k = 0; k < 2; k++) {
        uint8_t i = proposal_loop(&c, &config, k);
        TEST_ASSERT_EQUAL_FLOAT(0.0f, config.decoupler[i][1]);
        TEST_ASSERT_EQUAL_FLOAT(0.0f, config.decoupler[1][i]);
        TEST_ASSERT_EQUAL_FLOAT(1.0f, config.decoupler[i][i]);
    }
}

static void other_channels_than_those_tested_get_no_proposal(void)
{
    static const char *const changes[][2] = {
        {"meas1.name", "other"}, {"meas2.hi", "60"}, {"mv1.name", "other"}, {"mv2.lo", "-1"}};
    for (unsigned k = 0; k < 4; k++) {
        channels(2, 2);
        simple(2);
        put(changes[k][0], changes[k][1]);
        config = bench.config;
        TEST_ASSERT_EQUAL_INT(ERR_CONFLICT, proposal_write(&c, &config));
        TEST_ASSERT_EQUAL_MEMORY(&bench.config, &config, sizeof config);
    }
    channels(2, 2);
    simple(2);
    put("mv1.max", "3"); /* where it is operated is another matter */
    put("meas1.hold", "5");
    writes();
}

static void nothing_is_written_without_a_proposal(void)
{
    static const enum commission_phase phases[] = {COMMISSION_IDLE,    COMMISSION_TESTING,
                                                   COMMISSION_FITTING, COMMISSION_TRIAL,
                                                   COMMISSION_KEPT,    COMMISSION_ENDED};
    channels(2, 2);
    simple(2);
    config = bench.config;
    for (unsigned k = 0; k < sizeof phases / sizeof phases[0]; k++) {
        c.status.phase = phases[k];
        TEST_ASSERT_EQUAL_INT(ERR_STATE, proposal_write(&c, &config));
    }
    c.status.phase = COMMISSION_READY;
    c.requests.ask = COMMISSION_ASK_BEGIN; /* it is about to be overwritten */
    TEST_ASSERT_EQUAL_INT(ERR_STATE, proposal_write(&c, &config));
    TEST_ASSERT_EQUAL_MEMORY(&bench.config, &config, sizeof config);
}

/* ---- the trial of it ---- */

static void prepared(double held, double y, double limit)
{
    char value[24];
    channels(2, 2);
    snprintf(value, sizeof value, "%g", limit * 50.0);
    put("meas1.test_limit", value);
    simple(2);
    c.outputs.noise_sd[0] = REAL_C(0.002);
    writes();
    builds(&config);
    memset(&supervisor, 0, sizeof supervisor);
    supervisor.plan = &plan;
    arena_place(&supervisor, &plan);
    supervisor.mv[0].manual = supervisor.mv[1].manual = N(held);
    supervisor.measurement[0].value = supervisor.measurement[1].value = N(y);
    TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_prepare_trial(&c, &supervisor, &config));
}

static void the_step_of_a_trial_stays_inside_limit_and_room(void)
{
    for (double limit = 0.01; limit < 0.5; limit *= 2)
        for (double held = 0.01; held < 1; held += 0.14)
            for (double y = 0.1; y < 1; y += 0.2) {
                prepared(held, y, limit);
                const struct adoption_loop *l = &c.adoption.loop[0];
                double step = fabs((double)l->step),
                       moved = (double)l->predicted.moved / (double)l->size;
                TEST_ASSERT_TRUE(step > 0 && step <= 0.5 * limit + 1e-6);
                TEST_ASSERT_TRUE(step * moved <= fmin(held, 1 - held) + 1e-6);
                TEST_ASSERT_EQUAL(y > 0.5, (double)l->step < 0);
                TEST_ASSERT_DOUBLE_WITHIN(1e-6, limit, (double)c.adoption.channel[0].limit);
            }
}

/* Prepares two outputs and one input, or two inputs of which the second moves both outputs as much. */
static void prepare(void)
{
    writes();
    builds(&config);
    memset(&supervisor, 0, sizeof supervisor);
    supervisor.plan = &plan;
    arena_place(&supervisor, &plan);
    supervisor.mv[0].manual = supervisor.mv[1].manual = N(0.5);
    supervisor.measurement[0].value = supervisor.measurement[1].value = N(0.4);
    TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_prepare_trial(&c, &supervisor, &config));
}

static void a_step_leaves_room_to_the_inputs_of_the_other_loops(void)
{
    static const double gains[2][2] = {{1, 0.9}, {0.9, 1}};
    channels(2, 2);
    begin(2, 2);
    for (unsigned j = 0; j < 2; j++)
        for (unsigned i = 0; i < 2; i++)
            c.work->analysis.plant.element[j][i] = (struct fopdt){
                .gain = (real_t)gains[j][i], .time_constant_s = 300, .dead_time_s = 30};
    analyse(1);
    TEST_ASSERT_TRUE(commission_has_proposal(&c));
    c.outputs.noise_sd[0] = REAL_C(0.1);
    put("meas1.test_limit", "50");
    put("mv2.min", "1.8"); /* 5 % below where it is held */
    prepare();
    const struct analysis *a = &c.work->analysis;
    double step = fabs((double)c.adoption.loop[0].step) / (double)a->config.step;
    TEST_ASSERT_TRUE(a->tried[0].moved[1] > REAL_C(0.01));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.8 * 0.05, step * (double)a->tried[0].moved[1]);
    TEST_ASSERT_TRUE(step * (double)a->tried[0].moved[0] <= 0.4);
}

/* Two loops whose steps, both up, take the inputs apart as far as they can go. */
static void prepare_steps_of(double cross)
{
    channels(2, 2);
    begin(2, 2);
    for (unsigned j = 0; j < 2; j++)
        for (unsigned i = 0; i < 2; i++)
            c.work->analysis.plant.element[j][i] = (struct fopdt){
                .gain = (real_t)(i == j ? 1.0 : cross), .time_constant_s = 300, .dead_time_s = 30};
    analyse(1);
    c.outputs.noise_sd[0] = c.outputs.noise_sd[1] = REAL_C(0.1);
    put("meas1.test_limit", "50");
    put("meas2.test_limit", "50");
    for (unsigned k = 0; k < 2; k++)
        for (unsigned l = 0; l < 2; l++) {
            c.work->analysis.tried[k].moved[l] = 1; /* spans, for a step of a twentieth */
            c.work->analysis.tried[k].input[l] = k == l ? 1 : -1;
        }
    prepare();
}

/* Both inputs of a step of the first loop are still away when that of the second begins: it goes the way that brings them back. */
static void a_step_goes_the_other_way_where_inputs_that_act_alike_have_no_room(void)
{
    prepare_steps_of(0.96);
    TEST_ASSERT_TRUE(c.adoption.loop[0].step > 0 && c.adoption.loop[1].step > 0);
    supervisor.measurement[1].value = N(0.6); /* from there on the second would go down */
    TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_prepare_trial(&c, &supervisor, &config));
    TEST_ASSERT_TRUE(c.adoption.loop[0].step > 0 && c.adoption.loop[1].step > 0);
    supervisor.measurement[1].value = N(0.98); /* not past an end of its span */
    TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_prepare_trial(&c, &supervisor, &config));
    TEST_ASSERT_TRUE(c.adoption.loop[1].step < 0);
}

static void inputs_that_act_apart_come_back_and_no_step_turns(void)
{
    prepare_steps_of(0.9); /* a relative gain of 5 */
    supervisor.measurement[1].value = N(0.6);
    TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_prepare_trial(&c, &supervisor, &config));
    TEST_ASSERT_TRUE(c.adoption.loop[0].step > 0 && c.adoption.loop[1].step < 0);
}

static void a_step_leaves_measurements_that_no_loop_holds_within_their_limits(void)
{
    channels(2, 1);
    begin(2, 1);
    for (unsigned j = 0; j < 2; j++) {
        c.work->analysis.plant.element[j][0] = (struct fopdt){
            .gain = j ? REAL_C(0.5) : REAL_C(1.0), .time_constant_s = 300, .dead_time_s = 30};
        c.work->analysis.plant.gain_sd[j][0] = REAL_C(0.001);
    }
    analyse(1);
    TEST_ASSERT_TRUE(commission_has_proposal(&c));
    put("meas1.test_limit", "25");
    put("meas2.test_limit", "2");
    prepare();
    TEST_ASSERT_EQUAL_UINT8(2, c.adoption.channels);
    TEST_ASSERT_EQUAL_UINT8(1, c.adoption.channel[1].measurement);
    double step = fabs((double)c.adoption.loop[0].step);
    TEST_ASSERT_DOUBLE_WITHIN(3e-3, 0.7 * 0.04, 0.5 * step); /* 2 of 50 */
    put("meas2.test_critical", "on");
    prepare();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.02, (double)c.adoption.channel[1].limit);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5 * step, fabs((double)c.adoption.loop[0].step));
}

static void a_pair_without_a_loop_has_no_trial(void)
{
    prepared(0.5, 0.5, 0.2);
    uint8_t i = proposal_loop(&c, &config, 1);
    strcpy(config.loop[i].pv, "y1");
    TEST_ASSERT_EQUAL_INT(ERR_UNKNOWN, proposal_prepare_trial(&c, &supervisor, &config));
}

int main(void)
{
    printf("seed %u\n", SEED);
    UNITY_BEGIN();
    RUN_TEST(whatever_is_proposed_is_a_configuration);
    RUN_TEST(settings_come_from_the_design);
    RUN_TEST(old_loops_on_the_tested_outputs_make_room_with_all_that_hangs_on_them);
    RUN_TEST(a_skipped_input_keeps_its_loop);
    RUN_TEST(names_that_are_taken_are_not_taken_again);
    RUN_TEST(longest_names_are_cut_to_different_ones);
    RUN_TEST(more_loops_than_places_are_refused);
    RUN_TEST(decoupled_loops_take_places_that_the_decoupler_spans);
    RUN_TEST(sixteen_loops_are_proposed_without_a_decoupler);
    RUN_TEST(a_decoupler_leaves_nothing_of_the_old_one_in_its_places);
    RUN_TEST(other_channels_than_those_tested_get_no_proposal);
    RUN_TEST(nothing_is_written_without_a_proposal);
    RUN_TEST(the_step_of_a_trial_stays_inside_limit_and_room);
    RUN_TEST(a_step_leaves_room_to_the_inputs_of_the_other_loops);
    RUN_TEST(a_step_goes_the_other_way_where_inputs_that_act_alike_have_no_room);
    RUN_TEST(inputs_that_act_apart_come_back_and_no_step_turns);
    RUN_TEST(a_step_leaves_measurements_that_no_loop_holds_within_their_limits);
    RUN_TEST(a_pair_without_a_loop_has_no_trial);
    return UNITY_END();
}

/* commission/commission.c and acceptance.c: requests to a start-up and their results, and how a trial ends. */
#include "commission_outcome.h"

void setUp(void)
{
    outcome_begin();
}
void tearDown(void) {}

/* ---- what is asked for ---- */

static void asked(enum commission_ask ask)
{
    fitted();
    c.status.phase = ask == COMMISSION_ASK_RESUME ? COMMISSION_PAUSED
                     : ask == COMMISSION_ASK_BEGIN || ask == COMMISSION_ASK_RELAY
                         ? COMMISSION_IDLE
                         : COMMISSION_TESTING;
    job_give_up(&c.background.job);
    c.inputs.turn = 1;
    c.inputs.input[0].rounds = 2;
    c.inputs.input[0].skipped = ask == COMMISSION_ASK_REPEAT;
    x->phase = EXPERIMENT_DONE; /* takes no sample: the test ends where it goes on */
    c.outputs.sample_ms = bench.s.time_ms;
    c.requests.relay_serial = bench.s.plan->serial;
    c.requests.ask = (uint8_t)ask;
}

static void nothing_is_put_over_what_the_background_is_at(void)
{
    static const struct {
        enum commission_ask ask;
        bool waits;
    } cases[] = {{COMMISSION_ASK_BEGIN, true},  {COMMISSION_ASK_RELAY, true},
                 {COMMISSION_ASK_RESUME, true}, {COMMISSION_ASK_SKIP, true},
                 {COMMISSION_ASK_REPEAT, true}, {COMMISSION_ASK_PAUSE, false},
                 {COMMISSION_ASK_ABORT, false}};
    for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++)
        for (unsigned working = 0; working < 2; working++) {
            asked(cases[n].ask);
            c.background.job.working = working != 0;
            commission_tick(&c, &bench.s);
            TEST_ASSERT_EQUAL_UINT8(working && cases[n].waits ? cases[n].ask : COMMISSION_ASK_NONE,
                                    c.requests.ask);
        }
}

static void a_test_is_repeated_from_its_first_round(void)
{
    asked(COMMISSION_ASK_REPEAT);
    supervisor_excite(&bench.s, 1, N(0.1));
    commission_tick(&c, &bench.s);
    TEST_ASSERT_EQUAL_UINT8(0, c.inputs.turn);
    TEST_ASSERT_EQUAL_UINT8(0, c.inputs.input[0].rounds);
    TEST_ASSERT_FALSE(c.inputs.input[0].skipped);
    TEST_ASSERT_EQUAL_INT(COMMISSION_TESTING, c.status.phase);
    NEAR(0.0, D(bench.s.mv[1].excitation));
    TEST_ASSERT_TRUE(bench.s.testing);
    asked(COMMISSION_ASK_REPEAT);
    c.inputs.turn = 0; /* there is none before it */
    x->phase = EXPERIMENT_REST;
    TEST_ASSERT_EQUAL_INT(
        ERR_OK, experiment_begin(x, &(struct experiment_config){.outputs = 2,
                                                                .h_s = 2,
                                                                .window = 40,
                                                                .noise_floor = REAL_C(1e-4),
                                                                .amplitude = REAL_C(0.1),
                                                                .amplitude_max = REAL_C(0.1),
                                                                .noise_multiple = 20,
                                                                .half_most = 100,
                                                                .limit = {1, 1}}));
    commission_tick(&c, &bench.s);
    TEST_ASSERT_EQUAL_UINT8(2, c.inputs.input[0].rounds);
    TEST_ASSERT_EQUAL_UINT8(COMMISSION_ASK_NONE, c.requests.ask);
}

static void an_input_is_skipped_and_the_next_one_tested(void)
{
    asked(COMMISSION_ASK_SKIP);
    c.inputs.turn = 0;
    supervisor_excite(&bench.s, 0, N(0.1));
    commission_tick(&c, &bench.s);
    TEST_ASSERT_TRUE(c.inputs.input[0].skipped);
    TEST_ASSERT_EQUAL_UINT8(1, c.inputs.turn);
    NEAR(0.0, D(bench.s.mv[0].excitation));
}

static void a_pause_gives_the_outputs_back(void)
{
    asked(COMMISSION_ASK_PAUSE);
    supervisor_excite(&bench.s, 1, N(0.1));
    has_done(TASK_INTERIM_FIT);
    bench.s.time_ms = 44000;
    commission_tick(&c, &bench.s);
    TEST_ASSERT_EQUAL_INT(COMMISSION_PAUSED, c.status.phase);
    TEST_ASSERT_FALSE(job_is_asked(&c.background.job));
    TEST_ASSERT_EQUAL_UINT64(44000, c.status.phase_ms);
    NEAR(0.0, D(bench.s.mv[1].excitation));
    TEST_ASSERT_TRUE(bench.s.testing);
    c.requests.ask = COMMISSION_ASK_RESUME;
    commission_tick(&c, &bench.s);
    TEST_ASSERT_EQUAL_INT(COMMISSION_TESTING, c.status.phase);
    c.requests.ask = COMMISSION_ASK_ABORT;
    bench.s.time_ms += 1000;
    commission_tick(&c, &bench.s);
    TEST_ASSERT_EQUAL_INT(COMMISSION_ENDED, c.status.phase);
    TEST_ASSERT_EQUAL_INT(REASON_ASKED, c.status.reason);
    TEST_ASSERT_EQUAL_UINT64(45000, c.status.ended_ms);
    TEST_ASSERT_FALSE(bench.s.testing);
}

static void an_end_puts_the_outputs_back_unless_somebody_else_decides(void)
{
    static const struct {
        enum commission_reason reason;
        bool back;
    } cases[] = {{REASON_LOST, true},  {REASON_HAND, false}, {REASON_CONFIG, false},
                 {REASON_SAFE, false}, {REASON_ASKED, true}, {REASON_INTERLOCK, true}};
    for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++)
        for (unsigned trial = 0; trial < 2; trial++) {
            fitted();
            c.status.phase = trial ? COMMISSION_TRIAL : COMMISSION_TESTING;
            bench.s.mv[0].manual = bench.s.mv[1].manual = N(0.75);
            supervisor_excite(&bench.s, 1, N(0.1));
            commission_end(&c, &bench.s, cases[n].reason, "a name that is longer than",
                           REAL_C(0.125));
            TEST_ASSERT_EQUAL_INT(COMMISSION_ENDED, c.status.phase);
            TEST_ASSERT_EQUAL_UINT(CHANNEL_NAME_SIZE - 1, strlen(c.status.subject));
            NEAR(0.0, D(bench.s.mv[1].excitation));
            for (unsigned k = 0; k < 2; k++)
                NEAR(cases[n].back && !trial ? 0.5 : 0.75, D(bench.s.mv[k].manual));
            TEST_ASSERT_FALSE(job_is_asked(&c.background.job));
            NEAR(0.125, said(trial ? EVENT_TRIAL_FAILED : EVENT_COMMISSION_ENDED)->value);
            commission_end(&c, &bench.s, REASON_ASKED, "T1", 0); /* nothing is left of the first */
            TEST_ASSERT_EACH_EQUAL_UINT8(0, c.status.subject + 2, CHANNEL_NAME_SIZE - 2);
        }
}

static void what_may_be_asked_depends_on_the_phase(void)
{
    static const struct {
        enum commission_ask ask;
        unsigned phases; /* bits */
    } cases[] = {{COMMISSION_ASK_BEGIN, 1u << COMMISSION_IDLE | 1u << COMMISSION_READY |
                                            1u << COMMISSION_KEPT | 1u << COMMISSION_RETURNED |
                                            1u << COMMISSION_ENDED},
                 {COMMISSION_ASK_RELAY, 1u << COMMISSION_IDLE | 1u << COMMISSION_READY |
                                            1u << COMMISSION_KEPT | 1u << COMMISSION_RETURNED |
                                            1u << COMMISSION_ENDED},
                 {COMMISSION_ASK_PAUSE, 1u << COMMISSION_TESTING | 1u << COMMISSION_RELAY},
                 {COMMISSION_ASK_SKIP, 1u << COMMISSION_TESTING},
                 {COMMISSION_ASK_RESUME, 1u << COMMISSION_PAUSED},
                 {COMMISSION_ASK_REPEAT, 1u << COMMISSION_TESTING},
                 {COMMISSION_ASK_ABORT, 1u << COMMISSION_TESTING | 1u << COMMISSION_RELAY |
                                            1u << COMMISSION_FITTING | 1u << COMMISSION_ANALYSING |
                                            1u << COMMISSION_PAUSED | 1u << COMMISSION_TRIAL},
                 {COMMISSION_ASK_TRIAL, 1u << COMMISSION_READY},
                 {COMMISSION_ASK_REJECT, 1u << COMMISSION_READY}};
    c.inputs.turn = 1;
    c.work->analysis.designed = true;
    for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++)
        for (unsigned old = 0; old < 2; old++)
            for (unsigned phase = 0; phase <= COMMISSION_ENDED; phase++) {
                const char *wanted = NULL;
                bool held = old && (cases[n].ask == COMMISSION_ASK_BEGIN ||
                                    cases[n].ask == COMMISSION_ASK_RELAY ||
                                    cases[n].ask == COMMISSION_ASK_TRIAL);
                c.status.phase = (enum commission_phase)phase;
                c.requests.old_wanted = old != 0;
                TEST_ASSERT_EQUAL_INT(cases[n].phases >> phase & !held ? ERR_OK : ERR_STATE,
                                      commission_may(&c, cases[n].ask, &wanted));
                TEST_ASSERT_NOT_NULL(wanted);
                if (phase == COMMISSION_READY && cases[n].ask == COMMISSION_ASK_BEGIN)
                    TEST_ASSERT_EQUAL(old, strncmp(wanted, "the old settings", 16) == 0);
            }
    c.status.phase = COMMISSION_READY;
    c.work->analysis.designed = false;
    const char *wanted;
    TEST_ASSERT_EQUAL_INT(ERR_STATE, commission_may(&c, COMMISSION_ASK_TRIAL, &wanted));
}

static void a_proposal_is_rejected(void)
{
    c.status.phase = COMMISSION_READY;
    c.requests.ask = COMMISSION_ASK_REJECT;
    commission_tick(&c, &bench.s);
    TEST_ASSERT_EQUAL_INT(COMMISSION_IDLE, c.status.phase);
    TEST_ASSERT_FALSE(bench.s.testing);
}

static void a_trial_waits_for_its_plan(void)
{
    for (unsigned later = 0; later < 2; later++) {
        fitted();
        c.status.phase = COMMISSION_READY;
        c.work->analysis.designed = true;
        c.requests.ask = COMMISSION_ASK_TRIAL;
        c.requests.trial_serial = bench.s.plan->serial + later;
        commission_tick(&c, &bench.s);
        TEST_ASSERT_EQUAL_UINT8(later ? COMMISSION_ASK_TRIAL : COMMISSION_ASK_NONE, c.requests.ask);
        TEST_ASSERT_EQUAL(!later, c.status.phase != COMMISSION_READY);
    }
}

static void a_piece_of_work_that_was_given_up_ends_no_other(void)
{
    fitted();
    c.background.job.done = false;
    struct jobs jobs = jobs_of_it();
    c.model.output = c.outputs.n; /* nothing is left to be fitted */
    TEST_ASSERT_TRUE(jobs_work(&jobs));
    TEST_ASSERT_TRUE(c.background.job.done);
    TEST_ASSERT_FALSE(c.background.job.working);
    TEST_ASSERT_FALSE(jobs_work(&jobs));
    job_give_up(&c.background.job);
    c.background.job.done = false;
    TEST_ASSERT_FALSE(jobs_work(&jobs));
    TEST_ASSERT_FALSE(c.background.job.done);
}

static void one_thing_at_a_time_is_asked(void)
{
    const char *wanted = NULL;
    fitted();
    c.status.phase = COMMISSION_TESTING;
    c.inputs.turn = 0;
    TEST_ASSERT_EQUAL_INT(ERR_STATE, commission_put(&c, COMMISSION_ASK_REPEAT, &wanted));
    c.inputs.turn = 1;
    TEST_ASSERT_EQUAL_INT(ERR_OK, commission_put(&c, COMMISSION_ASK_REPEAT, &wanted));
    wanted = NULL;
    TEST_ASSERT_EQUAL_INT(ERR_BUSY, commission_put(&c, COMMISSION_ASK_PAUSE, &wanted));
    TEST_ASSERT_NOT_NULL(wanted);
    TEST_ASSERT_EQUAL_UINT8(COMMISSION_ASK_REPEAT, c.requests.ask);
    TEST_ASSERT_EQUAL_INT(ERR_OK, commission_put(&c, COMMISSION_ASK_ABORT, &wanted));
    TEST_ASSERT_EQUAL_UINT8(COMMISSION_ASK_ABORT, c.requests.ask);
    static const enum commission_ask begins[] = {COMMISSION_ASK_BEGIN, COMMISSION_ASK_RELAY,
                                                 COMMISSION_ASK_TRIAL};
    for (unsigned n = 0; n < 3; n++) { /* what has not begun needs no end */
        fitted();
        c.status.phase = COMMISSION_READY;
        c.status.analysed = true;
        c.requests.ask = (uint8_t)begins[n];
        TEST_ASSERT_EQUAL(n == 2, commission_has_results(&c));
        TEST_ASSERT_EQUAL_INT(ERR_OK, commission_put(&c, COMMISSION_ASK_ABORT, &wanted));
        TEST_ASSERT_EQUAL_UINT8(COMMISSION_ASK_NONE, c.requests.ask);
        TEST_ASSERT_EQUAL(n == 2, c.requests.old_wanted);
        TEST_ASSERT_TRUE(commission_has_results(&c));
    }
    TEST_ASSERT_EQUAL_STRING("", commission_reason_text(REASON_COUNT));
    TEST_ASSERT_EQUAL_STRING("asked for", commission_reason_text(REASON_ASKED));
}

static void a_reset_in_the_midst_of_it_is_told(void)
{
    commission_was_reset(&c);
    TEST_ASSERT_EQUAL_INT(COMMISSION_ENDED, c.status.phase);
    TEST_ASSERT_EQUAL_INT(REASON_RESET, c.status.reason);
    TEST_ASSERT_EQUAL_UINT8(REASON_RESET, said(EVENT_COMMISSION_ENDED)->detail);
    NEAR(0.0, said(EVENT_COMMISSION_ENDED)->value);
    TEST_ASSERT_EQUAL_UINT64(0, said(EVENT_COMMISSION_ENDED)->time_ms);
}

/* ---- on trial ---- */

/* One loop of two measurements, accepted. */
static void accepted(void)
{
    struct adoption *a = &c.adoption;
    fitted();
    commission_lease(&c);
    c.status.phase = COMMISSION_READY;
    c.requests.trial_serial = bench.s.plan->serial;
    a->n = 1;
    a->channels = 2;
    a->window = 48;
    a->back = 50;
    a->loop[0] = (struct adoption_loop){
        .loop = TOP, .step = REAL_C(0.05), .size = REAL_C(0.05), .duration_s = 100};
    a->loop[1].loop = BOTTOM;
    a->channel[0] = (struct adoption_channel){.limit = REAL_C(0.2)};
    a->channel[1] = (struct adoption_channel){.measurement = T5, .output = 1, .limit = REAL_C(0.2)};
}

static void a_trial_goes_on_from_the_operating_point_of_the_tests(void)
{
    accepted();
    c.origin.fixed = true;
    c.outputs.sample_ms = bench.s.time_ms - 3000;
    c.outputs.plan_serial = 0;
    c.outputs.safe_count = 99;
    c.status.reason = REASON_LOST;
    commission_begin_trial(&c, &bench.s);
    TEST_ASSERT_EQUAL_INT(COMMISSION_TRIAL, c.status.phase);
    TEST_ASSERT_EQUAL_INT(REASON_NOT, c.status.reason);
    NEAR(3.0, c.origin.since_s);
    TEST_ASSERT_EQUAL_PTR(&c.origin, c.adoption.origin);
    TEST_ASSERT_EQUAL_UINT64(bench.s.time_ms, c.status.phase_ms);
    NEAR(0.5, c.adoption.loop[0].test_base);
    NEAR(1.0, said(EVENT_TRIAL_BEGUN)->value);
    TEST_ASSERT_EQUAL_UINT32(bench.s.plan->serial, c.outputs.plan_serial);
    TEST_ASSERT_EQUAL_UINT32(bench.s.safe_count, c.outputs.safe_count);
    accepted();
    c.adoption.window = 1;
    commission_begin_trial(&c, &bench.s);
    TEST_ASSERT_EQUAL_INT(COMMISSION_RETURNED, c.status.phase);
    TEST_ASSERT_EQUAL_INT(REASON_NUMBERS, c.status.reason);
    TEST_ASSERT_TRUE(c.requests.old_wanted);
    accepted();
    c.requests.trial_serial++; /* another plan came in between */
    commission_begin_trial(&c, &bench.s);
    TEST_ASSERT_EQUAL_INT(COMMISSION_ENDED, c.status.phase);
    TEST_ASSERT_EQUAL_INT(REASON_CONFIG, c.status.reason);
    TEST_ASSERT_FALSE(c.requests.old_wanted);
}

/* On its way, and measurement `far` of the trial far off. */
static void strays(unsigned far)
{
    accepted();
    commission_begin_trial(&c, &bench.s);
    bench_forget_events();
    c.adoption.stage = 1; /* in automatic, nothing asked yet */
    c.adoption.stage_ticks = 100;
    c.adoption.channel[0].line.rest =
        (real_t)(D(bench.s.measurement[T1].value) + (far == 0 ? 0.3 : 0));
    c.adoption.channel[1].line.rest =
        (real_t)(D(bench.s.measurement[T5].value) + (far == 1 ? 0.3 : 0));
    c.adoption.loop[0].peak = REAL_C(0.4);
    commission_acceptance(&c, &bench.s);
}

static void what_fails_on_trial_is_named_by_its_loop_or_its_measurement(void)
{
    strays(2);
    TEST_ASSERT_EQUAL_INT(COMMISSION_TRIAL, c.status.phase);
    strays(0);
    TEST_ASSERT_EQUAL_INT(COMMISSION_RETURNED, c.status.phase);
    TEST_ASSERT_EQUAL_INT(REASON_TRIAL_LIMIT, c.status.reason);
    TEST_ASSERT_EQUAL_STRING("top", c.status.subject);
    NEAR(0.4, c.status.value);
    strays(1);
    TEST_ASSERT_EQUAL_INT(REASON_TRIAL_LIMIT, c.status.reason);
    TEST_ASSERT_EQUAL_STRING("T5", c.status.subject);
    NEAR(0.0, c.status.value);
}

static void a_trial_that_has_passed_is_kept(void)
{
    accepted();
    commission_begin_trial(&c, &bench.s);
    c.adoption.stage = 1;
    c.adoption.stage_ticks = 1;
    c.adoption.turn = 1;
    c.adoption.channel[0].line.rest = (real_t)D(bench.s.measurement[T1].value);
    c.adoption.channel[1].line.rest = (real_t)D(bench.s.measurement[T5].value);
    bench.s.time_ms = 55000;
    commission_acceptance(&c, &bench.s);
    TEST_ASSERT_EQUAL_INT(COMMISSION_KEPT, c.status.phase);
    TEST_ASSERT_EQUAL_UINT64(55000, c.status.ended_ms);
    NEAR(1.0, said(EVENT_TRIAL_KEPT)->value);
}

static void what_is_not_for_the_trial_to_judge_ends_it(void)
{
    for (unsigned n = 0; n < 4; n++) {
        accepted();
        commission_begin_trial(&c, &bench.s);
        c.outputs.measurement[0] = T5;
        if (n == 0)
            bench.s.safe_count++;
        else if (n == 1)
            c.outputs.ends_again = 1;
        else if (n == 2)
            c.outputs.plan_serial++;
        TEST_ASSERT_EQUAL(n < 3, commission_acceptance_is_disturbed(&c, &bench.s));
        TEST_ASSERT_EQUAL_INT(n == 3   ? COMMISSION_TRIAL
                              : n == 2 ? COMMISSION_ENDED
                                       : COMMISSION_RETURNED,
                              c.status.phase);
        TEST_ASSERT_EQUAL_INT(n == 0   ? REASON_SAFE
                              : n == 1 ? REASON_SPAN
                              : n == 2 ? REASON_CONFIG
                                       : REASON_NOT,
                              c.status.reason);
        TEST_ASSERT_EQUAL_STRING(n == 1 ? "T5" : "", c.status.subject);
        TEST_ASSERT_EQUAL(n < 2, c.requests.old_wanted);
        NEAR(0.0, c.status.value);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(nothing_is_put_over_what_the_background_is_at);
    RUN_TEST(a_test_is_repeated_from_its_first_round);
    RUN_TEST(an_input_is_skipped_and_the_next_one_tested);
    RUN_TEST(a_pause_gives_the_outputs_back);
    RUN_TEST(an_end_puts_the_outputs_back_unless_somebody_else_decides);
    RUN_TEST(what_may_be_asked_depends_on_the_phase);
    RUN_TEST(a_proposal_is_rejected);
    RUN_TEST(a_trial_waits_for_its_plan);
    RUN_TEST(a_piece_of_work_that_was_given_up_ends_no_other);
    RUN_TEST(one_thing_at_a_time_is_asked);
    RUN_TEST(a_reset_in_the_midst_of_it_is_told);
    RUN_TEST(a_trial_goes_on_from_the_operating_point_of_the_tests);
    RUN_TEST(what_fails_on_trial_is_named_by_its_loop_or_its_measurement);
    RUN_TEST(a_trial_that_has_passed_is_kept);
    RUN_TEST(what_is_not_for_the_trial_to_judge_ends_it);
    return UNITY_END();
}

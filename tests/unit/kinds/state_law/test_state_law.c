/* The kind `state_law` on the pilot column, against matrices in long double and a law in double precision (tests/reference/state_law_reference.py).
 * Contract, in float: matrices within 1e-4 of the largest element, of A and what inputs see of that of the row, weights of F, G and Tf within 2e-3 of the largest of theirs. */
#include "state_law_bench.h"

void setUp(void)
{
    bench_pilot();
}

void tearDown(void)
{
    workspace_share(NULL);
}

/* ---- matrices ---- */

/* by_row: of the largest element of the row; else of the matrix. */
static double worst_of(const char *what, const struct matrix *m, bool by_row)
{
    double worst = 0, off = 0, most = 0;
    for (unsigned i = 0; i < m->rows; i++) {
        double wanted[16];
        reference(what, i, wanted, m->cols);
        if (by_row)
            off = most = 0;
        for (unsigned k = 0; k < m->cols; k++) {
            most = fmax(most, fabs(wanted[k]));
            off = fmax(off, fabs(wanted[k] - (double)m->value[i][k]));
        }
        if (by_row)
            worst = fmax(worst, off / most);
    }
    worst = by_row ? worst : off / most;
    printf("%s: within %.2e of the largest element of %s\n", what, worst,
           by_row ? "its row" : "all");
    return worst;
}

static void matrices_are_those_of_differences_in_long_double(void)
{
    static struct state_law_column job;
    by_feed();
    state_law_column_begin(&job, &settings, setup.input, setup.inputs, &record);
    while (job.phase < STATE_LAW_COLUMN_LAW)
        (void)state_law_column_piece(&job);
    TEST_ASSERT_EQUAL(STATE_LAW_PHASE_SAMPLE, job.job.phase);
    TEST_ASSERT_TRUE(worst_of("a", &job.job.plant.a, true) < 1e-4);
    TEST_ASSERT_TRUE(worst_of("b", &job.job.plant.b, false) < 1e-4);
    job.job.seen.rows = 6;
    TEST_ASSERT_TRUE(worst_of("seen", &job.job.seen, true) < 1e-4);
    job.job.plant.e.cols = 1; /* its second is by mole here, there by mass */
    TEST_ASSERT_TRUE(worst_of("e", &job.job.plant.e, false) < 1e-4);
}

/* Next to either end of its range a feed's quality is moved by less. Beside differences of 1e-3: rates are linear in it. */
static void the_feeds_quality_is_looked_at_as_far_as_there_is_room(void)
{
    static const float quality[] = {0.01f, 0.9f, 1.99f}, heat[] = {190, 600, 1080}; /* W */
    static struct state_law_column job;
    for (unsigned q = 0; q < 3; q++) {
        bench_pilot();
        change_record(&record, COLUMN_TABLE_FEED_BASIS, COLUMN_FLOW_MOLAR);
        change_record(&record, COLUMN_TABLE_FEED, 0.0144f); /* mol/s */
        change_record(&record, COLUMN_TABLE_HEAT, heat[q]);
        change_record(&record, COLUMN_TABLE_FEED_BY, COLUMN_FEED_QUALITY);
        change_record(&record, COLUMN_TABLE_FEED_STATE, quality[q]);
        no_inputs();
        six_states();
        input_is(STATE_LAW_FEED_QUALITY, 0, 0, (struct block_signal){0, 2, false});
        mvs_are();
        state_law_column_begin(&job, &settings, setup.input, setup.inputs, &record);
        while (job.phase < STATE_LAW_COLUMN_LAW)
            (void)state_law_column_piece(&job);
        TEST_ASSERT_EQUAL_MESSAGE(STATE_LAW_PHASE_SAMPLE, job.job.phase, job.job.found.wanted);
        struct state_law_linear *l = &job.linear;
        real_t rates[2][STATE_MODEL_STATES] = {{0}};
        double most = 0, off = 0;
        for (unsigned k = 0; k < 2; k++) {
            struct column_inputs in = l->table.nominal;
            struct column_fault wrong;
            in.feed_quality += k ? REAL_C(1e-3) : REAL_C(-1e-3);
            TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&l->column, &in, &wrong));
            TEST_ASSERT_EQUAL(ERR_OK, column_rates(&l->column, l->x, rates[k]));
        }
        for (unsigned i = 0; i < l->plant->e.rows; i++) {
            double slope = (double)(rates[1][i] - rates[0][i]) / 2e-3 * 2;
            most = fmax(most, fabs(slope));
            off = fmax(off, fabs(slope - (double)l->plant->e.value[i][0]));
        }
        printf("quality %.2f: within %.2e of the largest\n", (double)quality[q], off / most);
        TEST_ASSERT_TRUE(off < 1e-2 * most);
    }
}

/* ---- the law ---- */

static void law_is(const char *what, unsigned inputs)
{
    double wanted[8], off = 0, most = 0;
    char name[40];
    for (unsigned i = 0; i < 2; i++) {
        snprintf(name, sizeof name, "f_%s", what);
        reference(name, i, wanted, inputs);
        for (unsigned k = 0; k < inputs; k++) {
            most = fmax(most, fabs(wanted[k]));
            off = fmax(off, fabs(wanted[k] - (double)block()->found.f[i][k]));
        }
        snprintf(name, sizeof name, "g_%s", what);
        reference(name, i, wanted, 2);
        for (unsigned k = 0; k < 2; k++) {
            most = fmax(most, fabs(wanted[k]));
            off = fmax(off, fabs(wanted[k] - (double)block()->found.g[i][k]));
        }
    }
    printf("%s: weights within %.2e of the largest, radius %.5f, by inputs %.5f, left %.3f %%, %u "
           "pieces\n",
           what, off / most, (double)shown("radius"), (double)shown("radius_by_inputs"),
           (double)shown("left_of_F"), pieces);
    TEST_ASSERT_TRUE(off < 2e-3 * most);
}

static void the_law_of_the_pilot_column_is_that_in_double_precision(void)
{
    configure(false);
    design();
    TEST_ASSERT_EQUAL_MESSAGE(STATE_LAW_DONE, block()->stage, told());
    law_is("temperatures", 8);
    TEST_ASSERT_EQUAL_FLOAT(0, shown("index_1"));
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0.59343f, shown("K_star_1"));
    TEST_ASSERT_FLOAT_WITHIN(0.02f, 8.53f, shown("condition"));
    TEST_ASSERT_EQUAL_FLOAT(10, shown("zeros"));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.8631f, shown("outermost_zero"));
}

static void the_law_with_the_feed_measured_has_its_columns(void)
{
    by_feed();
    configure(false);
    design();
    TEST_ASSERT_EQUAL_MESSAGE(STATE_LAW_DONE, block()->stage, told());
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.75f, block()->found.f[0][6]);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.86667f, block()->found.f[1][6]);
    law_is("feed", 7);
}

/* ---- what becomes of it ---- */

static const struct block_parameter *parameter_of(uint32_t id)
{
    for (unsigned i = 0; i < kind->parameters; i++)
        if (proposed_own(kind->parameter[i].id) == id)
            return &kind->parameter[i];
    TEST_FAIL_MESSAGE("a parameter that is not there");
    return NULL;
}

static void adopt(void)
{
    for (unsigned k = 0; k < proposal.n; k++) {
        const struct block_parameter *p = parameter_of(proposal.value[k].id);
        memcpy((uint8_t *)&settings + p->offset, &proposal.value[k].value, sizeof(float));
    }
    configure(true);
}

static void it_is_handed_over_whole(void)
{
    configure(false);
    design();
    step(true);
    TEST_ASSERT_EQUAL(PROPOSAL_WHEN_ACCEPTED, proposal.manner);
    adopt();
    TEST_ASSERT_EQUAL_FLOAT(PERIOD_S, settings.made_s);
    TEST_ASSERT_EQUAL_MEMORY(block()->found.f, settings.f, sizeof settings.f);
    TEST_ASSERT_EQUAL_MEMORY(block()->found.g, settings.g, sizeof settings.g);
    design(); /* once more: the same */
    step(true);
    TEST_ASSERT_EQUAL(0, proposal.n);
}

static void another_law_takes_its_place(void)
{
    configure(false);
    design();
    step(true);
    adopt();
    settings.tau_s[0] = settings.tau_s[1] = 60;
    configure(true);
    design();
    step(true);
    adopt();
    TEST_ASSERT_EQUAL_FLOAT(PERIOD_S, settings.made_s);
    TEST_ASSERT_EQUAL_MEMORY(block()->found.f, settings.f, sizeof settings.f);
}

static void what_is_rejected_is_not_proposed_again(void)
{
    configure(false);
    design();
    step(true);
    TEST_ASSERT_TRUE(proposal.n > 0);
    for (unsigned k = 0; k < 3; k++) {
        step(true);
        TEST_ASSERT_EQUAL(0, proposal.n);
    }
}

static void it_waits_for_room_for_a_proposal(void)
{
    settings.adopt = STATE_LAW_AT_ONCE;
    configure(false);
    design();
    for (unsigned k = 0; k < 10; k++)
        step(false);
    step(true);
    TEST_ASSERT_TRUE(proposal.n > 0);
    TEST_ASSERT_EQUAL(PROPOSAL_AT_ONCE, proposal.manner);
}

static void it_tells_once_what_came_of_it(void)
{
    unsigned made = 0;
    configure(false);
    TEST_ASSERT_NULL(tell("design"));
    for (unsigned k = 0; k < 10; k++) {
        step(false);
        made += io.requests.raised == 1u << STATE_LAW_EVENT_MADE ? 1u : 0u;
    }
    TEST_ASSERT_EQUAL(1, made);
    TEST_ASSERT_EQUAL_FLOAT(shown("radius"), event_value[STATE_LAW_EVENT_MADE]);
}

/* ---- a model that is known already ---- */

/* y(k + 1) = A y + B u, two outputs: F = B^-1 (M0 - A), G = B^-1 (1 - M0). */
static void a_model_of_first_order_has_the_law_of_its_matrices(void)
{
    static struct state_law_job job;
    static struct state_model plant;
    const double a[2] = {0.9, 0.8}, b[2][2] = {{0.2, -0.1}, {0.05, 0.3}}, pole = exp(-0.9);
    double det = b[0][0] * b[1][1] - b[0][1] * b[1][0];
    double inverse[2][2] = {{b[1][1] / det, -b[0][1] / det}, {-b[1][0] / det, b[0][0] / det}};
    memset(&plant, 0, sizeof plant);
    plant.period_s = PERIOD_S;
    plant.a.rows = plant.a.cols = plant.b.rows = plant.b.cols = plant.c.rows = plant.c.cols = 2;
    for (unsigned i = 0; i < 2; i++) {
        plant.a.value[i][i] = (real_t)a[i];
        plant.c.value[i][i] = REAL_C(1.0);
        for (unsigned j = 0; j < 2; j++)
            plant.b.value[i][j] = (real_t)b[i][j];
    }
    state_law_job_of_model(&job, &settings, 2);
    job.sampled = plant;
    while (state_law_job_piece(&job)) {
    }
    TEST_ASSERT_EQUAL_STRING("", job.found.field);
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, inverse[i][j] * (pole - a[j]),
                                      (double)job.found.f[i][j]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, inverse[i][j] * (1 - pole), (double)job.found.g[i][j]);
        }
    TEST_ASSERT_EQUAL_FLOAT(job.found.radius, job.found.inputs_radius);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(matrices_are_those_of_differences_in_long_double);
    RUN_TEST(the_feeds_quality_is_looked_at_as_far_as_there_is_room);
    RUN_TEST(the_law_of_the_pilot_column_is_that_in_double_precision);
    RUN_TEST(the_law_with_the_feed_measured_has_its_columns);
    RUN_TEST(it_is_handed_over_whole);
    RUN_TEST(another_law_takes_its_place);
    RUN_TEST(what_is_rejected_is_not_proposed_again);
    RUN_TEST(it_waits_for_room_for_a_proposal);
    RUN_TEST(it_tells_once_what_came_of_it);
    RUN_TEST(a_model_of_first_order_has_the_law_of_its_matrices);
    return UNITY_END();
}

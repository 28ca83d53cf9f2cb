/* Steps of the estimators of compositions, against what the head of composition.c says of them. */
#include "composition_bench.h"

#include "model/column_inside.h"

void setUp(void)
{
    bench_pilot();
}

void tearDown(void) {}

/* Temperatures at the reboiler, the feed stage, a tray and the condenser, all of which move the model. */
static void everywhere(void)
{
    static const unsigned stage[] = {1, 5, 8, 12};
    for (unsigned k = 0; k < 4; k++)
        temperature_at(FURTHER + k, stage[k], 1);
    setup.inputs += 4;
}

/* The splitter with truncated stages, two fractions of a stage integrated. */
static void bench_splitter(void)
{
    static const float nominal[] = {0.0245f, 4.81514e6f, 0.017116666f};
    bench_pilot();
    PUT_RECORD(&record, splitter_values);
    temperature_at(T_LOW, 1, 2);
    temperature_at(T_HIGH, 36, 1);
    temperature_at(T_COMPARED, 19, 0);
    for (unsigned k = FEED; k <= REFLUX; k++) {
        all_settings.s.si[k][UNIT_FACTOR] = 0;
        setup.input[k] = (struct block_signal){0, 2 * nominal[k - FEED], k == HEAT};
        put(k, nominal[k - FEED]);
    }
    point_of(TOP_FRACTION, 37, 2);
    point_of(BOTTOM_FRACTION, 1, 3);
    point_of(INNER_TEMPERATURE, 10, 0); /* a truncated one */
}

static void slopes(const struct composition_block *c, size_t s, const real_t *x, real_t *dt,
                   real_t *dy)
{
    size_t n = c->model.table.config.components;
    real_t full[COLUMN_COMPONENTS_MAX];
    column_full_composition(&c->model.column, x, s, full);
    vle_full_slopes(&c->model.column.vle, c->model.column.temperature[s], full,
                    &c->model.column.k[s * n], &c->model.column.dk[s * n], dt, dy);
}

/* ---- geometric ---- */

static void draws_as_said(void)
{
    static struct column_blocks wanted;
    static struct composition_block before;
    struct column_pull pull[SENSORS_MAX];
    real_t t[SENSORS_MAX];
    struct composition_block *c = &block;
    size_t pulls = 0, m = c->model.table.config.components - 1;
    for (uint8_t k = 0; k < c->sensors.n; k++) {
        c->sensors.sensor[k].present = true;
        c->sensors.sensor[k].sum = (real_t)k * 40 - 60;
        t[k] = truth(c->sensors.sensor[k].stage + 1u) + (k % 2 ? 1.0f : -0.5f);
    }
    c->model.inputs.heat += 200; /* the model moves as well */
    before = *c;
    TEST_ASSERT_EQUAL(ERR_OK, whole_step(c, t));
    real_t h = setup.interval_s;
    for (uint8_t k = 0; k < c->sensors.n; k++) {
        unsigned input_of = before.sensors.sensor[k].input;
        real_t lambda =
            (all_settings.tune[input_of][TUNE_LAMBDA] > 0 ? all_settings.tune[input_of][0] : 10);
        real_t zeta =
            all_settings.tune[input_of][TUNE_ZETA] > 0 ? all_settings.tune[input_of][1] : 3;
        lambda /= 3600;
        real_t e = t[k] - c->model.column.temperature[before.sensors.sensor[k].stage];
        if (all_settings.s.place[input_of][OF_COMPONENT] == 0)
            continue;
        pull[pulls++] =
            (struct column_pull){.stage = all_settings.s.place[input_of][AT_STAGE] - 1u,
                                 .component = all_settings.s.place[input_of][OF_COMPONENT] - 1u,
                                 .deviation = e,
                                 .gain = 2 * zeta * lambda + h * lambda * lambda,
                                 .rate = lambda * lambda * before.sensors.sensor[k].sum};
    }
    static real_t x[COLUMN_STATES_MAX];
    memcpy(x, before.model.x, sizeof x);
    for (size_t i = 0; i < c->model.column.n_fractions; i++)
        if (c->model.truncated[i / m] && i % m == m - 1)
            x[i] = c->model.x[i] - c->model.blocks.change[i];
    TEST_ASSERT_EQUAL(ERR_OK, column_implicit_step(&c->model.column, c->model.truncated, x,
                                                   c->model.rates, h, pull, pulls, &wanted));
    for (size_t i = 0; i < c->model.column.n_fractions; i++)
        TEST_ASSERT_FLOAT_WITHIN(2e-6f, wanted.change[i], c->model.blocks.change[i]);
    for (uint8_t k = 0; k < c->sensors.n; k++) {
        real_t dt[COLUMN_COMPONENTS_MAX], dy[16], left = c->sensors.sensor[k].e;
        if (!before.sensors.sensor[k].moves)
            continue;
        slopes(c, c->sensors.sensor[k].stage, x, dt, dy);
        for (size_t j = 0; j < m; j++)
            left -= dt[j] * wanted.change[c->sensors.sensor[k].stage * m + j];
        TEST_ASSERT_FLOAT_WITHIN(2e-2f, before.sensors.sensor[k].sum + h * left,
                                 c->sensors.sensor[k].sum);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f * fabsf(dt[c->sensors.sensor[k].component]),
                                 dt[c->sensors.sensor[k].component], c->sensors.sensor[k].slope);
        TEST_ASSERT_FLOAT_WITHIN(1e-5f,
                                 (c->sensors.sensor[k].kp + h * c->sensors.sensor[k].ki) * left +
                                     c->sensors.sensor[k].ki * before.sensors.sensor[k].sum,
                                 c->sensors.sensor[k].correction);
    }
}

static void the_geometric_estimator_draws_within_the_step(void)
{
    all_settings.tune[T_HIGH][TUNE_LAMBDA] = 25;
    all_settings.tune[T_HIGH][TUNE_ZETA] = 1.5f;
    everywhere();
    begin();
    draws_as_said();
}

static void of_several_components_it_moves_the_one_that_is_named(void)
{
    bench_splitter();
    begin();
    step();
    plant_temperatures();
    draws_as_said();
}

static void an_integral_rests_where_its_fraction_is_at_a_limit(void)
{
    real_t t[SENSORS_MAX];
    temperature_at(T_HIGH, 12, 1);
    begin();
    for (unsigned n = 0; n < 2; n++) {
        struct composition_sensor *s = &block.sensors.sensor[1];
        block.model.x[11] = 0.9999f;
        measure();
        for (uint8_t k = 0; k < 3; k++) {
            block.sensors.sensor[k].present = true;
            t[k] = truth(block.sensors.sensor[k].stage + 1u);
        }
        t[1] -= 20; /* no fraction is so light */
        s->sum = n ? 50.0f : -50.0f;
        TEST_ASSERT_EQUAL(ERR_OK, whole_step(&block, t));
        TEST_ASSERT_TRUE(block.model.clipped > 0);
        TEST_ASSERT_EQUAL_FLOAT(1, block.model.x[11]);
        if (n)
            TEST_ASSERT_TRUE(s->sum < 50.0f); /* on its way back it goes on */
        else
            TEST_ASSERT_EQUAL_FLOAT(-50, s->sum);
    }
}

static void an_integral_moves_a_temperature_by_so_many_kelvin_in_its_time_at_most(void)
{
    all_settings.tune[T_LOW][TUNE_LAMBDA] = 1;
    begin();
    real_t most = 100 * 3600.0f; /* 100 K in 1/lambda: ki z = 100 lambda */
    for (int n = -1; n <= 1; n += 2) {
        block.sensors.sensor[0].sum = (real_t)n * 1e8f;
        begin();
        block.sensors.sensor[0].sum = (real_t)n * 1.01f * most;
        step();
        TEST_ASSERT_FLOAT_WITHIN(1.0f, (float)n * most, block.sensors.sensor[0].sum);
    }
}

/* ---- reduced filter ---- */

/* The rate of the light fraction of a stage by itself, by differences, flows and the vapour from below held. */
static double own_derivative(const struct composition_block *c, const real_t *x, size_t s)
{
    const struct column *column = &c->model.column;
    size_t top = c->model.table.config.stages - 1;
    real_t dt[COLUMN_COMPONENTS_MAX], dy[16];
    slopes(c, s, x, dt, dy);
    double in = s < top ? (double)column->liquid[s + 1] : 0, out = (double)column->vapour_flow[s];
    if (s > 0)
        in += (double)column->vapour_flow[s - 1];
    if (s == 4)
        in += (double)column->flows.feed;
    double e = s == 0 || s == top ? 1 : (double)c->model.table.config.efficiency;
    /* d/dx of in (c_in - x) - out (v - x), v = below + E (y - below) */
    return (-in - out * (e * (double)dy[0] - 1)) / (double)column->holdup[s];
}

static void filters_as_said(float interval)
{
    static struct composition_block before;
    real_t t[SENSORS_MAX];
    struct composition_block *c = &block;
    bench_pilot();
    everywhere();
    all_settings.s.method = METHOD_REKF;
    all_settings.noise = 0.3f;
    all_settings.model = 0.2f;
    setup.interval_s = interval;
    begin();
    for (uint8_t k = 0; k < c->sensors.n; k++) {
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.04f, c->sensors.sensor[k].variance);
        c->sensors.sensor[k].variance = (interval < 1 ? 1e-7f : 1e-4f) * (real_t)(k + 1);
        c->sensors.sensor[k].present = k != 1;
        t[k] = truth(c->sensors.sensor[k].stage + 1u) + (k % 2 ? -0.25f : 0.5f);
    }
    c->model.inputs.heat += 200; /* the model moves as well */
    before = *c;
    TEST_ASSERT_EQUAL(ERR_OK, whole_step(c, t));
    static struct column_blocks alone;
    TEST_ASSERT_EQUAL(ERR_OK,
                      column_implicit_step(&c->model.column, c->model.truncated, before.model.x,
                                           c->model.rates, interval, NULL, 0, &alone));
    for (uint8_t k = 0; k < c->sensors.n; k++) {
        const struct composition_sensor *s = &c->sensors.sensor[k];
        if (!s->moves)
            continue;
        real_t dt[COLUMN_COMPONENTS_MAX], dy[16];
        slopes(c, s->stage, before.model.x, dt, dy);
        double f = own_derivative(c, before.model.x, s->stage), b = (double)dt[0];
        double q = 0.04 / 3600, part = exp(2 * f * (double)interval);
        double p = (double)before.sensors.sensor[k].variance * part + q * (part - 1) / (2 * f);
        double spread = b * p * b + 0.09, gain = p * b / spread;
        TEST_ASSERT_DOUBLE_WITHIN(spread * 1e-3, spread, (double)s->spread);
        double e = (double)(t[k] - c->model.column.temperature[s->stage]) -
                   b * (double)alone.change[s->stage];
        double moved = (double)(c->model.blocks.change[s->stage] - alone.change[s->stage]);
        if (!before.sensors.sensor[k].present) {
            TEST_ASSERT_DOUBLE_WITHIN(p * 1e-3, p, (double)s->variance);
            TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0, moved);
            continue;
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, e, (double)s->e);
        TEST_ASSERT_DOUBLE_WITHIN(fabs(gain * e) * 2e-2 + 1e-7, gain * e, moved);
        TEST_ASSERT_DOUBLE_WITHIN(p * 1e-3, (1 - gain * b) * p, (double)s->variance);
        TEST_ASSERT_DOUBLE_WITHIN(fabs(b * gain * e) / (double)interval * 2e-2 + 1e-6,
                                  b * gain * e / (double)interval, (double)s->correction);
    }
}

static void the_reduced_filter_corrects_by_its_variance(void)
{
    filters_as_said(10);
    filters_as_said(300);
}

static void its_variance_grows_as_well_over_very_short_steps(void)
{
    filters_as_said(0.01f);
}

/* A model that may drift as fast as can be said, readings that are as good as can be said. */
static void a_variance_is_never_below_nothing(void)
{
    all_settings.s.method = METHOD_REKF;
    all_settings.noise = 0.001f;
    all_settings.model = 100;
    setup.interval_s = 60;
    begin();
    for (unsigned n = 0; n < 300; n++) {
        put(T_LOW, truth(3) + (float)(n % 7) - 3);
        put(T_HIGH, truth(10) + (float)(n % 5) - 2);
        step();
        TEST_ASSERT_TRUE(block.sensors.sensor[0].variance > 0);
        TEST_ASSERT_TRUE(block.sensors.sensor[1].variance > 0);
    }
}

/* ---- truncated stages ---- */

static void a_truncated_temperature_is_between_those_around_it(void)
{
    for (unsigned mean = 0; mean < 2; mean++) {
        bench_splitter();
        all_settings.s.between = (uint8_t)mean;
        begin();
        put(T_LOW, truth(1) + 5); /* whatever the step moves */
        step();
        float low = (float)block.model.column.temperature[0];
        float high = (float)block.model.column.temperature[15];
        float part = mean ? 0.5f : 9.0f / 15;
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, low + part * (high - low), given(INNER_TEMPERATURE));
        TEST_ASSERT_EQUAL_FLOAT(57, shown("states"));
    }
}

static void the_splitter_stays_where_its_readings_are_those_of_its_model(void)
{
    bench_splitter();
    begin();
    plant_runs(3000);
    steps(3000);
    TEST_ASSERT_FLOAT_WITHIN(3e-3f,
                             (float)column_fraction(&plant.model.column, plant.model.x, 36, 1),
                             given(TOP_FRACTION));
    TEST_ASSERT_FLOAT_WITHIN(3e-3f,
                             (float)column_fraction(&plant.model.column, plant.model.x, 0, 2),
                             given(BOTTOM_FRACTION));
}

/* ---- extremes ---- */

static void a_state_of_numbers_within_limits(void)
{
    size_t m = block.model.table.config.components - 1;
    for (size_t s = 0; s < block.model.table.config.stages; s++) {
        float sum = 0;
        for (size_t j = 0; j < m; j++) {
            float x = (float)block.model.x[s * m + j];
            TEST_ASSERT_TRUE(x >= 0);
            sum += x;
        }
        TEST_ASSERT_TRUE(sum <= 1.00001f);
    }
    for (unsigned k = 0; k < setup.points; k++)
        TEST_ASSERT_TRUE(float_is_finite(num_to_float(point[k])));
    for (uint8_t k = 0; k < block.sensors.n; k++) {
        TEST_ASSERT_TRUE(float_is_finite((float)block.sensors.sensor[k].sum));
        TEST_ASSERT_TRUE(float_is_finite((float)block.watch.sensor[k].square));
    }
}

static void any_readings_leave_fractions_within_limits(bool splitter,
                                                       enum composition_method method)
{
    static const float kelvin[] = {200, 600, 300, 360, 400, 250, 500};
    static const float flow[] = {0, 1e6f, 1e-6f, 1, 1e-3f};
    if (splitter)
        bench_splitter();
    else
        bench_pilot();
    all_settings.s.method = (uint8_t)method;
    all_settings.gate = 0;
    for (unsigned k = 0; k < FURTHER; k++) {
        all_settings.s.si[k][UNIT_FACTOR] = 0;
        setup.input[k] = (struct block_signal){0, k < FEED ? 600.0f : 1e6f, false};
    }
    begin();
    for (unsigned n = 0; n < 700; n++) {
        for (unsigned k = 0; k < FEED; k++) {
            put(k, kelvin[(n / 7 + 3 * k) % 7]);
            quality[k] = n % 11 == k ? QUALITY_BAD : QUALITY_GOOD;
        }
        for (unsigned k = FEED; k < FURTHER; k++)
            put(k, flow[(n / (5 * (k - 2)) + k) % 5]);
        step();
        a_state_of_numbers_within_limits();
    }
}

static void at_any_reading_the_geometric_estimator_stays_within_limits(void)
{
    any_readings_leave_fractions_within_limits(false, METHOD_GEOMETRIC);
    any_readings_leave_fractions_within_limits(true, METHOD_GEOMETRIC);
}

static void at_any_reading_the_reduced_filter_stays_within_limits(void)
{
    any_readings_leave_fractions_within_limits(false, METHOD_REKF);
    any_readings_leave_fractions_within_limits(true, METHOD_REKF);
}

static void at_any_interval_and_gain_it_stays_within_limits(void)
{
    static const float interval[] = {0.001f, 1, 60, 3600, 1e5f}, lambda[] = {1e-3f, 10, 1e4f};
    for (unsigned k = 0; k < 15; k++) {
        setUp();
        setup.interval_s = interval[k / 3];
        all_settings.tune[T_LOW][TUNE_LAMBDA] = all_settings.tune[T_HIGH][TUNE_LAMBDA] =
            lambda[k % 3];
        all_settings.s.method = (uint8_t)(k % 2);
        begin();
        for (unsigned n = 0; n < 100; n++) {
            put(T_LOW, n % 20 < 10 ? 320 : 400);
            put(T_HIGH, n % 30 < 10 ? 390 : 340);
            step();
            a_state_of_numbers_within_limits();
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_geometric_estimator_draws_within_the_step);
    RUN_TEST(of_several_components_it_moves_the_one_that_is_named);
    RUN_TEST(an_integral_rests_where_its_fraction_is_at_a_limit);
    RUN_TEST(an_integral_moves_a_temperature_by_so_many_kelvin_in_its_time_at_most);
    RUN_TEST(the_reduced_filter_corrects_by_its_variance);
    RUN_TEST(its_variance_grows_as_well_over_very_short_steps);
    RUN_TEST(a_variance_is_never_below_nothing);
    RUN_TEST(a_truncated_temperature_is_between_those_around_it);
    RUN_TEST(the_splitter_stays_where_its_readings_are_those_of_its_model);
    RUN_TEST(at_any_reading_the_geometric_estimator_stays_within_limits);
    RUN_TEST(at_any_reading_the_reduced_filter_stays_within_limits);
    RUN_TEST(at_any_interval_and_gain_it_stays_within_limits);
    return UNITY_END();
}

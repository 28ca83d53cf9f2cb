/* identify/relay.[ch].
 *
 * Contract (both scalar types), on the plants of reference/relay.csv: one to three lags and dead time, exactly sampled
 *   fine samples (1/400 of the period), no noise, against the exact limit cycle
 *       period 1 %, peak 2 %, gain by the describing function 2 %, gain by the first harmonic 2 %
 *   coarse samples (1/25 of the period), no noise
 *       gain 3 % of -1/Re G of the sampled process at the period found
 *   noise with a deviation of 1/20 of the amplitude, hysteresis three times that, 200 seeds
 *       median of the gain within 5 %, 95 % of the seeds within 20 %, of what the same test finds without noise
 *   load of 0.6 of the relay's amplitude, drift of 0.05 of it in a period
 *       gain within 8 % and 10 % of the one without
 */
#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "csv.h"
#include "identify/common.h"
#include "identify/relay.h"
#include "step_records.h"
#include "unity.h"

#define PI_    3.14159265358979323846
#define DELAYS 20000
#define REST   0.4

/* Lags in parallel, each held exactly; dead time between whole samples by splitting the held input. */
struct process {
    double lag[3], part[3], state[3], h, gain;
    int lags, whole;
    double rest_part; /* of a sample: dead time beyond the whole ones */
    double past[DELAYS];
    int newest;
    double load, drift; /* at the input, once it has come; of the output, a sample */
    long load_at;       /* sample */
    long samples;
};

static void process_init(struct process *p, const double *lags, double dead, double h)
{
    memset(p, 0, sizeof *p);
    p->h = h;
    p->gain = 1.0;
    for (int i = 0; i < 3; i++)
        if (lags[i] > 0.0)
            p->lag[p->lags++] = lags[i];
    for (int i = 0; i < p->lags; i++) {
        p->part[i] = 1.0;
        for (int j = 0; j < p->lags; j++)
            if (j != i)
                p->part[i] *= p->lag[i] / (p->lag[i] - p->lag[j]);
    }
    p->whole = (int)(dead / h);
    p->rest_part = dead / h - p->whole;
    if (p->whole + 2 >= DELAYS)
        abort();
}

/* Output at the end of a sample with input u. */
static double process_step(struct process *p, double u)
{
    double y = REST + p->drift * (double)++p->samples;
    p->past[p->newest] = p->samples > p->load_at ? u + p->load : u;
    double newer = p->past[(p->newest + DELAYS - p->whole) % DELAYS];
    double older = p->past[(p->newest + DELAYS - p->whole - 1) % DELAYS];
    p->newest = (p->newest + 1) % DELAYS;
    for (int i = 0; i < p->lags; i++) {
        double first = exp(-p->rest_part * p->h / p->lag[i]);
        double second = exp(-(1.0 - p->rest_part) * p->h / p->lag[i]);
        p->state[i] = older + (p->state[i] - older) * first;
        p->state[i] = newer + (p->state[i] - newer) * second;
        y += p->gain * p->part[i] * p->state[i];
    }
    return y;
}

/* Response of the sampled process at a frequency. */
static double complex process_response(const struct process *p, double w)
{
    double complex z = cexp(I * w * p->h), g = 0.0;
    for (int i = 0; i < p->lags; i++) {
        double first = exp(-p->rest_part * p->h / p->lag[i]);
        double second = exp(-(1.0 - p->rest_part) * p->h / p->lag[i]);
        g += p->gain * p->part[i] * ((1.0 - second) + (1.0 - first) * second / z) /
             (z - first * second);
    }
    return g * cpow(z, -p->whole);
}

static struct relay_config config_of(double h, double hysteresis)
{
    return (struct relay_config){.h_s = (real_t)h,
                                 .sign = 1,
                                 .reference = (real_t)REST,
                                 .noise_sd = (real_t)1e-6,
                                 .hysteresis = (real_t)hysteresis,
                                 .amplitude = (real_t)0.1,
                                 .first = (real_t)0.02,
                                 .most = (real_t)0.3,
                                 .wanted = (real_t)0.01,
                                 .patience = 100,
                                 .half_most = 100000};
}

static struct relay relay;

/* Until it is done or has failed; noise NULL: none. */
static void run(struct process *p, const struct relay_config *c, double noise,
                struct random_source *source)
{
    double y = REST;
    TEST_ASSERT_EQUAL_INT(ERR_OK, relay_begin(&relay, c));
    for (long n = 0; n < 3000000 && relay.phase < RELAY_DONE; n++) {
        real_t seen = (real_t)(y + (source ? noise * normal(source) : 0.0));
        TEST_ASSERT_EQUAL_INT(ERR_OK, relay_step(&relay, seen, 0));
        TEST_ASSERT_TRUE(real_abs(relay.level) <= c->most + (real_t)1e-6);
        y = process_step(p, (double)relay.level);
    }
    TEST_ASSERT_TRUE_MESSAGE(relay.phase >= RELAY_DONE, "neither done nor failed");
    TEST_ASSERT_TRUE(relay.level == 0);
}

static struct relay_result found(struct process *p, const struct relay_config *c, double noise,
                                 struct random_source *source)
{
    struct relay_result r;
    run(p, c, noise, source);
    TEST_ASSERT_EQUAL_INT(RELAY_FINE, relay.failure);
    TEST_ASSERT_EQUAL_INT(ERR_OK, relay_look(&relay, &r));
    return r;
}

void setUp(void) {}
void tearDown(void) {}

static void within(double share, double want, real_t got, const char *what)
{
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(share * fabs(want), want, (double)got, what);
}

static void each_row(void (*check)(const double *row))
{
    FILE *f = csv_open("reference/relay.csv");
    double row[12];
    int rows = 0;
    for (; csv_row(f, row, 12); rows++)
        check(row);
    fclose(f);
    TEST_ASSERT_EQUAL_INT(18, rows);
}

static struct process process;

static void check_cycle(const double *row)
{
    process_init(&process, row, row[3], row[6] / 400.0);
    struct relay_config c = config_of(process.h, row[5]);
    struct relay_result r = found(&process, &c, 0.0, NULL);
    within(0.01, row[6], r.period_s, "period");
    within(0.02, row[7], r.peak, "peak");
    within(0.02, row[8], r.described, "by the describing function");
    within(0.02, row[9], r.gain, "by the first harmonic");
    within(1e-6, 0.1, r.amplitude, "amplitude");
    TEST_ASSERT_TRUE(r.spread < (real_t)0.03);
}

static void the_limit_cycle_is_the_exact_one_and_both_gains_are_its_own(void)
{
    each_row(check_cycle);
}

static void check_coarse(const double *row)
{
    if (row[5] > 0.001)
        return;
    process_init(&process, row, row[3], row[6] / 25.0);
    struct relay_config c = config_of(process.h, row[5]);
    struct relay_result r = found(&process, &c, 0.0, NULL);
    double complex g = process_response(&process, 2.0 * PI_ / (double)r.period_s);
    within(0.03, -1.0 / creal(g), r.gain, "of the sampled process");
}

static void with_coarse_samples_the_gain_is_that_of_the_sampled_process(void)
{
    each_row(check_coarse);
}

static void the_harmonic_is_nearer_to_the_true_ultimate_gain_than_the_describing_function(void)
{
    FILE *f = csv_open("reference/relay.csv");
    double row[12], harmonic = 0.0, described = 0.0;
    while (csv_row(f, row, 12)) {
        if (row[5] > 0.001 || row[1] > 0.0) /* first order: no sine */
            continue;
        process_init(&process, row, row[3], row[6] / 400.0);
        struct relay_config c = config_of(process.h, row[5]);
        struct relay_result r = found(&process, &c, 0.0, NULL);
        harmonic = fmax(harmonic, fabs((double)r.gain / row[10] - 1.0));
        described = fmax(described, fabs((double)r.described / row[10] - 1.0));
    }
    fclose(f);
    printf("relay: ultimate gain of first order and dead time, worst error %.1f %% by the first "
           "harmonic, %.1f %% by the "
           "describing function\n",
           100.0 * harmonic, 100.0 * described);
    TEST_ASSERT_TRUE(harmonic < 0.06);
    TEST_ASSERT_TRUE(described > 0.15);
}

static void a_process_of_negative_gain_is_the_same_upside_down(void)
{
    const double lags[3] = {10.0, 4.0, 0.0};
    process_init(&process, lags, 6.0, 0.5);
    struct relay_config c = config_of(0.5, 0.0005);
    struct relay_result up = found(&process, &c, 0.0, NULL);
    process_init(&process, lags, 6.0, 0.5);
    process.gain = -1.0;
    c.sign = -1;
    struct relay_result down = found(&process, &c, 0.0, NULL);
    TEST_ASSERT_TRUE(up.gain > 0 && up.described > 0);
    within(0.01, -(double)up.gain, down.gain, "gain");
    within(0.01, (double)up.period_s, down.period_s, "period");
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

#define SEEDS 200

static void noise_scatters_the_gain_and_does_not_move_it(void)
{
    const double lags[3] = {10.0, 4.0, 0.0};
    struct random_source source = {20261121u};
    double error[SEEDS];
    process_init(&process, lags, 6.0, 1.0);
    double noise = 0.043 / 20.0;
    struct relay_config c = config_of(1.0, 3.0 * noise);
    c.noise_sd = (real_t)noise;
    struct relay_result quiet = found(&process, &c, 0.0, NULL);
    int failed = 0;
    for (int i = 0; i < SEEDS; i++) {
        process_init(&process, lags, 6.0, 1.0);
        run(&process, &c, noise, &source);
        struct relay_result r;
        if (relay_look(&relay, &r) == ERR_OK)
            error[i - failed] = (double)r.gain / (double)quiet.gain - 1.0;
        else
            failed++;
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, failed, "seed 20261121");
    qsort(error, SEEDS, sizeof error[0], ascending);
    printf("relay: noise of 1/20 of the amplitude, gain: median %+.1f %%, 5 %% %+.1f %%, 95 %% "
           "%+.1f %%\n",
           100.0 * error[SEEDS / 2], 100.0 * error[SEEDS / 20], 100.0 * error[SEEDS - SEEDS / 20]);
    TEST_ASSERT_TRUE(fabs(error[SEEDS / 2]) < 0.05);
    TEST_ASSERT_TRUE(error[SEEDS / 40] > -0.20 && error[SEEDS - SEEDS / 40] < 0.20);
}

static void a_load_is_met_by_the_bias_and_a_drift_followed(void)
{
    const double lags[3] = {10.0, 4.0, 0.0};
    struct relay_config c = config_of(0.5, 0.0005);
    process_init(&process, lags, 6.0, 0.5);
    struct relay_result quiet = found(&process, &c, 0.0, NULL);
    for (int side = -1; side <= 1; side += 2) {
        process_init(&process, lags, 6.0, 0.5);
        process.load = 0.06 * side;
        process.load_at = 100;
        struct relay_result r = found(&process, &c, 0.0, NULL);
        within(0.08, (double)quiet.gain, r.gain, "gain under load");
        within(0.08, (double)quiet.period_s, r.period_s, "period under load");
        TEST_ASSERT_DOUBLE_WITHIN(0.02, -process.load, (double)r.bias);
        process_init(&process, lags, 6.0, 0.5);
        process.drift = 0.005 * side * 0.5 / (double)quiet.period_s;
        r = found(&process, &c, 0.0, NULL);
        within(0.10, (double)quiet.gain, r.gain, "gain under drift");
    }
}

static void an_amplitude_is_found_that_the_output_answers_to(void)
{
    const double lags[3] = {10.0, 4.0, 0.0};
    struct relay_config c = config_of(0.5, 0.002);
    c.amplitude = 0;
    c.first = (real_t)0.002; /* not even out of the hysteresis */
    c.wanted = (real_t)0.02;
    process_init(&process, lags, 6.0, 0.5);
    struct relay_result r = found(&process, &c, 0.0, NULL);
    TEST_ASSERT_TRUE(r.peak >= (real_t)0.018 && r.peak < (real_t)0.05);
    within(0.08, 3.14, r.gain, "gain");
}

static void a_limit_keeps_the_amplitude_that_is_to_be_found_small(void)
{
    const double lags[3] = {10.0, 4.0, 0.0};
    struct relay_config c = config_of(0.5, 0.001);
    c.amplitude = 0;
    c.wanted = (real_t)0.1;
    process_init(&process, lags, 6.0, 0.5);
    double y = REST, limit = 0.03, worst = 0.0;
    TEST_ASSERT_EQUAL_INT(ERR_OK, relay_begin(&relay, &c));
    for (int n = 0; n < 10000 && relay.phase < RELAY_DONE; n++) {
        double share = fabs(y - REST) / limit;
        worst = fmax(worst, share);
        TEST_ASSERT_EQUAL_INT(ERR_OK, relay_step(&relay, (real_t)y, (real_t)share));
        y = process_step(&process, (double)relay.level);
    }
    TEST_ASSERT_EQUAL_INT(RELAY_DONE, relay.phase);
    TEST_ASSERT_TRUE(worst < 1.0 && worst > 0.4);
}

static void without_an_answer_it_gives_up(void)
{
    const double lags[3] = {10.0, 0.0, 0.0};
    struct relay_config c = config_of(0.5, 0.001);
    for (int found_by_trying = 0; found_by_trying < 2; found_by_trying++) {
        c.amplitude = found_by_trying ? 0 : (real_t)0.1;
        process_init(&process, lags, 1.0, 0.5);
        process.gain = 1e-4;
        c.half_most = 500;
        run(&process, &c, 0.0, NULL);
        TEST_ASSERT_EQUAL_INT(RELAY_FAILED, relay.phase);
        TEST_ASSERT_EQUAL_INT(RELAY_NO_ANSWER, relay.failure);
        struct relay_result r;
        TEST_ASSERT_EQUAL_INT(ERR_EMPTY, relay_look(&relay, &r));
    }
}

/* Samples until it ended. */
static unsigned long wrong_sign(const struct relay_config *c)
{
    run(&process, c, 0.0, NULL);
    TEST_ASSERT_EQUAL_INT(RELAY_FAILED, relay.phase);
    TEST_ASSERT_EQUAL_INT(RELAY_WRONG_SIGN, relay.failure);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)relay.level);
    return (unsigned long)process.samples;
}

static void the_wrong_sign_is_told_from_its_answer(void)
{
    const double lags[3] = {10.0, 4.0, 0.0};
    for (int found_by_trying = 0; found_by_trying < 2; found_by_trying++) {
        struct relay_config c = config_of(0.5, 0.001);
        c.sign = -1;
        c.amplitude = found_by_trying ? 0 : (real_t)0.1;
        process_init(&process, lags, 6.0, 0.5);
        TEST_ASSERT_TRUE(wrong_sign(&c) < 300);
    }
}

static void no_step_of_the_wrong_sign_grows_while_a_slow_output_goes_away(void)
{
    const double lags[3] = {1000.0, 4.0, 0.0};
    struct relay_config c = config_of(0.5, 0.001);
    c.sign = -1;
    c.amplitude = 0;
    process_init(&process, lags, 6.0, 0.5);
    process.gain = 4;
    TEST_ASSERT_TRUE(wrong_sign(&c) < 1000);
    TEST_ASSERT_EQUAL_FLOAT((float)c.first, (float)relay.amplitude);
}

/* Noise, or a drift that turns, may have begun the cycle. */
static void the_wrong_sign_is_told_too_where_the_output_left_the_right_way(void)
{
    const double lags[3] = {1000.0, 4.0, 0.0};
    struct relay_config c = config_of(0.5, 0.001);
    c.sign = -1;
    c.amplitude = 0;
    process_init(&process, lags, 6.0, 0.5);
    process.gain = 4;
    TEST_ASSERT_EQUAL_INT(ERR_OK, relay_begin(&relay, &c));
    double y = REST;
    for (int n = 0; n < 2000 && relay.phase < RELAY_DONE; n++) {
        TEST_ASSERT_EQUAL_INT(ERR_OK, relay_step(&relay, (real_t)(n < 2 ? y + 0.002 : y), 0));
        y = process_step(&process, (double)relay.level);
    }
    TEST_ASSERT_EQUAL_INT(RELAY_WRONG_SIGN, relay.failure);
}

/* It goes the wrong way for longer than the patience, and only a larger amplitude is stronger. */
static void a_load_against_the_relay_is_no_wrong_sign(void)
{
    const double lags[3] = {40.0, 4.0, 0.0};
    struct relay_config c = config_of(0.5, 0.001);
    c.amplitude = 0;
    for (int side = -1; side <= 1; side += 2) {
        process_init(&process, lags, 6.0, 0.5);
        process.load = 0.05 * side;
        run(&process, &c, 0.0, NULL);
        TEST_ASSERT_EQUAL_INT(RELAY_DONE, relay.phase);
        TEST_ASSERT_TRUE(relay.amplitude > c.first);
    }
}

static void an_inverse_response_does_not_confuse_it(void)
{
    /* two lags of opposite gains: the wrong way first */
    const double fast[3] = {2.0, 0.0, 0.0}, slow[3] = {10.0, 0.0, 0.0};
    struct process other;
    struct relay_config c = config_of(0.2, 0.0005);
    process_init(&process, slow, 0.0, 0.2);
    process_init(&other, fast, 0.0, 0.2);
    other.gain = -0.5;
    double y = REST;
    TEST_ASSERT_EQUAL_INT(ERR_OK, relay_begin(&relay, &c));
    for (int n = 0; n < 10000 && relay.phase < RELAY_DONE; n++) {
        TEST_ASSERT_EQUAL_INT(ERR_OK, relay_step(&relay, (real_t)y, 0));
        y = process_step(&process, (double)relay.level) +
            process_step(&other, (double)relay.level) - REST;
    }
    struct relay_result r;
    TEST_ASSERT_EQUAL_INT(ERR_OK, relay_look(&relay, &r));
    double w = 2.0 * PI_ / (double)r.period_s;
    double complex g = process_response(&process, w) + process_response(&other, w);
    within(0.03, -1.0 / creal(g), r.gain, "gain");
}

static void an_output_that_does_not_come_back_ends_it_in_time(void)
{
    const double lags[3] = {10.0, 0.0, 0.0};
    struct relay_config c = config_of(0.5, 0.001);
    c.half_most = 500;
    process_init(&process, lags, 1.0, 0.5);
    process.load = 0.5; /* more than the relay can do */
    run(&process, &c, 0.0, NULL);
    TEST_ASSERT_EQUAL_INT(RELAY_STUCK, relay.failure);
    /* once a period is known, in a few of them */
    c.half_most = 100000;
    process_init(&process, lags, 3.0, 0.5);
    double y = REST;
    int n = 0, later = 0;
    TEST_ASSERT_EQUAL_INT(ERR_OK, relay_begin(&relay, &c));
    for (; n < 100000 && relay.phase < RELAY_DONE; n++) {
        process.load = relay.periods > 0 ? 0.5 : 0.0;
        later += relay.periods > 0;
        TEST_ASSERT_EQUAL_INT(ERR_OK, relay_step(&relay, (real_t)y, 0));
        y = process_step(&process, (double)relay.level);
    }
    TEST_ASSERT_EQUAL_INT(RELAY_STUCK, relay.failure);
    TEST_ASSERT_TRUE(later < 200);
}

static void pure_noise_ends(void)
{
    struct random_source source = {7u};
    struct relay_config c = config_of(1.0, 0.003);
    c.noise_sd = (real_t)0.003; /* the hysteresis is far too narrow for it */
    const double lags[3] = {10.0, 0.0, 0.0};
    process_init(&process, lags, 1.0, 1.0);
    process.gain = 0.0;
    run(&process, &c, 0.003, &source);
    struct relay_result r;
    if (relay.phase == RELAY_DONE)
        TEST_ASSERT_TRUE(relay_look(&relay, &r) == ERR_RANGE || r.spread > (real_t)0.1);
}

static void samples_that_are_lost_do_not_change_the_outcome_much(void)
{
    const double lags[3] = {10.0, 4.0, 0.0};
    struct relay_config c = config_of(0.5, 0.0005);
    process_init(&process, lags, 6.0, 0.5);
    struct relay_result quiet = found(&process, &c, 0.0, NULL);
    process_init(&process, lags, 6.0, 0.5);
    double y = REST;
    TEST_ASSERT_EQUAL_INT(ERR_OK, relay_begin(&relay, &c));
    TEST_ASSERT_EQUAL_INT(ERR_STATE, relay_missed(&relay));
    for (int n = 0; n < 10000 && relay.phase < RELAY_DONE; n++) {
        if (n > 0 && n % 17 == 0)
            TEST_ASSERT_EQUAL_INT(ERR_OK, relay_missed(&relay));
        else
            TEST_ASSERT_EQUAL_INT(ERR_OK, relay_step(&relay, (real_t)y, 0));
        y = process_step(&process, (double)relay.level);
    }
    struct relay_result r;
    TEST_ASSERT_EQUAL_INT(ERR_OK, relay_look(&relay, &r));
    within(0.05, (double)quiet.gain, r.gain, "gain");
    within(0.03, (double)quiet.period_s, r.period_s, "period");
    TEST_ASSERT_EQUAL_INT(ERR_STATE, relay_missed(&relay));
}

/* A sample alone is noise, or a jump of the sensor. */
static void it_takes_two_samples_in_a_row_for_an_answer(void)
{
    struct relay_config c = {.h_s = 1,
                             .sign = 1,
                             .hysteresis = (real_t)0.01,
                             .amplitude = (real_t)0.1,
                             .first = (real_t)0.1,
                             .most = (real_t)0.3,
                             .wanted = (real_t)0.05,
                             .patience = 100,
                             .half_most = 1000};
    TEST_ASSERT_EQUAL_INT(ERR_OK, relay_begin(&relay, &c));
    for (int k = 0; k < 5; k++)
        for (int n = 0; n < 2; n++) {
            TEST_ASSERT_EQUAL_INT(ERR_OK, relay_step(&relay, n ? (real_t)0.02 : ZERO, 0));
            TEST_ASSERT_EQUAL_INT(RELAY_START, relay.phase);
        }
    TEST_ASSERT_EQUAL_INT(ERR_OK, relay_step(&relay, (real_t)0.02, 0));
    TEST_ASSERT_EQUAL_INT(RELAY_CYCLE, relay.phase);
}

static void what_is_no_number_is_refused(void)
{
    const real_t bad[] = {(real_t)NAN, (real_t)INFINITY, -(real_t)INFINITY};
    for (unsigned i = 0; i < 3; i++) {
        struct relay_config c = config_of(1.0, 0.001);
        real_t *field[] = {&c.h_s,   &c.reference, &c.noise_sd, &c.hysteresis,
                           &c.first, &c.amplitude, &c.most,     &c.wanted};
        for (unsigned k = 0; k < sizeof field / sizeof field[0]; k++) {
            real_t keep = *field[k];
            *field[k] = bad[i];
            TEST_ASSERT_NOT_EQUAL_INT(ERR_OK, relay_begin(&relay, &c));
            *field[k] = keep;
        }
        TEST_ASSERT_EQUAL_INT(ERR_OK, relay_begin(&relay, &c));
        TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, relay_step(&relay, bad[i], 0));
        TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, relay_step(&relay, 0, bad[i]));
        TEST_ASSERT_EQUAL_UINT32(0, relay.started);
    }
}

static void what_makes_no_sense_is_refused(void)
{
    struct relay_config c = config_of(1.0, 0.001), d = c;
#define REFUSED(field, value)                                                                      \
    d = c;                                                                                         \
    d.field = value;                                                                               \
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_RANGE, relay_begin(&relay, &d), #field " " #value)
    REFUSED(h_s, 0);
    REFUSED(hysteresis, 0);
    REFUSED(amplitude, (real_t)0.4); /* no room for it */
    REFUSED(amplitude, -1);
    REFUSED(first, 0);
    REFUSED(most, 2);
    REFUSED(wanted, 0);
    REFUSED(patience, 0);
    REFUSED(half_most, 100);
    REFUSED(sign, 0);
    REFUSED(noise_sd, -1);
    TEST_ASSERT_EQUAL_INT(ERR_OK, relay_begin(&relay, &c));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, relay_step(&relay, (real_t)1e13, 0));
    struct relay_result r;
    TEST_ASSERT_EQUAL_INT(ERR_EMPTY, relay_look(&relay, &r));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_limit_cycle_is_the_exact_one_and_both_gains_are_its_own);
    RUN_TEST(with_coarse_samples_the_gain_is_that_of_the_sampled_process);
    RUN_TEST(the_harmonic_is_nearer_to_the_true_ultimate_gain_than_the_describing_function);
    RUN_TEST(a_process_of_negative_gain_is_the_same_upside_down);
    RUN_TEST(noise_scatters_the_gain_and_does_not_move_it);
    RUN_TEST(a_load_is_met_by_the_bias_and_a_drift_followed);
    RUN_TEST(an_amplitude_is_found_that_the_output_answers_to);
    RUN_TEST(a_limit_keeps_the_amplitude_that_is_to_be_found_small);
    RUN_TEST(without_an_answer_it_gives_up);
    RUN_TEST(the_wrong_sign_is_told_from_its_answer);
    RUN_TEST(no_step_of_the_wrong_sign_grows_while_a_slow_output_goes_away);
    RUN_TEST(the_wrong_sign_is_told_too_where_the_output_left_the_right_way);
    RUN_TEST(a_load_against_the_relay_is_no_wrong_sign);
    RUN_TEST(an_inverse_response_does_not_confuse_it);
    RUN_TEST(an_output_that_does_not_come_back_ends_it_in_time);
    RUN_TEST(pure_noise_ends);
    RUN_TEST(samples_that_are_lost_do_not_change_the_outcome_much);
    RUN_TEST(it_takes_two_samples_in_a_row_for_an_answer);
    RUN_TEST(what_is_no_number_is_refused);
    RUN_TEST(what_makes_no_sense_is_refused);
    return UNITY_END();
}

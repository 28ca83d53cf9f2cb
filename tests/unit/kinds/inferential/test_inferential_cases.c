/* Kind `inferential` in closed loops with model plants, beside an independent model in double that was written from
 * docs/methods/inferential.md (tests/reference/inferential_reference.py).
 *
 * Contract, float and fixed. A temperature is rounded to half a step of 2^-24, and all gains are applied to it, so
 *     MV              16 roundings of both temperatures by all gains that act on them, spans
 *     temperatures    what an MV that much off does within 1/Kc
 *     loads           16 such roundings by Ko
 * The controllers forget within a few 1/Kc, so the length of a course does not matter. */
#include "csv.h"
#include "inferential_bench.h"

#define CASES    32
#define PER_LOOP 21
#define SETTINGS (7 + 2 * PER_LOOP)
#define COURSE   11
#define COLUMNS  (2 + 2 * COURSE)
#define ROUNDING (16 * 0x1p-25)

enum {
    LAW,
    SECOND,
    A1,
    A2,
    KC,
    KC2,
    KO,
    PV_LO,
    PV_HI,
    S_LO,
    S_HI,
    MV_LO,
    MV_HI,
    LIM_LO,
    LIM_HI,
    RATE,
    T1,
    T2,
    U,
    CROSS1,
    CROSS2
};
enum { SETPOINT, LOAD1, LOAD2, IS_T1, IS_T2, OUT, APPLIED, B1, B2, E2, UT };

static struct infer_bench b;
static double largest[5];
static const char *const quantity[] = {"MV, spans", "temperature, spans", "load, spans/h",
                                       "e2, spans", "secondary action, spans"};

void setUp(void) {}
void tearDown(void) {}

static struct block_signal span(const double *lo)
{
    return (struct block_signal){.lo = (float)lo[0], .hi = (float)lo[1]};
}

static void begin_loop(const double *s, unsigned k)
{
    struct inferential_settings *c = &b.settings;
    c->law[k] = (uint8_t)s[LAW];
    c->second[k] = (uint16_t)s[SECOND];
    c->a[k][0] = (float)s[A1];
    c->a[k][1] = (float)s[A2];
    c->kc[k] = (float)s[KC];
    c->kc2[k] = (float)s[KC2];
    c->ko[k] = (float)s[KO];
    c->wh[k] = 1e4f;
    b.setup.pv[k] = span(s + PV_LO);
    bool is_mv = b.setup.input[b.seconds + k].is_mv;
    b.setup.input[b.seconds + k] = span(s + MV_LO);
    b.setup.input[b.seconds + k].is_mv = is_mv;
    struct bench_plant *p = &b.plant[k];
    *p = (struct bench_plant){.a = {s[A1], s[A2]},
                              .cross = {s[CROSS1], s[CROSS2]},
                              .t = {s[T1], s[T2]},
                              .u = s[U],
                              .setpoint = s[T1],
                              .lo = s[LIM_LO] - s[MV_LO],
                              .hi = s[LIM_HI] - s[MV_LO],
                              .rate = s[RATE] * (s[MV_HI] - s[MV_LO]) * (double)b.setup.interval_s /
                                      3600};
}

static void begin(const double *s)
{
    memset(&b, 0, sizeof b);
    bench_defaults(&b.settings);
    unsigned loops = (unsigned)s[1];
    bench_wire(&b, loops, (unsigned)s[6], (float)s[3]);
    b.settings.form = (uint8_t)s[2];
    for (unsigned k = 0; k < loops; k++)
        begin_loop(s + 7 + k * PER_LOOP, k);
    for (unsigned j = 0; j < b.seconds; j++) {
        b.second_of[j] = b.seconds < loops ? 1u : j;
        b.setup.input[j] = span(s + 7 + b.second_of[j] * PER_LOOP + S_LO);
    }
    for (unsigned k = 0; k < loops; k++)
        for (unsigned i = 0; i < 2; i++)
            b.plant[k].load[i] = -b.plant[k].a[i] * b.plant[k].u -
                                 (loops > 1 ? b.plant[k].cross[i] * b.plant[1 - k].u : 0);
    bench_configure(&b, false);
    for (unsigned i = 0; i < 3; i++)
        bench_follow(&b);
    b.io.members.acting = b.setup.present;
}

static void expect(const double *row, unsigned what, double bound, double wanted, double is)
{
    char message[96];
    (void)snprintf(message, sizeof message, "%s: case %g, step %g", quantity[what], row[0], row[1]);
    if (fabs(wanted - is) > largest[what])
        largest[what] = fabs(wanted - is);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(bound, wanted, is, message);
}

static void compare(const double *row, const double *s, unsigned k)
{
    const double *r = row + 2 + k * COURSE, mv = s[MV_HI] - s[MV_LO], pv = s[PV_HI] - s[PV_LO],
                 second = s[S_HI] - s[S_LO];
    double secondary = s[LAW] >= LAW_CASCADE ? s[KC2] / fabs(s[A2]) : 0,
           cross = s[LAW] == LAW_CLF ? fabs(s[A1] / s[A2]) : 0;
    double u =
        ROUNDING * ((s[KC] + s[KO]) / fabs(s[A1]) * pv + secondary * (second + cross * pv)) / mv;
    double t1 = u * mv / pv * fabs(s[A1]) / s[KC], t2 = u * mv / second * fabs(s[A2]) / s[KC];
    expect(row, 0, u, r[OUT] / mv, (double)num_to_float(b.out[k]));
    expect(row, 1, t1, r[IS_T1] / pv, b.plant[k].t[0] / pv);
    expect(row, 1, t2, r[IS_T2] / second, b.plant[k].t[1] / second);
    if (s[LAW] == LAW_HOLD)
        return;
    expect(row, 2, s[KO] * t1, r[B1] / pv, bench_loop_value(&b, "b1", k) / pv);
    if (s[LAW] == LAW_CONVENTIONAL)
        return;
    expect(row, 2, s[KO] * t2, r[B2] / second, bench_loop_value(&b, "b2", k) / second);
    expect(row, 3, t2, r[E2] / second, bench_loop_value(&b, "y2", k) / second);
    expect(row, 4, u, r[UT] / mv, bench_loop_value(&b, "sec", k));
}

static void run(const double *row, const double *settings)
{
    for (unsigned k = 0; k < b.setup.members; k++) {
        const double *r = row + 2 + k * COURSE;
        b.plant[k].setpoint = r[SETPOINT];
        b.plant[k].load[0] = r[LOAD1];
        b.plant[k].load[1] = r[LOAD2];
    }
    for (unsigned n = 0; n < (unsigned)settings[4]; n++) {
        bench_step(&b);
        TEST_ASSERT_NULL(b.io.requests.gives_up);
        TEST_ASSERT_EQUAL_HEX16(0, b.io.requests.raised);
        for (unsigned k = 0; n == 0 && k < b.setup.members; k++)
            compare(row, settings + 7 + k * PER_LOOP, k);
        bench_apply(&b);
        bench_go_on(&b);
    }
}

static void test_every_law_and_form_follows_the_independent_model(void)
{
    static double settings[CASES][SETTINGS];
    unsigned cases = 0, at = CASES, rows = 0, wanted = 0;
    FILE *f = csv_open("reference/inferential_settings.csv");
    while (cases < CASES && csv_row(f, settings[cases], SETTINGS))
        wanted += (unsigned)settings[cases++][5];
    fclose(f);
    f = csv_open("reference/inferential_cases.csv");
    double row[COLUMNS];
    for (; csv_row(f, row, COLUMNS); rows++) {
        if ((unsigned)row[0] != at)
            begin(settings[at = (unsigned)row[0]]);
        run(row, settings[at]);
    }
    fclose(f);
    for (unsigned i = 0; i < sizeof largest / sizeof largest[0]; i++)
        printf("largest difference, %s: %.2g\n", quantity[i], largest[i]);
    TEST_ASSERT_EQUAL_MESSAGE(wanted, rows, "not every row was there");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_law_and_form_follows_the_independent_model);
    return UNITY_END();
}

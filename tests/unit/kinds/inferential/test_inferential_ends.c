/* Kind `inferential` at the ends of its parameters' ranges, with random readings, qualities, modes and settings: refused in words,
 * or all it gives is a number. The sanitizers look for what overflows. */
#include "inferential_bench.h"
#include "random_source.h"

#include "base/channel.h"

static struct infer_bench b;
static struct random_source source;

void setUp(void)
{
    source.state = 20101123;
    printf("seed %llu\n", (unsigned long long)source.state);
}
void tearDown(void) {}

static double unit(void)
{
    return random_below(&source, 1u << 24) / 16777216.0;
}

/* An end, the default, nothing at all, or something between, of any magnitude. */
static float any_of(const struct block_parameter *p)
{
    double size = exp(log(1e-4) + unit() * log(1e10)), lo = (double)p->lo, hi = (double)p->hi;
    switch (random_below(&source, 8)) {
    case 0:
        return p->lo;
    case 1:
        return p->hi;
    case 2:
    case 3:
        return p->initial;
    default:
        size = random_below(&source, 2) && lo < 0 ? -size : size;
        return (float)(size < lo ? lo : size > hi ? hi : size);
    }
}

static unsigned words_of(const struct block_parameter *p)
{
    unsigned n = 1;
    for (const char *c = p->unit; *c; c++)
        n += *c == '|';
    return n;
}

static void draw(const struct block_parameter *p)
{
    char *at = (char *)&b.settings + p->offset;
    for (unsigned n = 0; n < (unsigned)p->rows * p->cols; n++) {
        if (p->type == BLOCK_FLOAT)
            memcpy(at + 4 * n, &(float){any_of(p)}, 4);
        else if (p->type == BLOCK_U16)
            memcpy(at + 2 * n, &(uint16_t){(uint16_t)any_of(p)}, 2);
        else
            at[n] = (char)random_below(&source, words_of(p));
    }
}

static struct block_signal any_span(void)
{
    float lo = (float)(2000 * unit() - 1000), width = (float)exp(log(1e-3) + unit() * log(1e10));
    return (struct block_signal){.lo = lo, .hi = lo + width};
}

static void draw_setup(void)
{
    memset(&b, 0, sizeof b);
    bench_defaults(&b.settings);
    unsigned members = 1 + random_below(&source, 2);
    bench_wire(&b, members, random_below(&source, 3), (float)exp(log(0.001) + unit() * log(1e8)));
    for (unsigned k = 0; k < members; k++)
        b.setup.pv[k] = any_span();
    for (unsigned j = 0; j < b.setup.inputs; j++) {
        bool is_mv = b.setup.input[j].is_mv;
        b.setup.input[j] = any_span();
        b.setup.input[j].is_mv = is_mv;
    }
}

static void draw_settings(void)
{
    for (unsigned i = 0; i < inferential_kind.parameters; i++)
        if (random_below(&source, 3) == 0)
            draw(&inferential_kind.parameter[i]);
    for (unsigned k = 0; k < 2; k++) {
        for (unsigned i = 0; i < 2 && random_below(&source, 4); i++)
            b.settings.a[k][i] = (float)exp(log(1e-4) + unit() * log(1e9));
        if (random_below(&source, 4))
            b.settings.w[k] = (float)exp(log(1e-3) + unit() * log(1e5));
    }
}

static void expect_numbers(void)
{
    for (unsigned k = 0; k < b.setup.members; k++)
        TEST_ASSERT_TRUE(isfinite((double)num_to_float(b.out[k])));
    float value;
    const char *name;
    for (size_t i = 0; (name = inferential_kind.describe(b.state, i, &value)) != NULL; i++)
        TEST_ASSERT_TRUE_MESSAGE(isfinite((double)value), name);
}

static num_t any_num(void)
{
    static const float most[] = {0, 1, -1, 2, 127};
    return num_from_float(random_below(&source, 4) ? (float)(1.4 * unit() - 0.2)
                                                   : most[random_below(&source, 5)]);
}

static void any_tick(void)
{
    for (unsigned k = 0; k < b.setup.members; k++) {
        b.pv[k] = any_num();
        b.setpoint[k] = any_num();
    }
    for (unsigned j = 0; j < b.setup.inputs; j++) {
        b.input[j] = any_num();
        b.quality[j] = random_below(&source, 6) ? QUALITY_GOOD : (uint8_t)random_below(&source, 4);
    }
    b.io.members.acting =
        (uint8_t)(random_below(&source, 5) ? b.setup.present
                                           : random_below(&source, 4) & b.setup.present);
    if (b.io.members.acting == 0) {
        inferential_kind.follow(b.state, &b.io);
        return;
    }
    inferential_kind.step(b.state, &b.io);
    expect_numbers();
    for (unsigned k = 0; k < b.setup.members; k++) {
        b.clamp[k] = (uint8_t)random_below(&source, 4);
        if (random_below(&source, 3))
            b.out[k] = num_clamp(b.out[k], num_zero(), num_one());
    }
    inferential_kind.back_calculate(b.state, &b.io);
    expect_numbers();
}

static void test_at_any_settings_it_refuses_or_gives_numbers(void)
{
    unsigned runs = 0, said_no = 0;
    struct block_fault fault;
    for (unsigned n = 0; n < 20000; n++) {
        draw_setup();
        draw_settings();
        if (bench_check(&b, &fault)) {
            said_no++;
            TEST_ASSERT_GREATER_THAN(0, strlen(fault.wanted));
            TEST_ASSERT_GREATER_THAN(0, strlen(fault.field));
            TEST_ASSERT_LESS_THAN(b.setup.members, fault.member);
            continue;
        }
        runs++;
        bench_configure(&b, false);
        inferential_kind.follow(b.state, &b.io);
        for (unsigned t = 0; t < 60; t++) {
            struct inferential_settings before = b.settings;
            if (random_below(&source, 20) == 0)
                draw_settings();
            if (memcmp(&before, &b.settings, sizeof before) != 0) {
                if (bench_check(&b, &fault))
                    b.settings = before;
                else
                    bench_configure(&b, true);
            }
            any_tick();
        }
    }
    printf("%u ran, %u were refused\n", runs, said_no);
    TEST_ASSERT_GREATER_THAN(1000, runs);
}

static double magnitude(double lo, double hi)
{
    return exp(log(lo) + unit() * log(hi / lo));
}

/* A law with its model plant, at gains, slopes and intervals at random. */
static void draw_loop(void)
{
    static const enum inferential_law laws[] = {LAW_CONVENTIONAL, LAW_CASCADE, LAW_CLF};
    bench_plain(&b, LAW_CLF, random_below(&source, 2) ? FORM_JOINT : FORM_EULER,
                magnitude(0.5, 3600));
    b.settings.law[0] = (uint8_t)laws[random_below(&source, 3)];
    b.settings.kc[0] = (float)magnitude(0.1, 100);
    b.settings.kc2[0] = (float)magnitude(0.1, 100);
    b.settings.ko[0] = (float)magnitude(0.5, 500);
    b.plant[0].a[0] = b.settings.a[0][0] = (float)magnitude(0.05, 50);
    b.plant[0].a[1] = b.settings.a[0][1] = (float)(magnitude(0.05, 20) * b.plant[0].a[0]);
    for (unsigned i = 0; i < 2; i++)
        b.plant[0].load[i] = -2 * b.plant[0].a[i];
}

/* Slowest of the poles the page promises, 1/h. */
static double slowest(void)
{
    const struct inferential_settings *c = &b.settings;
    double kc = c->kc[0], kc2 = c->kc2[0], r = b.plant[0].a[0] / b.plant[0].a[1];
    if (c->law[0] == LAW_CONVENTIONAL)
        return fmin(kc, c->ko[0]);
    double sum = kc + kc2 * (1 + (c->law[0] == LAW_CLF ? r * r : 0));
    return fmin((sum - sqrt(sum * sum - 4 * kc * kc2)) / 2, c->ko[0]);
}

/* A step of the setpoint small enough for the MV's span, and 4000 roundings of T at least. After ten times the slowest time constant
 * 4.5e-5 of it are left, and some roundings; asked for is a fiftieth. */
static void test_what_it_accepts_holds_the_plant_it_is_for(void)
{
    unsigned runs = 0;
    struct block_fault fault;
    for (unsigned n = 0; n < 3000; n++) {
        draw_loop();
        unsigned steps =
            (unsigned)fmin(1e9, 10 / slowest() * 3600 / (double)b.setup.interval_s) + 50;
        const struct inferential_settings *c = &b.settings;
        double a1 = b.plant[0].a[0], a2 = b.plant[0].a[1];
        double gain = (c->kc[0] + c->ko[0]) / a1 + c->kc2[0] / a2 * (1 + a1 / a2),
               step = 0.5 / gain;
        if (bench_check(&b, &fault) || steps > 20000 || step < 4000 * 8 * 0x1p-24)
            continue;
        runs++;
        bench_begin(&b);
        b.plant[0].setpoint = step;
        bench_cycles(&b, steps);
        char message[256];
        (void)snprintf(message, sizeof message,
                       "law %u, form %u, Ts %g s, kc %g, kc2 %g, ko %g, a %g, %g", c->law[0],
                       c->form, (double)b.setup.interval_s, (double)c->kc[0], (double)c->kc2[0],
                       (double)c->ko[0], a1, a2);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(step / 50, step, b.plant[0].t[0], message);
    }
    printf("%u loops\n", runs);
    TEST_ASSERT_GREATER_THAN(500, runs);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_what_it_accepts_holds_the_plant_it_is_for);
    RUN_TEST(test_at_any_settings_it_refuses_or_gives_numbers);
    return UNITY_END();
}

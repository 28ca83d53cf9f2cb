/* kinds/pid/pid.[ch]: bumpless transfer and parameter change. The fault of others guarded here: no bumpless
 * switch.
 *
 * Contract                                              float32       Q7.24
 *   step after follow, same inputs                      exactly applied in both
 *   step after retune, same inputs, against the step
 *     the old settings would have made                  1.2e-7        1.2e-7   (two roundings of num_t)
 *   random retunes between step and back, inputs that
 *     move, limits: every output against double         1e-5          1e-5
 */
#include <math.h>

#include "pid_bench.h"
#include "random_source.h"

void setUp(void) {}
void tearDown(void) {}

static struct pid_config rich_config(void)
{
    struct pid_config c = pid_default_config();
    c.gain = 3.0f;
    c.ti_s = 60.0f;
    c.td_s = 8.0f;
    c.b = 0.7f;
    c.c = 0.3f;
    return c;
}

static void the_step_after_follow_gives_exactly_the_output_followed(void)
{
    const float gains[] = {0.01f, 1.0f, 37.7f, 100.0f};
    for (int form = 0; form < 2; form++) {
        for (int g = 0; g < 4; g++) {
            for (int action = 0; action < 2; action++) {
                struct pid_config c = rich_config();
                c.gain = gains[g];
                c.form = (enum pid_form)form;
                c.action = (enum pid_action)action;
                struct pid pid = make_pid(c, 0.05f);
                for (int k = 0; k < 200; k++) {
                    num_t r = N(0.5 + 0.45 * sin(k)), y = N(0.5 + 0.45 * cos(2.3 * k)),
                          u = N(0.005 * k);
                    pid_follow(&pid, r, y, u);
                    TEST_ASSERT_TRUE(num_eq(u, pid_step(&pid, r, y)));
                }
            }
        }
    }
}

static void from_manual_to_automatic_there_is_no_bump_after_any_manual_output(void)
{
    struct pid pid = make_pid(rich_config(), 1.0f);
    pid_follow(&pid, N(0.5), N(0.5), N(0.5));
    for (int k = 0; k < 300; k++)
        tick(&pid, 0.6, 0.4 + 0.0005 * k);
    for (int k = 0; k < 50; k++)
        pid_follow(&pid, N(0.6), N(0.55), N(0.123)); /* the operator holds 0.123 */
    TEST_ASSERT_DOUBLE_WITHIN(0.0, D(N(0.123)), tick(&pid, 0.6, 0.55));
    /* then it moves at the pace of the integral only */
    double second = tick(&pid, 0.6, 0.55);
    TEST_ASSERT_DOUBLE_WITHIN(3e-7, D(N(0.123)) + 3.0 / 60.0 * 0.05, second);
}

static void an_output_followed_from_outside_the_limits_enters_them(void)
{
    struct pid_config c = rich_config();
    c.out_lo = 0.2f;
    struct pid pid = make_pid(c, 1.0f);
    pid_follow(&pid, N(0.5), N(0.5), N(0.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, D(N(0.2)), tick(&pid, 0.5, 0.5));
    c.rate_per_s = 0.05f;
    pid = make_pid(c, 1.0f);
    pid_follow(&pid, N(0.5), N(0.5), N(0.0));
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.05, tick(&pid, 0.5, 0.5));
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.10, tick(&pid, 0.5, 0.5));
}

/* Retunes between two ticks and compares the next step, same inputs, with the one not retuned. */
static void retuned(struct pid_config before, struct pid_config after, float h_after,
                    const char *what)
{
    struct pid pid = make_pid(before, 1.0f);
    pid_follow(&pid, N(0.5), N(0.45), N(0.4));
    for (int k = 0; k < 40; k++)
        tick(&pid, 0.5, 0.45 + 0.04 * sin(0.05 * k));
    for (int k = 0; k < 200; k++) /* derivative at rest: its decay is not what is measured here */
        tick(&pid, 0.5, 0.499);
    struct pid old = pid;
    double want = D(pid_step(&old, N(0.5), N(0.499)));
    TEST_ASSERT_EQUAL_INT(ERR_OK, pid_retune(&pid, &after, h_after));
    double got = D(pid_step(&pid, N(0.5), N(0.499)));
    TEST_ASSERT_TRUE(want > 0.05 && want < 0.95);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1.2e-7, want, got, what);
}

static void any_parameter_can_be_changed_without_a_bump(void)
{
    struct pid_config base = rich_config(), c;
    for (int form = 0; form < 2; form++) {
        base.form = (enum pid_form)form;
        c = base, c.gain = 0.4f, retuned(base, c, 1.0f, "smaller gain");
        c = base, c.gain = 60.0f, retuned(base, c, 1.0f, "larger gain");
        c = base, c.ti_s = 7.0f, retuned(base, c, 1.0f, "integral time");
        c = base, c.ti_s = 0.0f, retuned(base, c, 1.0f, "no integral");
        c = base, c.td_s = 0.0f, retuned(base, c, 1.0f, "no derivative");
        c = base, c.td_s = 50.0f, retuned(base, c, 1.0f, "derivative time");
        c = base, c.n = 2.0f, retuned(base, c, 1.0f, "filter ratio");
        c = base, c.b = 0.0f, retuned(base, c, 1.0f, "setpoint weight b");
        c = base, c.c = 1.0f, retuned(base, c, 1.0f, "setpoint weight c");
        c = base, c.tt_s = 3.0f, retuned(base, c, 1.0f, "tracking time");
        c = base, c.rate_per_s = 0.01f, retuned(base, c, 1.0f, "rate limit");
        c = base, c.inhibit_s = 30.0f, retuned(base, c, 1.0f, "inhibitor");
        c = base, c.action = PID_DIRECT, retuned(base, c, 1.0f, "action");
        c = base, c.form = base.form == PID_VELOCITY ? PID_POSITIONAL : PID_VELOCITY;
        retuned(base, c, 1.0f, "form");
        retuned(base, base, 0.25f, "step interval");
    }
}

/* The rest of it decays as before; none of it stays. */
static void switching_the_derivative_off_while_it_acts_makes_no_bump(void)
{
    for (int form = 0; form < 2; form++) {
        struct pid_config c = rich_config();
        c.form = (enum pid_form)form;
        c.ti_s = 0.0f;
        struct pid pid = make_pid(c, 1.0f);
        pid_follow(&pid, N(0.5), N(0.45), N(0.4));
        double last = tick(&pid, 0.5, 0.46);
        TEST_ASSERT_TRUE(last < 0.3); /* the derivative acts */
        struct pid old = pid;
        c.td_s = 0.0f;
        TEST_ASSERT_EQUAL_INT(ERR_OK, pid_retune(&pid, &c, 1.0f));
        for (int k = 0; k < 60; k++)
            TEST_ASSERT_DOUBLE_WITHIN(1.2e-7, tick(&old, 0.5, 0.46), tick(&pid, 0.5, 0.46));
        TEST_ASSERT_DOUBLE_WITHIN(3e-7, 0.4 - 3.0 * 0.01, tick(&pid, 0.5, 0.46));
        TEST_ASSERT_DOUBLE_WITHIN(3e-7, 0.4 - 3.0 * 0.02,
                                  tick(&pid, 0.5, 0.47)); /* and it is off */
    }
}

static void switching_the_derivative_on_makes_no_kick_from_an_old_measurement(void)
{
    struct pid_config c = rich_config();
    c.td_s = 0.0f;
    c.ti_s = 0.0f;
    struct pid pid = make_pid(c, 1.0f);
    pid_follow(&pid, N(0.5), N(0.2), N(0.4));
    double last = 0.0;
    for (int k = 0; k < 100; k++)
        last = tick(&pid, 0.5, 0.2 + 0.001 * k);
    c.td_s = 20.0f;
    c.inhibit_s = 20.0f;
    TEST_ASSERT_EQUAL_INT(ERR_OK, pid_retune(&pid, &c, 1.0f));
    TEST_ASSERT_DOUBLE_WITHIN(1.2e-7, last, tick(&pid, 0.5, 0.299));
    TEST_ASSERT_FALSE(pid.inhibited);
}

/* The inhibitor watches the slope of the measurement. A retune that leaves it on must not forget that slope. */
static void a_retune_keeps_the_slope_that_inhibits_the_integral(void)
{
    struct pid_config c = rich_config();
    c.inhibit_s = 30.0f;
    struct pid plain = make_pid(c, 1.0f), retuned_one = plain;
    for (int k = 0; k < 60; k++) {
        double y = 0.3 + 0.0025 * k;
        (void)tick(&plain, 0.5, y);
        (void)tick(&retuned_one, 0.5, y);
    }
    TEST_ASSERT_TRUE(plain.inhibited);
    c.gain = 2.0f;
    TEST_ASSERT_EQUAL_INT(ERR_OK, pid_retune(&retuned_one, &c, 1.0f));
    for (int k = 60; k < 80; k++) {
        double y = 0.3 + 0.0025 * k;
        (void)tick(&plain, 0.5, y);
        (void)tick(&retuned_one, 0.5, y);
        TEST_ASSERT_EQUAL_INT(plain.inhibited, retuned_one.inhibited);
    }
}

static void retuning_every_tick_does_not_stop_integral_or_derivative(void)
{
    struct pid_config c = rich_config();
    c.ti_s = 3600.0f;
    for (int form = 0; form < 2; form++) {
        c.form = (enum pid_form)form;
        struct pid plain = make_pid(c, 0.05f), retuned_one = make_pid(c, 0.05f);
        pid_follow(&plain, N(0.5), N(0.499), N(0.4));
        pid_follow(&retuned_one, N(0.5), N(0.499), N(0.4));
        double worst = 0.0, u = 0.0;
        for (int k = 0; k < 72000; k++) {
            double y = 0.499 + 0.0005 * sin(0.001 * k);
            TEST_ASSERT_EQUAL_INT(ERR_OK, pid_retune(&retuned_one, &c, 0.05f));
            u = tick(&plain, 0.5, y);
            worst = fmax(worst, fabs(u - tick(&retuned_one, 0.5, y)));
        }
        TEST_ASSERT_TRUE(u > 0.4025);
        printf("retuned 72000 times: %.2g\n", worst);
        TEST_ASSERT_TRUE(worst < 1e-6);
    }
}

/* ---- retunes at random, against the law in double as docs/methods/pid.md writes it ---- */

struct described {
    struct pid_config c;
    double h, tf, d, sum, p, x, raw;
};

static double random_between(struct random_source *r, double lo, double hi)
{
    return lo + (hi - lo) * (double)random_below(r, 1000001) / 1e6;
}

static struct pid_config random_config(struct random_source *r)
{
    struct pid_config c = pid_default_config();
    c.gain = (float)random_between(r, 0.05, 3);
    c.ti_s = random_below(r, 4) ? (float)random_between(r, 20, 900) : 0.0f;
    c.td_s = random_below(r, 4) ? (float)random_between(r, 0.5, 30) : 0.0f;
    c.n = (float)random_between(r, 1, 20);
    c.b = (float)random_between(r, 0, 1);
    c.c = (float)random_between(r, 0, 1);
    c.tt_s = random_below(r, 2) ? (float)random_between(r, 5, 300) : 0.0f;
    c.action = random_below(r, 2) ? PID_DIRECT : PID_REVERSE;
    c.form = random_below(r, 2) ? PID_VELOCITY : PID_POSITIONAL;
    return c;
}

static double signed_gain(const struct described *m)
{
    return m->c.action == PID_DIRECT ? -(double)m->c.gain : (double)m->c.gain;
}

static double described_step(struct described *m, double r, double y)
{
    double p = (double)m->c.b * r - y, x = (double)m->c.c * r - y, before = m->d;
    m->d = (m->tf * m->d + signed_gain(m) * (double)m->c.td_s * (x - m->x)) / (m->tf + m->h);
    m->raw = m->c.form == PID_VELOCITY ? m->sum + signed_gain(m) * (p - m->p) + m->d - before
                                       : m->sum + signed_gain(m) * p + m->d;
    m->p = p, m->x = x;
    return fmin(1, fmax(0, m->raw));
}

/* After a step: its output stays what it is, the derivative goes on from where it is, the rest is the integral's. */
static void described_retune(struct described *m, struct pid_config c, double h, double r, double y)
{
    m->c = c, m->h = h;
    m->tf = c.td_s > 0.0f ? (double)c.td_s / (double)c.n : m->tf;
    m->p = (double)c.b * r - y, m->x = (double)c.c * r - y;
    m->sum = c.form == PID_VELOCITY ? m->raw : m->raw - signed_gain(m) * m->p - m->d;
}

static void described_back(struct described *m, double applied, double e)
{
    double ti = (double)m->c.ti_s, td = (double)m->c.td_s, tt = (double)m->c.tt_s;
    double track = ti <= 0 ? 0 : m->h / (tt > 0 ? tt : td > 0 ? sqrt(ti * td) : ti);
    if (m->c.form == PID_VELOCITY)
        m->sum = applied;
    else
        m->sum += fmin(1, track) * (applied - m->raw);
    m->sum += ti > 0 ? signed_gain(m) * m->h / ti * e : 0;
}

static void retunes_at_random_follow_the_description(void)
{
    struct random_source random = {20261122};
    printf("seed %llu\n", (unsigned long long)random.state);
    double worst = 0.0;
    unsigned limited = 0;
    for (int n = 0; n < 300; n++) {
        struct described m = {.c = random_config(&random), .h = random_between(&random, 0.2, 3)};
        m.tf = (double)m.c.td_s / (double)m.c.n;
        struct pid pid = make_pid(m.c, (float)m.h);
        double r = 0.5, y = 0.5, swing = random_between(&random, 0.005, 0.1);
        double period = random_between(&random, 2, 40);
        pid_follow(&pid, N(r), N(y), N(0.5));
        m.p = (double)m.c.b * r - y, m.x = (double)m.c.c * r - y;
        m.sum = m.c.form == PID_VELOCITY ? 0.5 : 0.5 - signed_gain(&m) * m.p;
        unsigned when = 5 + random_below(&random, 60), again = when + random_below(&random, 8);
        for (unsigned k = 0; k < 150; k++) {
            r = D(N(0.5 + 0.02 * sin(k / 17.0)));
            y = D(N(0.5 + swing * sin(k / period)));
            double want = described_step(&m, r, y);
            num_t u = pid_step(&pid, N(r), N(y));
            worst = fmax(worst, fabs(want - D(u)));
            limited += want != m.raw;
            if (k == when || k == again) {
                struct pid_config c = random_config(&random);
                double h = random_between(&random, 0.2, 3);
                described_retune(&m, c, (double)(float)h, r, y);
                TEST_ASSERT_EQUAL_INT(ERR_OK, pid_retune(&pid, &c, (float)h));
            }
            pid_back_calculate(&pid, u, INTEGRAL_FREE);
            described_back(&m, want, r - y);
        }
    }
    printf("worst %.2g, limited %u\n", worst, limited);
    TEST_ASSERT_TRUE(limited > 500);
    TEST_ASSERT_TRUE(worst < 1e-5);
}

static void an_output_with_another_meaning_keeps_what_is_under_way(void)
{
    for (int form = 0; form < 2; form++) {
        struct pid_config c = rich_config();
        c.form = (enum pid_form)form;
        struct pid pid = make_pid(c, 1.0f);
        pid_follow(&pid, N(0.5), N(0.45), N(0.4));
        tick(&pid, 0.5, 0.452);
        tick(&pid, 0.5, 0.451);
        struct pid old = pid;
        pid_shift(&pid, N(D(pid.output) + 7.25));
        for (int k = 0; k < 50; k++) {
            num_t u = pid_step(&old, N(0.5), N(0.45));
            num_t v = pid_step(&pid, N(0.5), N(0.45));
            TEST_ASSERT_DOUBLE_WITHIN(2e-6, D(u) + 7.25, D(pid.raw));
            pid_back_calculate(&old, u, INTEGRAL_FREE);
            pid_back_calculate(&pid, pid.raw, INTEGRAL_FREE);
            (void)v;
        }
    }
}

/* A limited output is not the sum of the terms. The shift discards the excess, so the next step gives the value applied. */
static void a_limited_output_with_another_meaning_continues_from_the_value_applied(void)
{
    for (int form = 0; form < 2; form++) {
        struct pid_config c = rich_config();
        c.form = (enum pid_form)form;
        c.td_s = 0.0f;
        c.out_hi = 0.5f;
        struct pid pid = make_pid(c, 1.0f);
        pid_follow(&pid, N(0.5), N(0.45), N(0.45));
        (void)pid_step(&pid, N(0.6), N(0.45));
        TEST_ASSERT_TRUE(D(pid.output) < D(pid.raw) - 0.1);
        pid_shift(&pid, N(0.3));
        (void)pid_step(&pid, N(0.6), N(0.45));
        TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.3, D(pid.raw));
    }
}

static void retuning_before_the_first_step_only_takes_the_settings(void)
{
    struct pid_config c = rich_config();
    struct pid pid = make_pid(c, 1.0f);
    c.gain = 9.0f;
    TEST_ASSERT_EQUAL_INT(ERR_OK, pid_retune(&pid, &c, 1.0f));
    TEST_ASSERT_FALSE(pid.primed);
    pid_follow(&pid, N(0.5), N(0.5), N(0.5));
    TEST_ASSERT_TRUE(tick(&pid, 0.5, 0.5) == 0.5);
}

static void the_block_interface_drives_the_same_controller(void)
{
    struct pid a = make_pid(rich_config(), 1.0f), b = a;
    num_t r = N(0.5), y = N(0.48), u = N(0.4), out;
    pid_follow(&a, r, y, u);
    uint8_t clamp = INTEGRAL_FREE, limited = INTEGRAL_CLAMP_UP;
    struct block_io io = {.members.acting = 1,
                          .members.setpoint = &r,
                          .members.in = &y,
                          .members.out = &u,
                          .members.clamp = &clamp,
                          .members.limited = &limited};
    pid_kind.follow(&b, &io);
    TEST_ASSERT_EQUAL_UINT8(INTEGRAL_FREE, limited);
    io.members.out = &out;
    for (int k = 0; k < 50; k++) {
        y = N(0.48 + 0.001 * k);
        clamp = k % 3 == 0 ? INTEGRAL_CLAMP_UP : INTEGRAL_FREE;
        pid_kind.step(&b, &io);
        num_t direct = pid_step(&a, r, y);
        TEST_ASSERT_TRUE(num_eq(direct, out));
        pid_back_calculate(&a, direct, clamp);
        pid_kind.back_calculate(&b, &io);
    }
    TEST_ASSERT_EQUAL_STRING("pid", pid_kind.name);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_step_after_follow_gives_exactly_the_output_followed);
    RUN_TEST(from_manual_to_automatic_there_is_no_bump_after_any_manual_output);
    RUN_TEST(an_output_followed_from_outside_the_limits_enters_them);
    RUN_TEST(any_parameter_can_be_changed_without_a_bump);
    RUN_TEST(switching_the_derivative_off_while_it_acts_makes_no_bump);
    RUN_TEST(switching_the_derivative_on_makes_no_kick_from_an_old_measurement);
    RUN_TEST(a_retune_keeps_the_slope_that_inhibits_the_integral);
    RUN_TEST(retuning_every_tick_does_not_stop_integral_or_derivative);
    RUN_TEST(retuning_before_the_first_step_only_takes_the_settings);
    RUN_TEST(the_block_interface_drives_the_same_controller);
    RUN_TEST(retunes_at_random_follow_the_description);
    RUN_TEST(an_output_with_another_meaning_keeps_what_is_under_way);
    RUN_TEST(a_limited_output_with_another_meaning_continues_from_the_value_applied);
    return UNITY_END();
}

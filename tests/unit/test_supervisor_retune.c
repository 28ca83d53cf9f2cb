/* A new plan in force while loops act and things move: what it does not concern goes on as if nothing had been applied, and
 * what it concerns begins where the old settings would have been. Every case runs twice from the same state, once with the
 * plan and once without. */
#include "random_source.h"
#include "supervisor_bench.h"

static struct bench kept;

void setUp(void) {}
void tearDown(void) {}

#define RECORD 400

static double without[RECORD][2];

/* Readings, by turns, of both temperatures; NULL: they stay. */
static void (*drive)(unsigned n);

static void run(unsigned n, double (*record)[2])
{
    for (unsigned k = 0; k < n; k++) {
        if (drive)
            drive(k);
        tick();
        if (record) {
            record[k][0] = sent(REFLUX);
            record[k][1] = sent(HEAT);
        }
    }
}

/* Records the next n ticks; everything is then as before. */
static void foresee(unsigned n)
{
    kept = bench;
    run(n, without);
    bench = kept;
}

static void differs_nowhere(unsigned n, double by, const char *what)
{
    static double with[RECORD][2];
    run(n, with);
    for (unsigned k = 0; k < n; k++)
        for (unsigned j = 0; j < 2; j++)
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(by, without[k][j], with[k][j], what);
}

/* ---- a plan that concerns neither loop ---- */

static void decoupled_with_derivative(void)
{
    put_all((const char *const[]){"loop1.decouple", "on", "loop2.decouple", "on", "decouple1.d2",
                                  "0.9", "decouple2.d1", "0.93", "loop1.td", "60", "loop2.td", "60",
                                  "alarm1.on", "T1", NULL});
}

static void both_in_automatic(void)
{
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
}

static void a_plan_that_does_not_concern_them_leaves_decoupled_loops_alone(void)
{
    static const char *const changes[][2] = {
        {"alarm1.limit", "150"}, {"meas4.filter", "9"}, {"mv2.band", "0.1"},    {"loop3.gain", "3"},
        {"decouple3.d1", "0.4"}, {"mv3.safe", "20"},    {"meas4.name", "other"}};
    drive = NULL;
    for (unsigned k = 0; k < sizeof changes / sizeof changes[0]; k++) {
        bench_start_with(decoupled_with_derivative);
        both_in_automatic();
        reading(T10, 118); /* one reading: the derivative is in full swing */
        tick();
        reading(T10, 115);
        tick();
        foresee(300);
        set_and_apply(changes[k][0], changes[k][1]);
        differs_nowhere(300, 0, changes[k][0]);
    }
}

static void a_plan_every_tick_that_does_not_concern_them_leaves_decoupled_loops_alone(void)
{
    drive = NULL;
    bench_start_with(decoupled_with_derivative);
    both_in_automatic();
    reading(T10, 118);
    tick();
    reading(T10, 115);
    foresee(100);
    for (unsigned k = 0; k < 100; k++) {
        set_and_apply("alarm1.limit", k % 2 ? "150" : "149");
        tick();
        TEST_ASSERT_DOUBLE_WITHIN(0, without[k][1], sent(HEAT));
    }
}

static void a_setpoint_on_its_way_goes_on_through_a_plan_that_does_not_concern_it(void)
{
    drive = NULL;
    bench_start();
    put_all((const char *const[]){"loop2.sp_ramp", "6", "loop2.sp_filter", "120", NULL});
    apply();
    both_in_automatic();
    setpoint(BOTTOM, 150);
    ticks(100);
    kept = bench;
    ticks(200);
    double undisturbed = setpoint_of(BOTTOM);
    bench = kept;
    for (unsigned k = 0; k < 200; k++) {
        set_and_apply("meas4.filter", k % 2 ? "9" : "8");
        tick();
        bench_forget_events();
    }
    TEST_ASSERT_DOUBLE_WITHIN(0, undisturbed, setpoint_of(BOTTOM));
}

static void a_filter_taken_off_a_moving_setpoint_makes_no_jump(void)
{
    bench_start();
    put_all((const char *const[]){"loop2.sp_ramp", "6", "loop2.sp_filter", "120", NULL});
    apply();
    both_in_automatic();
    setpoint(BOTTOM, 150);
    ticks(100);
    double before = setpoint_of(BOTTOM);
    set_and_apply("loop2.sp_filter", "0");
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, before + 0.001, setpoint_of(BOTTOM)); /* a tick of the ramp */
}

/* ---- members, matrix and feedforward change while the derivative acts ---- */

/* The transient of a derivative belongs to a disturbance that is over: it must not stay in the loop's output. */
static void a_change_around_a_loop_keeps_no_transient_of_its_derivative(void)
{
    static const char *const changes[][2] = {{"decouple1.d2", "0.5"}, {"loop1.decouple", "off"},
                                             {"ff1.from", "feed"},    {"loop2.td", "0"},
                                             {"loop2.gain", "0.75"},  {NULL, NULL}};
    drive = NULL;
    for (unsigned k = 0; k < sizeof changes / sizeof changes[0]; k++) {
        bench_start_with(decoupled_with_derivative);
        put_all((const char *const[]){"ff1.to", "heat", "ff1.gain", "0.4", "loop1.ti", "0",
                                      "loop2.ti", "0", "loop2.gain", "1", NULL});
        apply();
        both_in_automatic();
        reading(T10, 116);
        tick();
        reading(T10, 115);
        tick();
        if (changes[k][0])
            set_and_apply(changes[k][0], changes[k][1]);
        else
            mode(TOP, LOOP_MANUAL);
        ticks(300);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(2e-5, 0.5, sent(HEAT),
                                          changes[k][0] ? changes[k][0] : "situation");
    }
}

/* ---- any settings, any moment ---- */

static struct random_source source;

static double between(double lo, double hi)
{
    return lo + (hi - lo) * (double)random_below(&source, 1000001) / 1e6;
}

static void put_number(unsigned loop, const char *field, double value)
{
    char name[24], text[32];
    snprintf(name, sizeof name, "loop%u.%s", loop, field);
    snprintf(text, sizeof text, "%.6g", value);
    put(name, text);
}

static void put_word(unsigned loop, const char *field, const char *value)
{
    char name[24];
    snprintf(name, sizeof name, "loop%u.%s", loop, field);
    put(name, value);
}

static void random_settings(unsigned loop)
{
    put_number(loop, "gain", between(0.1, 4));
    put_number(loop, "ti", random_below(&source, 4) ? between(20, 900) : 0);
    put_number(loop, "td", random_below(&source, 4) ? between(0.5, 60) : 0);
    put_number(loop, "n", between(1, 20));
    put_number(loop, "b", between(0, 1));
    put_number(loop, "c", between(0, 1));
    put_number(loop, "tt", random_below(&source, 2) ? between(5, 500) : 0);
    put_number(loop, "inhibit", random_below(&source, 4) ? 0 : between(5, 60));
    put_word(loop, "algorithm", random_below(&source, 2) ? "velocity" : "positional");
    put_word(loop, "action", random_below(&source, 2) ? "direct" : "reverse");
}

static double wave[4];

static void moving(unsigned n)
{
    double t = (double)bench.s.ticks;
    (void)n;
    reading(T10, 115 + wave[0] * sin(t / wave[1]) + wave[2] * sin(t / wave[3]));
    reading(T1, 85 - wave[0] * cos(t / wave[1]) - wave[2] * cos(t / wave[3]));
    reading(T5, 100 + wave[0] * cos(t / wave[3]));
    reading(FEED, 5 + wave[2] * sin(t / wave[1]));
}

/* Structures of the loops while they are retuned. */
enum situation { APART, DECOUPLED, FED_FORWARD, IN_CASCADE, JAMMED, SITUATIONS };

static void prepare(enum situation situation, unsigned divisor)
{
    bench_start_with(bench_cascade);
    put_word(3, "name", situation == IN_CASCADE ? "outer" : "-");
    put_word(4, "name", "-");
    for (unsigned loop = 1; loop <= 3; loop++) {
        random_settings(loop);
        put_number(loop, "divisor", divisor);
        put_number(loop, "sp_ramp", between(0.1, 20));
    }
    if (situation == DECOUPLED || situation == FED_FORWARD)
        put_all((const char *const[]){"loop1.decouple", "on", "loop2.decouple", "on",
                                      "decouple1.d2", "0.6", "decouple2.d1", "-0.4", NULL});
    if (situation == FED_FORWARD)
        put_all(
            (const char *const[]){"ff1.from", "feed",   "ff1.to",        "heat", "ff1.gain", "0.4",
                                  "ff1.lag",  "9",      "ff1.reference", "5",    "ff2.from", "heat",
                                  "ff2.to",   "reflux", "ff2.gain",      "-0.3", "ff2.lo",   "-0.5",
                                  "ff2.hi",   "0.5",    "ff2.reference", "1",    NULL});
    if (situation == JAMMED)
        bench.input.readback[HEAT] = (struct reading){1.1f, QUALITY_GOOD};
    apply();
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, situation == IN_CASCADE ? LOOP_CASCADE : LOOP_AUTO);
    if (situation == IN_CASCADE)
        mode(OUTER, LOOP_AUTO);
    setpoint(TOP, between(82, 88));
    setpoint(situation == IN_CASCADE ? OUTER : BOTTOM, between(105, 115));
}

/* Old and new settings, measurements, setpoint ramps and moment at random; the plan comes at any phase of the divisor. */
static void the_next_output_is_what_the_old_settings_would_have_given(void)
{
    const uint64_t seed = 20261122;
    printf("seed %llu\n", (unsigned long long)seed);
    source.state = seed;
    drive = moving;
    double worst = 0;
    unsigned moved = 0;
    for (unsigned n = 0; n < 50 * SITUATIONS; n++) {
        unsigned divisor = 1 + random_below(&source, 3);
        wave[0] = between(0.2, 2), wave[1] = between(5, 60);
        wave[2] = between(0.02, 0.3), wave[3] = between(1, 5);
        prepare((enum situation)(n % SITUATIONS), divisor);
        run(20 + random_below(&source, 40), NULL);
        foresee(divisor);
        double last = sent(HEAT);
        for (unsigned loop = 1; loop <= 3; loop++)
            random_settings(loop);
        apply();
        for (unsigned k = 0; k < divisor; k++) { /* up to the loops' next turn */
            moving(k);
            tick();
            double gap = fmax(fabs(sent(HEAT) - without[k][1]), fabs(sent(REFLUX) - without[k][0]));
            worst = fmax(worst, gap);
            moved += fabs(sent(HEAT) - last) > 1e-4;
            if (gap > BUMP)
                printf("case %u: %.9g for %.9g\n", n, sent(HEAT), without[k][1]);
        }
    }
    printf("worst %.3g, moved %u\n", worst, moved);
    TEST_ASSERT_TRUE(moved > 150);
    TEST_ASSERT_TRUE(worst <= BUMP);
}

static void a_plan_that_concerns_nobody_changes_nothing_in_any_situation(void)
{
    source.state = 7;
    drive = moving;
    for (unsigned n = 0; n < 4 * SITUATIONS; n++) {
        wave[0] = 1.5, wave[1] = 12, wave[2] = 0.2, wave[3] = 2;
        prepare((enum situation)(n % SITUATIONS), 1 + n % 3);
        run(20 + random_below(&source, 40), NULL);
        foresee(40);
        set_and_apply(n % 2 ? "mv3.safe" : "tick.miss_limit", "7");
        differs_nowhere(40, 0, "situation");
    }
}

/* A loop whose turn is moved by plans runs, and integrates, as often as its turn comes: here in every tick. */
static void plans_that_move_a_loops_turn_do_not_stop_its_integral(void)
{
    drive = NULL;
    bench_start();
    set_and_apply("loop2.divisor", "2");
    mode(BOTTOM, LOOP_AUTO);
    ticks(4);
    reading(T10, 110);
    ticks(2);
    double at = sent(HEAT);
    for (unsigned k = 0; k < 100; k++) {
        set_and_apply("loop2.phase", bench.s.ticks % 2 ? "1" : "0");
        tick();
        bench_forget_events();
    }
    TEST_ASSERT_DOUBLE_WITHIN(1.1e-3, at + 100 * 1.5 * 2 / 300 * 0.05, sent(HEAT)); /* two steps */
}

static void a_new_interval_begins_with_the_output_the_old_one_would_have_given(void)
{
    drive = moving;
    wave[0] = 1.5, wave[1] = 12, wave[2] = 0.2, wave[3] = 2;
    for (unsigned phase = 0; phase < 6; phase++) {
        bench_start();
        put_all((const char *const[]){"loop2.td", "30", "loop2.divisor", "2", NULL});
        apply();
        mode(BOTTOM, LOOP_AUTO);
        run(24 + phase, NULL);
        while (bench.s.ticks % 6 != 0)
            run(1, NULL); /* due with either divisor */
        foresee(1);
        set_and_apply("loop2.divisor", "3");
        differs_nowhere(1, BUMP, "divisor");
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_plan_that_does_not_concern_them_leaves_decoupled_loops_alone);
    RUN_TEST(a_plan_every_tick_that_does_not_concern_them_leaves_decoupled_loops_alone);
    RUN_TEST(a_setpoint_on_its_way_goes_on_through_a_plan_that_does_not_concern_it);
    RUN_TEST(a_filter_taken_off_a_moving_setpoint_makes_no_jump);
    RUN_TEST(a_change_around_a_loop_keeps_no_transient_of_its_derivative);
    RUN_TEST(the_next_output_is_what_the_old_settings_would_have_given);
    RUN_TEST(a_plan_that_concerns_nobody_changes_nothing_in_any_situation);
    RUN_TEST(plans_that_move_a_loops_turn_do_not_stop_its_integral);
    RUN_TEST(a_new_interval_begins_with_the_output_the_old_one_would_have_given);
    return UNITY_END();
}

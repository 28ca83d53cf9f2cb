/* Interlocks on the whole firmware, asked for at the console, over the link: when one begins, and what it leaves behind. */
#include <math.h>

#include "board_bench.h"
#include "random_source.h"

#define TICK_MS 1000
enum { T1, T10 };
enum { REFLUX, HEAT };

void setUp(void) {}
void tearDown(void) {}

static void set_to(const char *name, const char *value)
{
    char line[80];
    snprintf(line, sizeof line, "set %s %s", name, value);
    ask_ok(line);
}

/* "name value" pairs in one transaction, NULL at the end. */
static void settings(const char *const *pairs)
{
    ask_ok("begin");
    for (; *pairs; pairs += 2)
        set_to(pairs[0], pairs[1]);
    ask_ok("apply");
}
#define SETTINGS(...) settings((const char *const[]){__VA_ARGS__, NULL})

static void reads(double value)
{
    board.values[T10] = value;
    board.quality[T10] = QUALITY_GOOD;
}

static double heat(void)
{
    return (double)board.command.output[HEAT].value;
}

static bool listed(const char *text)
{
    ask_ok("alarm");
    return said(text);
}

static bool active(void)
{
    return listed("INTERLOCK_ON lock1 holds heat");
}

/* The plant is restarted: nothing that was read before counts any more. */
static void plant_again(void)
{
    board.session++;
    plant_hello();
    pass(200);
    TEST_ASSERT_TRUE(board.ready);
}

/* ---- when it begins ---- */

/* Faults before a reading past the limit, or beside it. */
static const struct history {
    const char *name;
    double reading; /* past the limit of 140, or of 80 */
    bool first;     /* no other reading came before */
    unsigned lost;  /* samples that are flagged bad before */
    unsigned gap;   /* every n-th sample is missing */
    const char *setting[2];
} histories[] = {
    {"in belief", 150, false, 0, 0, {NULL, NULL}},
    {"beyond belief", 172, false, 0, 0, {NULL, NULL}},
    {"first reading, beyond belief", 172, true, 0, 0, {NULL, NULL}},
    {"after a loss, beyond belief", 172, false, 8, 0, {NULL, NULL}},
    {"frozen", 150, false, 0, 0, {"meas2.frozen", "5"}},
    {"first reading, frozen", 150, true, 0, 0, {"meas2.frozen", "1"}},
    {"too fast", 150, false, 0, 0, {"meas2.rate_limit", "0.01"}},
    {"after a loss, too fast", 150, false, 8, 0, {"meas2.rate_limit", "0.01"}},
    {"with gaps", 150, false, 0, 3, {NULL, NULL}},
    {"with gaps, beyond belief", 172, false, 0, 3, {NULL, NULL}},
    {"first reading, with gaps, beyond belief", 172, true, 0, 3, {NULL, NULL}},
    {"below, beyond belief", 45, false, 0, 0, {"lock1.side", "below"}},
    {"first reading, below, beyond belief", 45, true, 0, 0, {"lock1.side", "below"}},
};

struct variant {
    const char *on_bad, *hold, *delay, *fallback;
};

static void vary(const struct history *h, const struct variant *v)
{
    static const char *const nothing[2] = {"lock1.side", "above"};
    const char *const *extra = h->setting[0] ? h->setting : nothing;
    bool below = h->reading < 100;
    SETTINGS("meas2.frozen", "0", "meas2.rate_limit", "0", "lock1.side", "above", "lock1.limit",
             below ? "80" : "140", "lock1.on_bad", v->on_bad, "meas2.hold", v->hold, "lock1.delay",
             v->delay, "meas2.fallback", v->fallback, extra[0], extra[1]);
}

/* A number, or none, for so many ticks; returns the tick, from 1, with the first command that is forced; 0: none. */
static unsigned forced_within(const struct history *h, unsigned n)
{
    for (unsigned k = 1; k <= n; k++) {
        reads(h->reading);
        if (h->gap && k % h->gap == 0)
            board.quality[T10] = QUALITY_MISSING;
        samples(1);
        if (heat() == 0.0)
            return k;
    }
    return 0;
}

static void begin_with(const struct history *h)
{
    reads(115);
    if (!h->first)
        samples(3);
    plant_again();
    if (h->first)
        return;
    for (unsigned k = 0; k < 3; k++) { /* it moves: not frozen */
        reads(115 + 0.001 * k);
        samples(1);
    }
    board.quality[T10] = QUALITY_BAD;
    samples(h->lost);
}

static void let_go(void)
{
    for (unsigned k = 0; k < 4; k++) {
        reads(115 + 0.01 * k);
        sample_after(100000); /* time for any rate, and longer than any hold */
    }
    TEST_ASSERT_FALSE(active());
    TEST_ASSERT_TRUE(heat() != 0.0);
}

static unsigned tried;

static void try_one(const struct history *h, const struct variant *v)
{
    char where[160];
    unsigned delay = (unsigned)atoi(v->delay);
    snprintf(where, sizeof where, "%s: on_bad %s, hold %s, delay %s, fall-back %s", h->name,
             v->on_bad, v->hold, v->delay, v->fallback);
    vary(h, v);
    begin_with(h);
    bool already = heat() == 0.0 && !h->first;
    TEST_ASSERT_TRUE_MESSAGE(!already || strcmp(v->on_bad, "on") == 0, where);
    unsigned at = forced_within(h, delay + 5);
    TEST_ASSERT_TRUE_MESSAGE(at != 0, where);
    TEST_ASSERT_TRUE_MESSAGE(at <= delay + 2, where);
    if (strcmp(v->on_bad, "off") == 0) /* and not before its time */
        TEST_ASSERT_TRUE_MESSAGE(at > delay, where);
    TEST_ASSERT_TRUE_MESSAGE(active(), where);
    /* An invalid reading does not end it. */
    board.quality[T10] = QUALITY_BAD;
    board.values[T10] = 115;
    samples(10);
    reads(h->reading < 100 ? 400 : 0);
    samples(2);
    TEST_ASSERT_TRUE_MESSAGE(active() && heat() == 0.0, where);
    let_go();
    tried++;
}

static void a_number_that_is_good_by_the_plant_begins_it_whatever_came_before_and_stands_in(void)
{
    static const char *const fallbacks[] = {"hold", "substitute", "manual", "safe"};
    running();
    SETTINGS("lock1.meas", "T10", "lock1.mv", "heat", "lock1.hysteresis", "5", "lock1.value", "0",
             "meas2.substitute", "110", "tick.miss_limit", "1000");
    for (unsigned h = 0; h < sizeof histories / sizeof histories[0]; h++)
        for (unsigned k = 0; k < 32; k++)
            try_one(&histories[h], &(struct variant){k & 1 ? "on" : "off", k & 2 ? "4" : "0",
                                                     k & 4 ? "9" : "0", fallbacks[k >> 3]});
    printf("interlocks: %u combinations\n", tried);
}

static void what_is_not_good_by_the_plant_begins_nothing_where_bad_does_not_count(void)
{
    static const struct {
        double value;
        enum quality quality;
    } none[] = {{172, QUALITY_BAD},
                {172, QUALITY_MISSING},
                {(double)NAN, QUALITY_GOOD},
                {(double)INFINITY, QUALITY_GOOD}};
    running();
    SETTINGS("lock1.meas", "T10", "lock1.mv", "heat", "lock1.limit", "140", "lock1.value", "0",
             "lock1.on_bad", "off", "meas2.hold", "5");
    for (unsigned k = 0; k < sizeof none / sizeof none[0]; k++) {
        board.values[T10] = none[k].value;
        board.quality[T10] = (uint8_t)none[k].quality;
        samples(20);
        TEST_ASSERT_FALSE(active());
        reads(115);
        samples(1);
    }
}

/* Past the limit once, then nothing for good: that is a bad measurement, not a condition that holds. */
static void a_sensor_that_dies_during_the_delay_does_not_begin_it_where_bad_does_not_count(void)
{
    running();
    SETTINGS("lock1.meas", "T10", "lock1.mv", "heat", "lock1.limit", "140", "lock1.value", "0",
             "lock1.on_bad", "off", "meas2.hold", "5", "lock1.delay", "20");
    reads(150);
    samples(3);
    board.quality[T10] = QUALITY_MISSING;
    samples(100);
    TEST_ASSERT_FALSE(active());
    reads(150); /* nothing was heard for longer than the delay: it begins anew */
    samples(20);
    TEST_ASSERT_FALSE(active());
    samples(1);
    TEST_ASSERT_TRUE(active());
}

/* Numbers past the limit before and after, and none between for less than the delay: nobody said it was over. */
static void samples_that_are_missing_when_the_delay_ends_do_not_begin_it_anew(void)
{
    running();
    SETTINGS("lock1.meas", "T10", "lock1.mv", "heat", "lock1.limit", "140", "lock1.value", "0",
             "lock1.on_bad", "off", "meas2.hold", "0", "lock1.delay", "9");
    reads(150);
    samples(8);
    board.quality[T10] = QUALITY_MISSING;
    samples(5);
    TEST_ASSERT_FALSE(active());
    reads(150);
    samples(1);
    TEST_ASSERT_TRUE(active());
}

static void its_delay_begins_anew_with_a_plant_whose_time_does(void)
{
    running();
    SETTINGS("lock1.meas", "T10", "lock1.mv", "heat", "lock1.limit", "140", "lock1.value", "0",
             "lock1.delay", "10");
    samples(60);
    reads(150);
    samples(5);
    board.number = 0;
    board.time_ms = 0;
    plant_again();
    samples(10);
    TEST_ASSERT_FALSE(active());
    samples(1);
    TEST_ASSERT_TRUE(active());
}

static void a_measurement_the_plant_no_longer_has_does_not_end_it(void)
{
    running();
    SETTINGS("lock1.meas", "T10", "lock1.mv", "heat", "lock1.limit", "140", "lock1.value", "0",
             "lock1.on_bad", "off");
    reads(150);
    samples(1);
    reads(115);
    set_to("meas2.unit", "K");
    samples(10);
    TEST_ASSERT_TRUE(active());
    set_to("meas2.unit", "degC");
    samples(1);
    TEST_ASSERT_FALSE(active());
}

/* ---- what it leaves behind ---- */

static void with_lock(void)
{
    running();
    SETTINGS("lock1.meas", "T10", "lock1.mv", "heat", "lock1.limit", "140", "lock1.hysteresis", "5",
             "lock1.value", "2", "mv2.safe", "0.4");
}

static void trip(void)
{
    reads(145);
    samples(2);
    TEST_ASSERT_TRUE(active());
    TEST_ASSERT_EQUAL_FLOAT(2.0f, heat());
}

static void stays_at(double value, unsigned n)
{
    while (n--) {
        samples(1);
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, (float)value, heat());
    }
}

static void after_it_acted_in_the_safe_state_its_output_is_safe_and_stays_there(void)
{
    for (unsigned rate = 0; rate < 2; rate++) {
        with_lock();
        set_to("mv2.rate", rate ? "0.01" : "0");
        samples(1);
        TEST_ASSERT_TRUE(board.command.safe);
        trip();
        TEST_ASSERT_TRUE(board.command.safe);
        reads(115);
        stays_at(0.4, 50);
        TEST_ASSERT_TRUE(board.command.safe);
        ask_ok("mode top auto");
        stays_at(0.4, 50);
        TEST_ASSERT_FALSE(board.command.safe);
        set_to("loop2.gain", "1.4");
        stays_at(0.4, 5);
    }
}

static void released_after_the_safe_state_has_ended_it_leaves_its_value(void)
{
    with_lock();
    trip();
    ask_ok("mode top auto");
    stays_at(2, 3);
    reads(115);
    stays_at(2, 50);
}

static void an_output_that_it_left_within_its_limits_is_not_called_outside(void)
{
    with_lock();
    trip();
    reads(115);
    samples(2);
    ask_ok("status");
    TEST_ASSERT_FALSE(said("outside its limits"));
}

static void in_manual_an_output_stays_where_it_left_it_until_somebody_moves_it(void)
{
    with_lock();
    SETTINGS("mv2.max", "1.5", "mv2.rate", "0.01");
    ask_ok("out bottom 1");
    samples(100);
    trip();
    reads(115);
    stays_at(2, 20);
    TEST_ASSERT_FALSE(active());
    ask_ok("status");
    TEST_ASSERT_TRUE(said("heat = 2 kW outside its limits, left there by an interlock"));
    ask_ok("mode top auto");
    stays_at(2, 10);
    set_to("loop2.gain", "1.4"); /* nothing to do with it */
    stays_at(2, 10);
    set_to("mv2.max", "1.6"); /* still past it */
    stays_at(2, 10);
    set_to("mv2.max", "1.5");
    ask_ok("out bottom 1.2");
    samples(1);
    ask_ok("status");
    TEST_ASSERT_FALSE(said("interlock"));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1.49f,
                             heat()); /* its limits count again, and its rate from there */
    samples(9);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1.40f, heat());
    samples(50);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1.2f, heat());
    set_to("mv2.max", "2");
    stays_at(1.2, 10);
}

static void no_acting_loop_goes_past_the_operating_limits_once_it_has_let_go(void)
{
    static const char *const divisors[] = {"1", "7"};
    for (unsigned k = 0; k < 4; k++) {
        bool manual = k & 1;
        with_lock();
        SETTINGS("mv2.max", "1.5", "mv2.rate", "0.001", "loop2.divisor", divisors[k >> 1],
                 "loop2.gain", "4");
        ask_ok("out bottom 1");
        samples(700);
        ask_ok(manual ? "mode bottom manual" : "mode bottom auto");
        samples(10);
        trip();
        reads(115);
        if (manual) {
            samples(3);
            TEST_ASSERT_FLOAT_WITHIN(1e-6f, 2.0f, heat());
            ask_ok("mode bottom auto");
        }
        for (unsigned n = 0; n < 20; n++) {
            samples(1);
            TEST_ASSERT_TRUE(heat() <= 1.5 + 1e-6);
            /* and not further than it must */
            TEST_ASSERT_TRUE(heat() >= 1.5 - 0.001 * (n + 1) - 1e-5);
        }
        reads(117); /* it is not wound up: it comes down as fast as it may */
        samples(7);
        double before = heat();
        samples(10);
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, (float)(before - 0.01), heat());
    }
}

static void a_limit_that_was_narrower_for_a_while_brings_nothing_back_later(void)
{
    with_lock();
    ask_ok("out bottom 1.8");
    samples(2);
    set_to("mv2.max", "1");
    stays_at(1, 5);
    set_to("mv2.max", "2");
    stays_at(1, 20);
}

static void an_output_the_plant_does_not_have_comes_back_at_its_safe_value(void)
{
    with_lock();
    ask_ok("out bottom 1.2");
    ask_ok("mode top auto");
    samples(3);
    set_to("mv2.unit", "W"); /* not as announced: it is let go to the plant's own safe value */
    reads(145);
    samples(5);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.25f, heat());
    ask_ok("status");
    TEST_ASSERT_FALSE(said("interlocked"));
    reads(115);
    samples(5);
    set_to("mv2.unit", "kW");
    stays_at(0.4, 20); /* neither 1.2, which is long past, nor 2, which was never sent */
}

static void silence_ends_what_it_forces_and_the_way_back_begins_safe(void)
{
    with_lock();
    ask_ok("out bottom 1");
    samples(2);
    trip();
    board.mute = true;
    pass(5000);
    ask_ok("status");
    TEST_ASSERT_FALSE(said("interlocked"));
    board.mute = false;
    plant_again();
    reads(137); /* inside, but not by the hysteresis */
    samples(1);
    TEST_ASSERT_TRUE(active());
    TEST_ASSERT_EQUAL_FLOAT(2.0f, heat());
    reads(115);
    stays_at(0.4, 20);
    ask_ok("mode top auto");
    stays_at(0.4, 20);
}

/* A reset that leaves the memory alone, configured as before by hand. */
static void warm_reset(const char *policy)
{
    memory_port_reset(HAL_RESET_WATCHDOG);
    board.ready = false;
    board_run();
    type("mode machine\n");
    pass(1000);
    TEST_ASSERT_TRUE(board.ready);
    samples(1);
    configure();
    SETTINGS("lock1.meas", "T10", "lock1.mv", "heat", "lock1.limit", "140", "lock1.hysteresis", "5",
             "lock1.value", "2", "mv2.safe", "0.4", "mv2.max", "1.5", "mv2.rate", "0.01",
             "restart.policy", policy);
    board_forget();
}

static void a_restart_neither_ends_one_nor_moves_what_it_left(void)
{
    static const char *const policies[] = {"hold", "resume"};
    for (unsigned k = 0; k < 2; k++) {
        with_lock();
        SETTINGS("mv2.max", "1.5", "mv2.rate", "0.01", "restart.policy", policies[k]);
        ask_ok("out bottom 1");
        samples(100);
        trip();
        reads(137);
        samples(1);
        TEST_ASSERT_TRUE(active());
        warm_reset(policies[k]);
        samples(2);
        TEST_ASSERT_TRUE(active());
        stays_at(2, 5);
        TEST_ASSERT_FALSE(board.command.safe);
        reads(115);
        stays_at(2, 5);
        TEST_ASSERT_FALSE(active());
        warm_reset(policies[k]); /* left in manual past its limits */
        samples(1);
        stays_at(2, 5);
    }
}

/* ---- whatever happens ---- */

static struct {
    double max, lock[2]; /* as set */
    double before;       /* last command */
    double asked;        /* by hand since; NaN: nothing */
    bool limits;         /* have changed since */
} now;

static void set_number(const char *name, double value)
{
    char line[80];
    snprintf(line, sizeof line, "set %s %g", name, value);
    ask_ok(line);
}

static void silence(void)
{
    board.mute = true;
    pass(2500);
    board.mute = false;
    plant_again();
    samples(1);
    now.before = heat();
}

static void something_happens(struct random_source *r)
{
    static const double T10s[] = {115, 120, 137, 145, 172, 172};
    static const double T1s[] = {85, 95, 105};
    static const char *const asks[] = {"mode bottom auto",   "mode bottom auto", "mode top auto",
                                       "mode bottom manual", "mode top manual",  "out top 4"};
    char line[80];
    switch (random_below(r, 12)) {
    case 0:
    case 1:
    case 2:
        reads(T10s[random_below(r, 6)]);
        break;
    case 3:
        board.quality[T10] = random_below(r, 2) ? QUALITY_BAD : QUALITY_MISSING;
        break;
    case 4:
        board.values[T1] = T1s[random_below(r, 3)];
        break;
    case 5:
    case 6:
        (void)ask(asks[random_below(r, 6)]); /* refused where it is not possible */
        break;
    case 7:
        snprintf(line, sizeof line, "out bottom %g", 0.5 + 0.1 * (double)random_below(r, 6));
        if (strcmp(ask(line), "ok") == 0)
            now.asked = strtod(line + 11, NULL);
        break;
    case 8:
        now.max = 1.2 + 0.3 * (double)random_below(r, 3);
        set_number("mv2.max", now.max);
        now.limits = true;
        break;
    case 9:
        now.lock[0] = 0.25 * (double)random_below(r, 9);
        set_number("lock1.value", now.lock[0]);
        break;
    case 10:
        set_number("lock1.delay", (double)random_below(r, 4));
        break;
    default:
        if (random_below(r, 4) == 0)
            silence();
        else
            set_number("loop2.gain", 1 + 0.1 * (double)random_below(r, 5));
    }
}

/* One sample, and what must be true of the command that answers it. */
static void is_as_it_must_be(const char *where)
{
    samples(1);
    double u = heat(), expected = now.before;
    ask_ok("alarm");
    bool lock1 = said("INTERLOCK_ON lock1"), lock2 = said("INTERLOCK_ON lock2");
    ask_ok("loop bottom");
    bool manual = said("bottom manual");
    if (lock1 || lock2)
        expected = lock1 ? now.lock[0] : now.lock[1];
    else if (board.command.safe)
        expected = 0.4;
    else if (!isnan(now.asked))
        expected = now.asked;
    else if (manual && now.limits && u != now.before)
        expected = now.before > now.max ? now.max : 0.5;
    else if (!manual)
        expected = u < 0.5 ? 0.5 : u > now.max ? now.max : u;
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-5, expected, u, where);
    now.before = u;
    now.asked = (double)NAN;
    now.limits = false;
}

static void whatever_happens_its_output_moves_only_by_what_acts_on_it(void)
{
    const uint64_t seed = 10;
    struct random_source r = {seed};
    char where[60];
    running();
    SETTINGS("mv2.min", "0.5", "mv2.max", "1.5", "mv2.safe", "0.4", "meas2.hold", "2",
             "loop1.decouple", "on", "loop2.decouple", "on", "decouple1.d2", "0.3", "decouple2.d1",
             "0.2", "lock1.meas", "T10", "lock1.mv", "heat", "lock1.limit", "140",
             "lock1.hysteresis", "5", "lock1.value", "0", "lock2.meas", "T1", "lock2.mv", "heat",
             "lock2.limit", "100", "lock2.value", "2");
    now.max = 1.5;
    now.lock[0] = 0;
    now.lock[1] = 2;
    now.asked = (double)NAN;
    now.limits = false;
    samples(1);
    now.before = heat();
    for (unsigned n = 0; n < 4000; n++) {
        snprintf(where, sizeof where, "seed %u, step %u", (unsigned)seed, n);
        something_happens(&r);
        is_as_it_must_be(where);
    }
}

/* At the console: it holds over the night, is refused while its condition lasts, and is released by a person. */
static void a_latched_one_is_released_at_the_console_and_not_before(void)
{
    running();
    SETTINGS("lock1.meas", "T10", "lock1.mv", "heat", "lock1.limit", "120", "lock1.hysteresis", "2",
             "lock1.value", "0", "lock1.latch", "on");
    samples(2);
    ask_refused("alarm release lock1", "STATE");
    TEST_ASSERT_TRUE_MESSAGE(said("does not hold"), board.said);
    ask_refused("alarm release lock9", "UNKNOWN");
    ask_refused("alarm release heat", "UNKNOWN");
    reads(125);
    samples(2);
    TEST_ASSERT_EQUAL_MESSAGE(1,
                              times_said("INTERLOCK_ON heat 125 interlock holds its output; "
                                         "measurement: lock1\n"),
                              board.said);
    TEST_ASSERT_TRUE_MESSAGE(
        listed("INTERLOCK_ON lock1 holds heat, T10 = 125 degC, limit 120 degC\n"), board.said);
    ask_refused("alarm release lock1", "STATE");
    TEST_ASSERT_TRUE_MESSAGE(said("holds for a reason that is not over"), board.said);
    reads(115);
    samples(3000);
    TEST_ASSERT_EQUAL_DOUBLE(0, heat());
    TEST_ASSERT_TRUE_MESSAGE(
        listed("T10 = 115 degC, limit 120 degC, until `alarm release lock1`\n"), board.said);
    board_forget();
    ask_ok("alarm release lock1");
    samples(2);
    TEST_ASSERT_FALSE(active());
    ask_ok("events");
    TEST_ASSERT_TRUE_MESSAGE(said("DO_ALARM lock1"), board.said);
    ask_ok("out heat 0.4");
    samples(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, heat());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_latched_one_is_released_at_the_console_and_not_before);
    RUN_TEST(a_number_that_is_good_by_the_plant_begins_it_whatever_came_before_and_stands_in);
    RUN_TEST(what_is_not_good_by_the_plant_begins_nothing_where_bad_does_not_count);
    RUN_TEST(a_sensor_that_dies_during_the_delay_does_not_begin_it_where_bad_does_not_count);
    RUN_TEST(samples_that_are_missing_when_the_delay_ends_do_not_begin_it_anew);
    RUN_TEST(its_delay_begins_anew_with_a_plant_whose_time_does);
    RUN_TEST(a_measurement_the_plant_no_longer_has_does_not_end_it);
    RUN_TEST(after_it_acted_in_the_safe_state_its_output_is_safe_and_stays_there);
    RUN_TEST(released_after_the_safe_state_has_ended_it_leaves_its_value);
    RUN_TEST(an_output_that_it_left_within_its_limits_is_not_called_outside);
    RUN_TEST(in_manual_an_output_stays_where_it_left_it_until_somebody_moves_it);
    RUN_TEST(no_acting_loop_goes_past_the_operating_limits_once_it_has_let_go);
    RUN_TEST(a_limit_that_was_narrower_for_a_while_brings_nothing_back_later);
    RUN_TEST(an_output_the_plant_does_not_have_comes_back_at_its_safe_value);
    RUN_TEST(silence_ends_what_it_forces_and_the_way_back_begins_safe);
    RUN_TEST(a_restart_neither_ends_one_nor_moves_what_it_left);
    RUN_TEST(whatever_happens_its_output_moves_only_by_what_acts_on_it);
    return UNITY_END();
}

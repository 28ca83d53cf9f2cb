/* Days of a board with everything in use, one odd thing after the other: what is typed, measured, lost, forced, reset and
 * set anew is drawn by chance, on a coarse grid, so that values meet limits and times meet delays exactly. What is typed, the
 * refusals, most events and every 64th row of telemetry are kept as they are; of all the rest, and of the commands to the
 * plant, a checksum so far. More such days are kept by their checksums alone.
 *
 * Kept in reference/days.txt, as the float build has it; how it is made anew is in support/kept_transcript.h. What is right
 * about it the other tests say. */
#include "base/crc32.h"
#include "board_bench.h"
#include "event_sum.h"
#include "kept_transcript.h"
#include "random_source.h"

#define INPUTS  6
#define OUTPUTS 4
#define ROWS    64 /* of telemetry, to one that is kept whole */
#define TIMES   4  /* each day: the first as it is, then by its checksums */
#define GRID    32 /* parts of a span */
#define TICK_MS 1000

static const char *const inputs[INPUTS] = {"a", "b", "c", "d", "e", "f"};
static const char *const outputs[OUTPUTS] = {"u", "v", "w", "x"};
static const double lowest[INPUTS] = {0, -64, 0, 100, 0, 0};
static const double spans[INPUTS] = {128, 128, 16, 200, 64, 1024};

static struct random_source source;
static struct {
    int steps[INPUTS]; /* of the grid */
    uint8_t quality[INPUTS];
    unsigned still[INPUTS]; /* ticks for which it is not moved */
    int off[OUTPUTS];       /* read-back, off the command, in hundredths of its span */
    bool readbacks;
    uint32_t sum;
    bool briefly; /* only checksums are kept */
    unsigned rows;
} day;

void setUp(void) {}
void tearDown(void) {}

/* ---- what is kept ---- */

static void sums(const char *line)
{
    day.sum = crc32_update(day.sum, line, strlen(line));
}

/* An event without its level and its text, which are those of its name; none of those that come all the time. */
static void says_event(const char *line)
{
    static const char *const often[] = {"MEASUREMENT_", "CONFIG_APPLIED", "FOLLOWING",
                                        "NOT_FOLLOWING"};
    char time[24], level[12], name[24], subject[24], value[24];
    if (sscanf(line, "! %23s %11s %23s %23s %23s", time, level, name, subject, value) != 5)
        TEST_FAIL_MESSAGE(line);
    for (unsigned i = 0; i < sizeof often / sizeof often[0]; i++)
        if (strncmp(name, often[i], strlen(often[i])) == 0)
            return;
    kept_line("%s %s %s %s", time, name, subject, value);
}

static void says(void)
{
    char *line = board.said;
    for (char *end; (end = strchr(line, '\n')) != NULL; line = end + 1) {
        *end = '\0';
        sums(line);
        if (strncmp(line, "err ", 4) == 0 && !day.briefly)
            kept_line("%s", line);
        else if (strncmp(line, "! ", 2) == 0 && !day.briefly)
            says_event(line);
        else if (strncmp(line, "T,", 2) == 0 && ++day.rows % ROWS == 0) {
            day.sum = event_sum(day.sum);
            kept_line("%08x %s", (unsigned)day.sum, day.briefly ? "" : line);
        }
    }
    board_forget();
}

static void types(const char *command)
{
    says();
    if (!day.briefly)
        kept_line("> %s", command);
    type(command);
    type("\n");
    says();
}

static void sums_command(void)
{
    char text[64];
    snprintf(text, sizeof text, "%u %d %u", (unsigned)board.command.number, board.command.safe,
             (unsigned)board.commands);
    sums(text);
    for (unsigned j = 0; j < OUTPUTS; j++) {
        snprintf(text, sizeof text, " %.9g %d", (double)board.command.output[j].value,
                 board.command.output[j].drive);
        sums(text);
    }
}

/* ---- the plant ---- */

static void announces(uint8_t index, struct link_page *page)
{
    bool output = index >= INPUTS;
    *page = (struct link_page){.index = index, .manipulated = output, .hi = 100, .safe = 5};
    if (!output)
        page->hi = 2000, page->lo = -1000;
    snprintf(page->name, sizeof page->name, "%s", output ? outputs[index - INPUTS] : inputs[index]);
    snprintf(page->unit, sizeof page->unit, "%s", output ? "%" : "K");
}

static void gives_sample(void)
{
    struct link_sample m = {.number = board.number,
                            .time_ms = board.time_ms,
                            .n_measurements = INPUTS,
                            .n_readback = day.readbacks ? OUTPUTS : 0};
    struct frame f;
    for (unsigned i = 0; i < INPUTS; i++) {
        m.measurement[i].value = (float)(lowest[i] + spans[i] / GRID * day.steps[i]);
        m.measurement[i].quality = day.quality[i];
    }
    for (unsigned j = 0; j < OUTPUTS; j++)
        m.readback[j].value = board.command.output[j].value + (float)day.off[j];
    pack_sample(&m, &f);
    link_give(&f);
    board_run();
}

static void next_sample(uint64_t after_ms)
{
    board.number++;
    board.time_ms += after_ms;
    gives_sample();
}

/* ---- chance ---- */

static bool once_in(uint32_t n)
{
    return random_below(&source, n) == 0;
}

static int from_to(int lo, int hi)
{
    return lo + (int)random_below(&source, (uint32_t)(hi - lo + 1));
}

static void plant_goes_on(void)
{
    for (unsigned i = 0; i < INPUTS; i++) {
        if (day.still[i]) {
            day.still[i]--;
            continue;
        }
        if (once_in(40))
            day.still[i] = (unsigned)from_to(3, 14);
        if (once_in(60))
            day.steps[i] = from_to(-8, GRID + 8);
        else
            day.steps[i] += from_to(-2, 2);
        day.steps[i] = day.steps[i] < -6 ? 3 : day.steps[i] > GRID + 6 ? GRID - 3 : day.steps[i];
        if (day.quality[i] ? once_in(4) : once_in(50))
            day.quality[i] = day.quality[i] ? 0 : (uint8_t)from_to(1, 3);
    }
    for (unsigned j = 0; j < OUTPUTS; j++)
        if (once_in(day.off[j] ? 6 : 30))
            day.off[j] = day.off[j] ? 0 : from_to(-4, 4);
    if (once_in(60))
        day.readbacks = !day.readbacks;
}

static void is_reset(enum hal_reset reason)
{
    if (!once_in(4)) {
        types("save");
        pass(500);
    }
    memory_port_reset(reason);
    board.ready = false;
    board_run();
    type("mode machine\nlog on\n");
    pass(1000);
    TEST_ASSERT_TRUE(board.ready);
}

static void something_odd(bool resets)
{
    switch (from_to(0, resets ? 9 : 7)) {
    case 0: /* twice */
        gives_sample();
        break;
    case 1: /* early, then at its time */
        next_sample(TICK_MS / 4);
        board.time_ms -= TICK_MS / 4;
        break;
    case 2:
        board.time_ms += TICK_MS * (uint64_t)from_to(1, 7);
        break;
    case 3: /* late, or a little early */
        board.time_ms += (uint64_t)(once_in(2) ? from_to(100, 400) : from_to(-125, -50));
        break;
    case 4: /* set back for good */
        board.time_ms -= board.time_ms > 60000 ? 50000 : 0;
        break;
    case 5:
        pass(TICK_MS * (uint64_t)from_to(1, 3));
        break;
    case 6: /* silent */
        board.mute = true;
        pass(4000);
        types("set loop1.gain 0.75");
        types("set loop1.name ly");
        pass(1000);
        types("loop");
        types("set loop1.name la");
        pass(1000);
        board.mute = false;
        pass(1500);
        break;
    case 7: /* another session, perhaps at another pace */
        board.tick_ms = once_in(2) ? 2 * TICK_MS : TICK_MS;
        board.session++;
        plant_hello();
        board_run();
        pass(600);
        break;
    default:
        for (int n = once_in(3) ? 5 : 1; n; n--) {
            is_reset(once_in(2) ? HAL_RESET_WATCHDOG : HAL_RESET_PIN);
            for (int ticks = from_to(1, 4); n > 1 && ticks; ticks--)
                next_sample(board.tick_ms);
        }
    }
}

/* ---- a day ---- */

static const char *const channels[] = {
    "set meas1.name a",  "set meas1.unit K",  "set meas1.hi 128",
    "set meas2.name b",  "set meas2.unit K",  "set meas2.lo -64",
    "set meas2.hi 64",   "set meas3.name c",  "set meas3.unit K",
    "set meas3.hi 16",   "set meas4.name d",  "set meas4.unit K",
    "set meas4.lo 100",  "set meas4.hi 300",  "set meas5.name e",
    "set meas5.unit K",  "set meas5.hi 64",   "set meas6.name f",
    "set meas6.unit K",  "set meas6.hi 1024", "set mv1.name u",
    "set mv1.unit %",    "set mv2.name v",    "set mv2.unit %",
    "set mv3.name w",    "set mv3.unit %",    "set mv4.name x",
    "set mv4.unit %",    "set mv1.safe 5",    "set mv2.safe 20",
    "set mv2.min 10",    "set mv2.max 90",    "set mv3.safe 8",
    "set mv3.min 12.5",  "set mv3.max 75",    "set mv4.safe 60",
    "set mv4.max 50",    "set mv1.follow 3",  "set mv1.band 0.02",
    "set mv2.band 0.03", "set mv4.rate 4",    NULL};

struct a_day {
    const char *name;
    const char *const *settings, *const *typed;
    unsigned n_typed, ticks;
    uint32_t odd; /* once in so many ticks */
    bool resets, saved;
};

static void begins(const struct a_day *d, bool briefly)
{
    memory_port_erase_all();
    power_on();
    memset(&day, 0, sizeof day);
    day.briefly = briefly;
    board.announce = announces;
    board.n_measurements = INPUTS;
    board.n_outputs = OUTPUTS;
    board.tick_ms = TICK_MS;
    for (unsigned i = 0; i < INPUTS; i++)
        day.steps[i] = GRID / 2;
    kept_line("# %s%s", d->name, briefly ? ", briefly" : "");
    ask_ok("begin");
    for (const char *const *s = channels; *s; s++)
        ask_ok(*s);
    for (const char *const *s = d->settings; *s; s++)
        ask_ok(*s);
    ask_ok("apply");
    if (d->saved)
        ask_ok("save");
    board.mute = false;
    pass(1000);
    TEST_ASSERT_TRUE(board.ready);
    type("log on\n");
}

static void is_lived(const struct a_day *d, bool briefly)
{
    begins(d, briefly);
    for (unsigned tick = 0; tick < d->ticks; tick++) {
        while (once_in(4))
            types(d->typed[random_below(&source, d->n_typed)]);
        plant_goes_on();
        next_sample(board.tick_ms);
        sums_command();
        says();
        if (once_in(d->odd)) {
            something_odd(d->resets);
            says();
        }
    }
    kept_line("%08x at the end", (unsigned)day.sum);
}

#define LIST(name, ...)                                                                            \
    static const char *const name[] = {__VA_ARGS__, NULL};                                         \
    enum { N_##name = sizeof name / sizeof name[0] - 1 }

LIST(single_loops, "set loop1.name la", "set loop1.pv a", "set loop1.out u", "set loop1.gain 1.5",
     "set loop1.ti 40", "set loop1.td 4", "set loop1.n 5", "set loop1.b 0.5", "set loop1.c 0.25",
     "set loop1.tt 6", "set loop1.sp_ramp 240", "set loop1.sp_filter 3", "set loop1.out_lo 0.125",
     "set loop1.out_hi 0.875", "set loop1.out_rate 0.0625", "set loop1.sp_lo 16",
     "set loop1.sp_hi 112", "set loop2.name lb", "set loop2.pv b", "set loop2.out v",
     "set loop2.algorithm velocity", "set loop2.action direct", "set loop2.gain 0.8",
     "set loop2.ti 25", "set loop2.td 3", "set loop2.divisor 2", "set loop2.phase 1",
     "set loop2.inhibit 6", "set loop2.sp_track off", "set loop3.name lc", "set loop3.pv c",
     "set loop3.out w", "set loop3.algorithm two_position", "set loop3.band 1",
     "set loop3.out_lo 0.25", "set loop3.out_hi 0.75", "set loop3.sp_ramp 30", "set ff1.from e",
     "set ff1.to u", "set ff1.gain 0.5", "set ff1.lead 6", "set ff1.lag 3", "set ff1.dead 4",
     "set ff1.reference 32", "set ff1.lo -0.25", "set ff1.hi 0.125", "set ff2.from x",
     "set ff2.to v", "set ff2.gain -0.25", "set ff2.reference 50", "set lock1.meas a",
     "set lock1.mv u", "set lock1.limit 108", "set lock1.hysteresis 8", "set lock1.delay 2",
     "set lock1.value 0", "set lock2.meas b", "set lock2.mv v", "set lock2.side below",
     "set lock2.limit -40", "set lock2.hysteresis 4", "set lock2.value 95", "set lock2.on_bad off",
     "set lock3.meas d", "set lock3.mv u", "set lock3.limit 275", "set lock3.value 100",
     "set alarm1.on a", "set alarm1.side hi", "set alarm1.limit 96", "set alarm1.hysteresis 8",
     "set alarm1.delay 3", "set alarm1.group a", "set alarm2.on a", "set alarm2.side hi_hi",
     "set alarm2.limit 112", "set alarm2.group a", "set alarm2.latch on",
     "set alarm2.priority high", "set alarm3.on la", "set alarm3.side deviation",
     "set alarm3.limit 20", "set alarm3.hysteresis 4", "set alarm3.delay 2", "set alarm4.on b",
     "set alarm4.side lo", "set alarm4.limit -24", "set alarm4.hysteresis 8", "set alarm4.group b",
     "set alarm4.latch on", "set alarm5.on b", "set alarm5.side lo_lo", "set alarm5.limit -40",
     "set alarm5.group b", "set alarm6.on lb", "set alarm6.side deviation", "set alarm6.limit 12");

LIST(single_typed, "mode la auto", "mode lb auto", "mode lc auto", "mode la manual",
     "mode lb manual", "mode lc manual", "sp la 64", "sp la 80", "sp la 24", "sp lb 0", "sp lb 32",
     "sp lb -24", "sp lc 8", "sp lc 12", "out la 50", "out la 5", "out lb 20", "out lb 95",
     "out lc 8", "out lc 70", "out x 10", "out x 60", "out x 40", "mode la auto", "mode lb auto",
     "mode lc auto", "set loop1.gain 2.5", "set loop1.gain 1.5", "set loop1.ti 0",
     "set loop1.ti 40", "set loop1.td 0", "set loop1.td 4", "set loop2.td 0", "set loop2.inhibit 0",
     "set loop2.td 5", "set loop2.inhibit 6", "set loop1.out_rate 0", "set loop1.out_rate 0.03125",
     "set loop3.band 2", "set loop3.action direct", "set loop3.action reverse", "alarm ack all",
     "alarm ack a.hi", "alarm ack a.hi_hi", "alarm ack alarm4", "alarm shelve a.hi 12",
     "alarm shelve b.lo 7", "alarm shelve a.hi 0", "set alarm1.limit 84", "set alarm1.limit 96",
     "alarm ack la.dev", "set lock1.delay 0", "set lock1.delay 4", "set ff1.gain 0.25", "alarm",
     "set ff1.dead 2", "set ff1.dead 4", "set loop1.sp_filter 0", "set loop1.sp_ramp 0", "loop la",
     "set loop1.sp_filter 2", "set loop1.sp_ramp 120", "loop lc", "loop lb");

LIST(joined_loops, "set loop1.name la", "set loop1.pv a", "set loop1.out u", "set loop1.gain 0.9",
     "set loop1.ti 20", "set loop1.decouple on", "set loop2.name lb", "set loop2.pv b",
     "set loop2.out v", "set loop2.gain 0.7", "set loop2.ti 30", "set loop2.td 2",
     "set loop2.decouple on", "set loop2.action direct", "set decouple1.d2 0.5",
     "set decouple2.d1 -0.25", "set decouple2.d2 1.5", "set loop3.name lo", "set loop3.pv c",
     "set loop3.out la", "set loop3.gain 1.2", "set loop3.ti 60", "set loop3.divisor 3",
     "set loop3.phase 2", "set loop3.out_lo 0.25", "set loop3.out_hi 0.75", "set loop4.name lq",
     "set loop4.pv e", "set loop4.out lo", "set loop4.gain 0.5", "set loop4.ti 90",
     "set loop4.algorithm velocity", "set loop1.sp_hi 96", "set loop1.sp_lo 8", "set loop5.name lw",
     "set loop5.pv d", "set loop5.out w", "set loop5.gain 1", "set loop5.ti 15",
     "set loop5.out_rate 0.0625", "set ff1.from d", "set ff1.to u", "set ff1.gain 0.25",
     "set ff1.lag 5", "set ff1.reference 200", "set ff2.from w", "set ff2.to v",
     "set ff2.gain -0.5", "set ff2.dead 3", "set ff2.reference 40", "set lock1.meas f",
     "set lock1.mv v", "set lock1.limit 768", "set lock1.value 12.5", "set lock2.meas f",
     "set lock2.mv u", "set lock2.side below", "set lock2.limit 256", "set lock2.value 77",
     "set mv1.rate 10", "set loop1.sp_ramp 120", "set loop1.sp_filter 4", "set alarm1.on lo",
     "set alarm1.side deviation", "set alarm1.limit 2", "set alarm2.on la",
     "set alarm2.side deviation", "set alarm2.limit 16", "set alarm2.delay 5");

LIST(joined_typed, "mode la auto", "mode la cascade", "mode la cascade", "mode la cascade",
     "mode lo cascade", "mode lo cascade", "mode lq auto", "mode lq auto", "mode la manual",
     "mode lb auto", "mode lb auto", "mode lb manual", "mode lo cascade", "mode lo cascade",
     "mode lo manual", "mode lq auto", "mode lw auto", "mode lw manual", "sp la 64", "sp la 90",
     "sp lb 8", "sp lb -16", "sp lo 8", "sp lo 4", "sp lq 32", "sp lq 48", "sp lw 200", "sp lw 260",
     "out la 30", "out lb 60", "out lo 40", "out lo 90", "out lq 4", "out lq 12", "out lw 30",
     "out x 30", "set loop1.decouple off", "set loop1.decouple on", "set decouple1.d2 0.75",
     "set decouple1.d2 0.5", "loop lo", "loop lq", "loop la", "set mv1.max 80", "set mv1.max 100",
     "set loop3.gain 2", "set loop3.gain 1.2", "set loop1.sp_hi 80", "set loop1.sp_hi 96", "alarm",
     "status", "set loop5.out_hi 0.5", "set loop5.out_hi 1", "set ff1.gain 0", "set ff1.gain 0.25",
     "set ff2.from -", "set ff2.from w", "set decouple2.d1 4", "set decouple2.d1 -0.25");

LIST(instruments, "set meas1.filter 4", "set meas1.hold 3", "set meas1.frozen 6",
     "set meas2.fallback substitute", "set meas2.substitute 16", "set meas2.hold 2",
     "set meas2.rate_limit 16", "set meas2.filter 2", "set meas3.fallback manual",
     "set meas3.rate_limit 1", "set meas4.fallback safe", "set meas4.hold 8", "set meas4.frozen 12",
     "set meas5.infer u", "set meas5.infer_gain 0.5", "set meas5.infer_offset 8",
     "set meas5.hold 2", "set meas6.fallback hold", "set meas6.hold 5", "set meas6.filter 1",
     "set loop1.name la", "set loop1.pv a", "set loop1.out u", "set loop1.ti 30",
     "set loop2.name lb", "set loop2.pv b", "set loop2.out v", "set loop2.ti 20",
     "set loop2.divisor 4", "set loop3.name lc", "set loop3.pv c", "set loop3.out w",
     "set loop3.ti 50", "set loop4.name ld", "set loop4.pv d", "set loop4.out x", "set loop4.ti 10",
     "set lock1.meas c", "set lock1.mv w", "set lock1.limit 13", "set lock1.delay 3",
     "set lock1.hysteresis 1", "set lock1.value 0", "set lock2.meas e", "set lock2.mv x",
     "set lock2.limit 56", "set lock2.value 33", "set lock2.on_bad off", "set lock2.delay 2",
     "set lock3.meas f", "set lock3.mv v", "set lock3.side below", "set lock3.limit 128",
     "set lock3.value 10", "set lock4.meas b", "set lock4.mv u", "set lock4.limit 52",
     "set lock4.value 3", "set lock4.hysteresis 12", "set alarm1.on b", "set alarm1.side lo",
     "set alarm1.limit -32", "set alarm1.delay 4", "set alarm2.on e", "set alarm2.side hi",
     "set alarm2.limit 40", "set alarm3.on c", "set alarm3.side hi_hi", "set alarm3.limit 12",
     "set alarm3.delay 3", "set alarm3.latch on", "set tick.miss_limit 4");

LIST(instruments_typed, "mode la auto", "mode lb auto", "mode lc auto", "mode ld auto",
     "mode la auto", "mode lb auto", "mode lc auto", "mode ld auto", "mode la manual", "sp la 60",
     "sp lb 10", "sp lc 9", "sp ld 210", "out la 30", "out lb 30", "out lc 30", "out ld 30",
     "status", "alarm", "set meas1.filter 0", "set meas1.filter 4", "set meas1.lo -32",
     "set meas1.lo 0", "set meas2.rate_limit 0", "set meas2.rate_limit 16", "set meas4.hold 0",
     "set meas4.hold 8", "set meas5.infer -", "set meas5.infer u", "set lock1.delay 0",
     "set lock1.delay 3", "set lock2.on_bad on", "set lock2.on_bad off", "alarm ack all",
     "alarm shelve b.lo 60", "alarm shelve c.hi_hi 90", "alarm shelve e.hi 30",
     "set meas3.fallback hold", "set meas3.fallback manual", "set mv1.hi 200", "set mv1.hi 100",
     "set meas6.fallback safe", "set meas6.fallback hold");

LIST(restarts, "set restart.policy resume", "set restart.limit 20", "set loop1.name la",
     "set loop1.pv a", "set loop1.out u", "set loop1.ti 30", "set loop1.sp_ramp 60",
     "set loop2.name lb", "set loop2.pv b", "set loop2.out v", "set loop2.ti 20",
     "set loop2.sp_filter 5", "set loop3.name lc", "set loop3.pv c", "set loop3.out la",
     "set loop3.ti 90", "set lock1.meas d", "set lock1.mv v", "set lock1.limit 262.5",
     "set lock1.hysteresis 50", "set lock1.value 96", "set lock2.meas e", "set lock2.mv w",
     "set lock2.limit 48", "set lock2.hysteresis 16", "set lock2.value 2", "set alarm1.on a",
     "set alarm1.limit 90");

LIST(restarts_typed, "mode la cascade", "mode lb auto", "mode lc auto", "mode la cascade",
     "mode lc auto", "mode la cascade", "mode lb auto", "mode lc auto", "mode la manual",
     "sp la 70", "sp lb 12", "sp lb -24", "sp lc 10", "sp lc 6", "out la 40", "out lb 44",
     "out w 50", "out w 25", "out x 20", "out x 30", "set restart.policy hold",
     "set restart.policy resume", "set restart.policy resume", "set restart.policy resume",
     "set restart.policy safe", "set restart.limit 2", "set restart.limit 20", "status", "alarm");

LIST(rows, "set restart.policy hold", "set meas5.offset 8", "set meas3.offset 1",
     "set loop1.name la", "set loop1.pv a", "set loop1.out u", "set loop1.ti 30",
     "set loop2.name lc", "set loop2.pv c", "set loop2.out v", "set loop2.ti 20",
     "set lock1.meas d", "set lock1.mv w", "set lock1.limit 262.5", "set lock1.value 12.65",
     "set lock2.meas e", "set lock2.mv w", "set lock2.limit 48", "set lock2.value 50.08",
     "set lock3.meas f", "set lock3.mv u", "set lock3.limit 800", "set lock3.value 77",
     "set step1.seq start", "set step1.do guard", "set step1.until above", "set step1.meas f",
     "set step1.limit 128", "set step1.hold 4", "set step1.else hold", "set step2.seq start",
     "set step2.do out", "set step2.what w", "set step2.value 50", "set step2.until time",
     "set step2.hold 3", "set step3.seq start", "set step3.do auto", "set step3.what la",
     "set step3.until steady", "set step3.meas e", "set step3.limit 8", "set step3.hold 3",
     "set step3.timeout 12", "set step3.else go_on", "set step4.seq start",
     "set step4.do offset_on", "set step4.what c", "set step4.until below", "set step4.meas b",
     "set step4.limit 16", "set step4.hold 2", "set step4.timeout 20", "set step4.else hold",
     "set step5.seq start", "set step5.do sp", "set step5.what la", "set step5.value 72",
     "set step5.until confirm", "set step5.timeout 30", "set step6.seq start", "set step6.do auto",
     "set step6.what lc", "set step7.seq start", "set step7.do drop", "set step7.what f",
     "set step8.seq stop", "set step8.do manual", "set step8.what la", "set step8.until above",
     "set step8.meas a", "set step8.limit 8", "set step8.timeout 5", "set step9.seq stop",
     "set step9.do offset_off", "set step9.what c", "set step10.seq stop", "set step10.do out",
     "set step10.what u", "set step10.value 5", "set step11.seq stop", "set step11.do out",
     "set step11.what w", "set step11.value 12.5", "set step11.until time", "set step11.hold 2");

LIST(rows_typed, "seq start", "seq start", "seq stop", "seq hold", "seq go", "seq go", "seq go",
     "seq confirm", "seq confirm", "seq confirm", "seq skip", "seq abort", "seq", "seq", "seq list",
     "mode la manual", "out x 20", "out w 30", "mode lc manual", "mode la manual", "seq go",
     "seq start", "status", "set loop1.gain 2", "set step5.value 64");

LIST(changes, "set meas1.frozen 5", "set loop1.name la", "set loop1.pv a", "set loop1.out u",
     "set loop1.ti 30", "set loop2.name lb", "set loop2.pv b", "set loop2.out v", "set loop2.ti 20",
     "set loop2.td 3", "set loop3.name lc", "set loop3.pv c", "set loop3.out lb", "set loop3.ti 90",
     "set ff1.from e", "set ff1.to u", "set ff1.gain 0.5", "set ff1.dead 5", "set ff1.reference 32",
     "set lock1.meas a", "set lock1.mv u", "set lock1.limit 104", "set lock1.value 4",
     "set alarm1.on a", "set alarm1.limit 80", "set alarm2.on lb", "set alarm2.side deviation",
     "set alarm2.limit 8");

LIST(changes_typed, "mode la auto", "mode lb auto", "mode lb cascade", "mode lc auto",
     "mode la auto", "mode lb cascade", "mode lc auto", "sp la 70", "sp lb 12", "sp lc 9",
     "out w 50", "set loop1.algorithm velocity", "set loop1.algorithm positional",
     "set loop1.algorithm two_position", "set loop1.band 4", "set loop1.out u", "set loop1.out x",
     "set loop3.out la", "set loop3.out lb", "set loop3.name -", "set loop3.name lc",
     "set loop1.name lz", "set loop1.name la", "set mv1.name -", "set mv1.name u", "set mv1.hi 120",
     "set mv1.hi 100", "set meas1.name -", "set meas1.name a", "set meas1.hi 160",
     "set meas1.hi 128", "set meas2.hi 96", "set meas2.hi 64", "set loop2.decouple on",
     "set loop1.decouple on", "set loop1.decouple off", "set loop2.decouple off",
     "set decouple1.d2 0.5", "set decouple1.d2 0", "set ff1.to v", "set ff1.to u", "set ff1.from f",
     "set ff1.from e", "set ff1.from g", "set meas7.name g", "set ff1.to v", "set ff2.from v",
     "set ff2.to u", "set ff2.gain 0.25", "set ff2.from -", "set lock1.side below",
     "set lock1.side above", "set lock1.meas b", "set lock1.meas a", "set alarm1.side lo",
     "set alarm1.side hi", "set alarm2.side hi", "set alarm1.group c", "set alarm1.group none",
     "set loop1.divisor 3", "set loop1.divisor 1", "set loop2.phase 1", "set loop1.sp_lo 64",
     "set loop1.sp_lo 0", "set loop1.sp_hi 100", "set loop2.sp_filter 4", "set loop2.sp_filter 0",
     "set meas1.unit C", "set meas1.unit K", "begin", "apply", "abandon", "apply", "diff", "alarm",
     "set tick.base 2", "set tick.base 0", "set loop1.inhibit 20", "set loop1.td 6",
     "set meas2.filter 3", "set loop2.action direct", "set loop2.action reverse", "defaults",
     "load", "load", "save", "set loop1.out_lo 1", "set loop1.out_lo 0.25");

#define DAY(title, with, types, length, once, reset, store)                                        \
    {                                                                                              \
        .name = title, .settings = with, .typed = types, .n_typed = N_##types, .ticks = length,    \
        .odd = once, .resets = reset, .saved = store                                               \
    }

static const struct a_day days[] = {
    DAY("single loops", single_loops, single_typed, 600, 60, false, false),
    DAY("cascades and a decoupler", joined_loops, joined_typed, 600, 60, false, false),
    DAY("instruments that fail", instruments, instruments_typed, 600, 30, false, false),
    DAY("resets", restarts, restarts_typed, 500, 8, true, true),
    DAY("sequences", rows, rows_typed, 600, 80, true, true),
    DAY("changes", changes, changes_typed, 600, 90, false, true),
};

static void days_are_lived_as_they_were(void)
{
    source.state = 20261123u;
    kept_open("reference/days.txt");
    for (unsigned i = 0; i < sizeof days / sizeof days[0]; i++)
        for (unsigned n = 0; n < TIMES; n++)
            is_lived(&days[i], n > 0);
    kept_close();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(days_are_lived_as_they_were);
    return UNITY_END();
}

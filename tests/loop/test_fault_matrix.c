/* Every fault in every mode of operation, and the state each must end in.
 *
 * The whole firmware on the board in memory, its plant a small linear column behind the bench's own instruments,
 * which make the faults. To add a fault: a row of faults[]. To add a mode: a row of modes[].
 */
#include "app/app.h"
#include "base/workspace.h"
#include "fault_bench.h"

/* ---- modes of operation ---- */

static void manual(void)
{
    ask_ok("out bottom 1");
}
static void automatic(void)
{
    ask_ok("mode bottom auto");
    ask_ok("sp bottom 118");
    ask_ok("mode flow auto");
}
static void cascade(void)
{
    ask_ok("mode bottom auto");
    ask_ok("mode outer auto");
    step();
    ask_ok("mode bottom cascade");
    ask_ok("sp outer 102");
    ask_ok("mode flow auto");
}
static void saturated(void)
{
    ask_ok("mode bottom auto");
    ask_ok("sp bottom 158"); /* 1.6 kW give 139 */
    ask_ok("mode flow auto");
}

/* Rest, then the positive half of the first test. */
static void commissioning(void)
{
    ask_ok("out flow 5");
    ask_ok("out bottom 1");
    steps(300);
    ask_ok("commission begin");
}

static const struct mode {
    const char *name;
    void (*enter)(void);
    const char *bottom, *outer, *flow; /* modes of the loops then */
    const char *command;               /* given every ten samples while the fault lasts */
    const char *needs;                 /* a command that this build must have */
} modes[] = {
    {"manual", manual, "manual", "manual", "manual", NULL, NULL},
    {"auto", automatic, "auto", "manual", "auto", NULL, NULL},
    {"cascade", cascade, "cascade", "auto", "auto", NULL, NULL},
    {"saturated", saturated, "auto", "manual", "auto", NULL, NULL},
    {"saving", automatic, "auto", "manual", "auto", "save", "save"},
    {"commissioning", commissioning, "manual", "manual", "manual", NULL, "commission"},
};
#define MODES (sizeof modes / sizeof modes[0])

/* ---- faults ---- */

static void silent_link(void)
{
    board.mute = true;
    pass(3000);
    board.mute = false;
    pass(1000);
    TEST_ASSERT_TRUE(board.ready);
}
static void plant_restart(void)
{
    board.session++;
    board.number = 0;
    board.time_ms = 0;
    plant_hello();
    board_run();
    pass(1000);
    TEST_ASSERT_TRUE(board.ready);
}
static void one_sample_lost(void)
{
    board.time_ms += 1000;
}
static void many_samples_lost(void)
{
    board.time_ms += 20000;
}
static void lost_frame(void)
{
    static const uint8_t noise[] = {7, 1, 2, 3, 4, 5, 6, 0, 99, 98, 0};
    (void)memory_port_give(HAL_UART_LINK, noise, sizeof noise);
    board_run();
}

static void plant_that_does_not_wait(void)
{
    waits = false;
}

/* Somebody else wants it: whoever comes second is told who has it. */
static void workspace_wanted_by_two(void)
{
#if WORKSPACE_BYTES
    void *memory;
    char text[120];
    struct text refusal = text_on(text, sizeof text);
    struct workspace *w = app_workspace(app_instance());
    ask_ok("commission");
    bool idle = said("phase idle");
    ask_ok("loop");
    bool at_rest = idle && !said(" auto ") && !said(" cascade ");
    enum err got = workspace_lease(w, "covariances", "block est freeze", w->bytes, &memory);
    TEST_ASSERT_EQUAL(idle ? ERR_OK : ERR_BUSY, got);
    if (!idle) {
        workspace_refusal(w, &refusal);
        TEST_ASSERT_EQUAL_STRING("start-up has it; `commission abort` frees it", text);
        return;
    }
    memset(memory, 0xFF, w->bytes);
    ask_refused("commission begin", at_rest ? "BUSY" : "STATE");
#endif
}

/* States to end in. Interlock lock1 cuts the heater when T10 is too hot, or lost for longer than its hold. */
enum end {
    SAME,          /* modes as they were, nothing forced */
    LOST,          /* bottom in manual, heater cut by the interlock, T10 reported */
    SAFE,          /* all manual, safe values */
    INFERRED,      /* modes as they were, flow taken from the valve */
    OUTER_LOST,    /* outer in manual at once, the rest as it was */
    NOT_FOLLOWING, /* modes as they were, the output reported */
    TRIPPED        /* the same, and the interlock cuts the heater: T10 is too hot */
};

#define LOST_READING "measurement is not valid"
#define AT_END       "reads an end of its span"

static const struct fault {
    const char *name;
    const char *begin, *begin_too; /* events of the instruments */
    const char *end, *end_too;
    void (*act)(void);
    enum end state;
    const char *ends_test; /* why a test of automatic start-up ends; NULL: it goes on */
} faults[] = {
    {"noise", "T10.noise=0.5", NULL, "T10.noise=0.05", NULL, NULL, SAME, NULL},
    {"drift", "T10.drift=36", NULL, "T10.drift=0", NULL, NULL, SAME, NULL},
    {"bias step", "T10.bias=-4", NULL, "T10.bias=0", NULL, NULL, SAME, NULL},
    {"spikes", "T10.spike=20", "T10.spike_rate=360", "T10.spike_rate=0", NULL, NULL, SAME, NULL},
    {"lost samples of one channel", "T10.dropout=0.4", NULL, "T10.dropout=0", NULL, NULL, SAME,
     LOST_READING},
    {"quantisation", "T10.resolution=0.1", NULL, "T10.resolution=0", NULL, NULL, SAME, NULL},
    {"slow sensor", "T10.lag=5", NULL, "T10.lag=0", NULL, NULL, SAME, NULL},
    {"frozen", "T10.frozen=1", NULL, "T10.free=1", NULL, NULL, LOST, LOST_READING},
    {"stuck elsewhere", "T10.stuck=100", NULL, "T10.free=1", NULL, NULL, LOST, LOST_READING},
    {"flagged bad", "T10.quality=2", NULL, "T10.quality=0", NULL, NULL, LOST, LOST_READING},
    {"missing", "T10.quality=3", NULL, "T10.quality=0", NULL, NULL, LOST, LOST_READING},
    {"not a number", "T10.nan=1", NULL, "T10.nan=0", NULL, NULL, LOST, LOST_READING},
    {"burnt out, high", "T10.stuck=200", NULL, "T10.free=1", NULL, NULL, LOST, AT_END},
    {"burnt out, low", "T10.dead=1", NULL, "T10.free=1", NULL, NULL, LOST, AT_END},
    {"safe channel missing", "T1.quality=3", NULL, "T1.quality=0", NULL, NULL, SAFE, LOST_READING},
    {"safe channel not a number", "T1.nan=1", NULL, "T1.nan=0", NULL, NULL, SAFE, LOST_READING},
    {"safe channel frozen", "T1.frozen=1", NULL, "T1.free=1", NULL, NULL, SAFE, LOST_READING},
    {"outer measurement flagged", "T5.quality=2", NULL, "T5.quality=0", NULL, NULL, OUTER_LOST,
     LOST_READING},
    {"outer measurement not a number", "T5.nan=1", NULL, "T5.nan=0", NULL, NULL, OUTER_LOST,
     LOST_READING},
    {"flowmeter dead", "flow.dead=1", NULL, "flow.free=1", NULL, NULL, INFERRED, AT_END},
    {"flowmeter missing", "flow.quality=3", NULL, "flow.quality=0", NULL, NULL, INFERRED,
     LOST_READING},
    {"flowmeter frozen", "flow.frozen=1", NULL, "flow.free=1", NULL, NULL, INFERRED, LOST_READING},
    {"no read-back", "heat.readback=0", NULL, "heat.readback=1", NULL, NULL, SAME, NULL},
    {"heater failure", "heat.stuck=0", NULL, "heat.free=1", NULL, NULL, NOT_FOLLOWING,
     "the output does not follow its command"},
    {"heater failure, unseen", "heat.stuck=0.2", "heat.readback=2", "heat.free=1",
     "heat.readback=1", NULL, SAME, "went past its test limit"},
    {"heater full on", "heat.stuck=2", NULL, "heat.free=1", NULL, NULL, TRIPPED,
     "the output does not follow its command"},
    {"valve stiction", "heat.stiction=0.02", NULL, "heat.stiction=0", NULL, NULL, SAME, NULL},
    {"slow valve", "heat.slew=0.05", NULL, "heat.slew=0", NULL, NULL, SAME, NULL},
    {"feed loss", "F=0", NULL, "F=5", NULL, NULL, SAME, NULL},
    {"link silent", NULL, NULL, NULL, NULL, silent_link, SAFE, "safe state"},
    {"plant restarted", NULL, NULL, NULL, NULL, plant_restart, SAFE, "safe state"},
    {"one sample lost", NULL, NULL, NULL, NULL, one_sample_lost, SAME, NULL},
    {"many samples lost", NULL, NULL, NULL, NULL, many_samples_lost, SAFE, "safe state"},
    {"broken frames", NULL, NULL, NULL, NULL, lost_frame, SAME, NULL},
    {"job late: the plant does not wait", NULL, NULL, NULL, NULL, plant_that_does_not_wait, SAME,
     NULL},
    {"workspace refused", NULL, NULL, NULL, NULL, workspace_wanted_by_two, SAME, NULL},
};
#define FAULTS (sizeof faults / sizeof faults[0])

/* ---- the run ---- */

static void configure_matrix(void)
{
    static const char *const lines[] = {
        "meas1.name T1",      "meas1.unit degC",
        "meas1.lo 60",        "meas1.hi 160",
        "meas1.hold 10",      "meas1.fallback safe",
        "meas1.frozen 60",    "meas2.name T10",
        "meas2.unit degC",    "meas2.lo 60",
        "meas2.hi 160",       "meas2.hold 10",
        "meas2.rate_limit 3", "meas2.frozen 60",
        "meas3.name flow",    "meas3.unit l/h",
        "meas3.lo 2",         "meas3.hi 12",
        "meas3.frozen 60",    "meas3.infer reflux",
        "meas3.infer_gain 1", "meas4.name T5",
        "meas4.unit degC",    "meas4.lo 60",
        "meas4.hi 160",       "meas4.fallback manual",
        "mv1.name reflux",    "mv1.unit l/h",
        "mv1.hi 10",          "mv1.max 10",
        "mv1.safe 5",         "mv2.name heat",
        "mv2.unit kW",        "mv2.hi 2",
        "mv2.max 1.6",        "mv2.safe 0.25",
        "mv2.band 0.05",      "mv2.follow 10",
        "loop1.name flow",    "loop1.pv flow",
        "loop1.out reflux",   "loop1.gain 0.5",
        "loop1.ti 10",        "loop2.name bottom",
        "loop2.pv T10",       "loop2.out heat",
        "loop2.gain 1",       "loop2.ti 60",
        "loop3.name outer",   "loop3.pv T5",
        "loop3.out bottom",   "loop3.gain 0.5",
        "loop3.ti 100",       "lock1.meas T10",
        "lock1.mv heat",      "lock1.limit 150",
        "lock1.hysteresis 5", "lock1.value 0",
        "alarm1.on bottom",   "alarm1.side deviation",
        "alarm1.limit 20",    "alarm1.delay 60",
    };
    char line[80];
    ask_ok("begin");
    for (unsigned i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        snprintf(line, sizeof line, "set %s", lines[i]);
        ask_ok(line);
    }
    ask_ok("apply");
}

static void begin(const struct mode *mode)
{
    power_on();
    board.names[2] = "flow";
    board.names[3] = "T5";
    board.units[3] = "degC";
    memset(&column, 0, sizeof column);
    for (unsigned i = 0; i < CHANNELS; i++)
        column.value[i] = channels[i].nominal;
    column.value[T1] = 85;
    column.value[T10] = 115;
    column.value[FLOW] = 5;
    column.value[T5] = 100;
    TEST_ASSERT_TRUE(instruments_init(&instruments, &class, 7, 1.0, err, sizeof err));
    configure_matrix();
    connect_plant();
    steps(2);
    ask_ok("out bottom 1");
    ask_ok("out flow 5");
    steps(3);
    mode->enter();
    steps(300);
    board_forget();
}

static void check_modes(const char *bottom, const char *outer, const char *flow, const char *where)
{
    TEST_ASSERT_TRUE_MESSAGE(loop_is("bottom", bottom), where);
    TEST_ASSERT_TRUE_MESSAGE(loop_is("outer", outer), where);
    TEST_ASSERT_TRUE_MESSAGE(loop_is("flow", flow), where);
}

static void check_end(const struct fault *fault, const struct mode *mode, const char *where)
{
    enum end end = fault->state;
    bool safe = end == SAFE, lost = end == LOST, cut = lost || end == TRIPPED;
    bool deaf = end == NOT_FOLLOWING || end == TRIPPED;
    TEST_ASSERT_EQUAL_MESSAGE(safe, board.command.safe, where);
    TEST_ASSERT_EQUAL_MESSAGE(cut, alarm_says("INTERLOCK_ON lock1"), where);
    TEST_ASSERT_TRUE_MESSAGE(!lost || alarm_says("MEASUREMENT_BAD T10"), where);
    TEST_ASSERT_EQUAL_MESSAGE(deaf, alarm_says("NOT_FOLLOWING heat"), where);
    TEST_ASSERT_EQUAL_MESSAGE(end == INFERRED, alarm_says("MEASUREMENT_BAD flow"), where);
    TEST_ASSERT_TRUE_MESSAGE(quality_is("flow", end == INFERRED ? "uncertain" : "good"), where);
    if (cut)
        TEST_ASSERT_EQUAL_FLOAT_MESSAGE(0.0f, board.command.output[1].value, where);
    if (safe) {
        TEST_ASSERT_EQUAL_FLOAT_MESSAGE(5.0f, board.command.output[0].value, where);
        TEST_ASSERT_EQUAL_FLOAT_MESSAGE(0.25f, board.command.output[1].value, where);
        check_modes("manual", "manual", "manual", where);
    } else if (lost) {
        check_modes("manual", mode->outer, mode->flow, where);
    } else {
        check_modes(mode->bottom, end == OUTER_LOST ? "manual" : mode->outer, mode->flow, where);
    }
}

/* Judges the test: where it has ended, the outputs are where they were held, unless something stronger has them. */
static void check_test(const struct fault *fault, const char *where)
{
    bool cut = fault->state == LOST || fault->state == TRIPPED;
    ask_ok("commission");
    if (!fault->ends_test) {
        TEST_ASSERT_TRUE_MESSAGE(said("phase testing"), where);
        return;
    }
    TEST_ASSERT_TRUE_MESSAGE(said("phase ended"), where);
    TEST_ASSERT_TRUE_MESSAGE(said(fault->ends_test), where);
    TEST_ASSERT_EQUAL_FLOAT_MESSAGE(5.0f, board.command.output[0].value, where);
    if (fault->state != SAFE && !cut)
        TEST_ASSERT_EQUAL_FLOAT_MESSAGE(1.0f, board.command.output[1].value, where);
}

static char before[3][400];

static void remember_loops(void)
{
    const char *const names[] = {"bottom", "outer", "flow"};
    for (unsigned k = 0; k < 3; k++)
        for (unsigned m = 0; m < 3; m++) {
            static const char *const words[] = {"manual", "auto", "cascade"};
            if (loop_is(names[k], words[m]))
                snprintf(before[k], sizeof before[k], "%s", words[m]);
        }
}

static void one_combination(const struct fault *fault, const struct mode *mode)
{
    char where[120];
    snprintf(where, sizeof where, "%s in %s", fault->name, mode->name);
    begin(mode);
    event(fault->begin);
    event(fault->begin_too);
    if (fault->act)
        fault->act();
    for (unsigned n = 0; n < (waits ? 150u : 150u / AT_ONCE); n++) {
        step();
        if (mode->command && n % 10 == 0)
            (void)ask(mode->command);
    }
    check_end(fault, mode, where);
    if (mode->enter == commissioning)
        check_test(fault, where);
    if (mode->enter == commissioning) {
        ask_ok("events");
        TEST_ASSERT_EQUAL_MESSAGE(!waits, said("JOB_LATE start-up"), where);
    }
    waits = true;
    /* Repaired: alarms go, and nothing begins to act of itself. */
    remember_loops();
    event(fault->end);
    event(fault->end_too);
    steps(100);
    check_modes(before[0], before[1], before[2], where);
    TEST_ASSERT_FALSE_MESSAGE(alarm_says("MEASUREMENT_BAD"), where);
    TEST_ASSERT_FALSE_MESSAGE(alarm_says("NOT_FOLLOWING"), where);
    TEST_ASSERT_FALSE_MESSAGE(alarm_says("INTERLOCK_ON"), where);
}

static bool possible(const struct mode *mode)
{
    char line[40];
    if (!mode->needs)
        return true;
    snprintf(line, sizeof line, "help %s", mode->needs);
    power_on();
    return strcmp(ask(line), "ok") == 0;
}

void setUp(void) {}
void tearDown(void) {}

static void every_fault_in_every_mode_ends_in_its_state(void)
{
    unsigned combinations = 0, n_modes = 0;
    for (unsigned m = 0; m < MODES; m++) {
        if (!possible(&modes[m])) {
            printf("fault matrix: mode %s is not in this build\n", modes[m].name);
            continue;
        }
        n_modes++;
        for (unsigned f = 0; f < FAULTS; f++) {
            one_combination(&faults[f], &modes[m]);
            combinations++;
        }
    }
    printf("fault matrix: %u combinations (%u faults, %u modes)\n", combinations, (unsigned)FAULTS,
           n_modes);
}

/* A row of the table in tests/loop/fault-matrix.md. */
static void row(unsigned f, char *line, size_t size)
{
    const struct fault *fault = &faults[f];
    static const char *const ends[] = {
        [SAME] = "as before",
        [LOST] = "`bottom` in manual, interlock holds the heater",
        [SAFE] = "safe state",
        [INFERRED] = "as before, flow from the valve's opening",
        [OUTER_LOST] = "`outer` in manual, the rest as before",
        [NOT_FOLLOWING] = "as before, reported",
        [TRIPPED] = "interlock commands 0, reported",
    };
    snprintf(line, size, "| %s | %s%s%s%s%s%s | %s | %s |\n", fault->name, fault->begin ? "`" : "",
             fault->begin                            ? fault->begin
             : fault->act == workspace_wanted_by_two ? "two who ask for it"
                                                     : "on the link",
             fault->begin ? "`" : "", fault->begin_too ? " `" : "",
             fault->begin_too ? fault->begin_too : "", fault->begin_too ? "`" : "",
             ends[fault->state], fault->ends_test ? fault->ends_test : "goes on");
}

static void the_table_in_the_document_is_this_one(void)
{
    document_has_rows(FAULTS, row);
}

int main(int argc, char **argv)
{
    if (prints_rows(argc, argv, FAULTS, row))
        return 0;
    UNITY_BEGIN();
    RUN_TEST(the_table_in_the_document_is_this_one);
    RUN_TEST(every_fault_in_every_mode_ends_in_its_state);
    return UNITY_END();
}

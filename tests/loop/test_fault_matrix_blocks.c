/* Faults that concern blocks with a number (blockN), in every mode of operation, and the state each must end in: an estimator
 * whose point is the PV of a loop, with work between ticks, and a controller of two loops with a further input. The product has no such
 * kinds yet: those of the test stand in for them. To add a fault: a row of faults[]. */
#include <math.h>

#include "kinds/decoupler/decoupler.h"
#include "kinds/pid/pid.h"
#include "kinds/two_position/two_position.h"
#define AT_ONCE 16u /* more ticks than its work has */
#include "fault_bench.h"
#include "kinds/feedforward/feedforward.h"
#include "numbered_kinds.h"

const struct block_kind *const block_kinds[] = {
    &pid_kind, &two_position_kind, &decoupler_kind, &feedforward_kind, &mean_kind, &both_kind};
const uint8_t block_kind_count = sizeof block_kinds / sizeof block_kinds[0];

/* ---- modes of operation ---- */

static void served(void)
{
    ask_ok("mode bottom auto");
    ask_ok("sp bottom 101");
    ask_ok("mode flow auto");
}
static void one_by_hand(void)
{
    ask_ok("mode bottom auto");
    ask_ok("sp bottom 101");
}
static void saturated(void)
{
    ask_ok("mode bottom auto");
    ask_ok("sp bottom 158");
    ask_ok("mode flow auto");
}
static void switched_off(void)
{
    served();
    ask_ok("block 2 off");
}

static const struct mode {
    const char *name;
    void (*enter)(void);
    const char *flow;    /* mode of that loop; bottom is in auto */
    const char *command; /* given every ten samples while the fault lasts */
    bool off;            /* the controllers of the loops themselves act, before the fault too */
} modes[] = {
    {"served", served, "auto", NULL, false},
    {"one by hand", one_by_hand, "manual", NULL, false},
    {"saturated", saturated, "auto", NULL, false},
    {"saving", served, "auto", "save", false},
    {"switched off", switched_off, "auto", NULL, true},
};
#define MODES (sizeof modes / sizeof modes[0])

/* ---- faults ---- */

static void gives_up(void)
{
    both_gives_up = true;
}
static void gives_no_number(void)
{
    both_adds = NAN;
}
static void estimates_no_number(void)
{
    mean_adds = NAN;
}
static void does_not_wait(void)
{
    waits = false;
}
static void silent_link(void)
{
    board.mute = true;
    pass(3000);
    board.mute = false;
    pass(1000);
    TEST_ASSERT_TRUE(board.ready);
}

enum end {
    SAME,        /* modes as they were, the block acts */
    OWN,         /* the same, but the loops' own controllers act */
    BOTTOM_LOST, /* bottom in manual, the block acts for the other */
    FLOW_LOST,   /* the other way round */
    SAFE
};

static const struct fault {
    const char *name, *begin, *end; /* of the instruments */
    void (*act)(void);
    const char *by;    /* where there is no `begin` */
    const char *event; /* event, and entry in the list of alarms */
    enum end state;
    bool listed;
    bool needs_float; /* in fixed point there is no such thing */
} faults[] = {
    {"a further input flagged bad", "T5.quality=2", "T5.quality=0", NULL, NULL,
     "BLOCK_GAVE_UP block2 T5", OWN, true, false},
    {"a further input missing", "T5.quality=3", "T5.quality=0", NULL, NULL,
     "BLOCK_GAVE_UP block2 T5", OWN, true, false},
    {"a further input not a number", "T5.nan=1", "T5.nan=0", NULL, NULL, "BLOCK_GAVE_UP block2 T5",
     OWN, true, false},
    {"a further input frozen", "T5.frozen=1", "T5.free=1", NULL, NULL, "BLOCK_GAVE_UP block2 T5",
     OWN, true, false},
    {"an estimator's input flagged bad", "T1.quality=2", "T1.quality=0", NULL, NULL,
     "MEASUREMENT_BAD mean", BOTTOM_LOST, true, false},
    {"an estimator's input missing", "T10.quality=3", "T10.quality=0", NULL, NULL,
     "MEASUREMENT_BAD mean", BOTTOM_LOST, true, false},
    {"an estimator's input out of range", "T1.stuck=200", "T1.free=1", NULL, NULL,
     "MEASUREMENT_BAD mean", BOTTOM_LOST, true, false},
    {"an estimate not a number", NULL, NULL, estimates_no_number, "the kind",
     "MEASUREMENT_BAD mean", BOTTOM_LOST, true, true},
    {"measurement of a member flagged bad", "flow.quality=2", "flow.quality=0", NULL, NULL,
     "MEASUREMENT_BAD flow", FLOW_LOST, true, false},
    {"a block gives up", NULL, NULL, gives_up, "the kind", "BLOCK_GAVE_UP block2 test", OWN, true,
     false},
    {"an output not a number", NULL, NULL, gives_no_number, "the kind",
     "BLOCK_GAVE_UP block2 not_a_number", OWN, true, true},
    {"a block's job late", NULL, NULL, does_not_wait, "a plant that does not wait",
     "JOB_LATE block", SAME, false, false},
    {"link silent", NULL, NULL, silent_link, "on the link", "LINK_DOWN", SAFE, false, false},
    {"spikes in a further input", "T5.spike=20", "T5.spike=0", NULL, NULL, NULL, SAME, false,
     false},
};
#define FAULTS (sizeof faults / sizeof faults[0])

/* ---- the run ---- */

static void configure_blocks(void)
{
    static const char *const lines[] = {
        "meas1.name T1",
        "meas1.unit degC",
        "meas1.lo 60",
        "meas1.hi 160",
        "meas1.hold 10",
        "meas2.name T10",
        "meas2.unit degC",
        "meas2.lo 60",
        "meas2.hi 160",
        "meas2.hold 10",
        "meas3.name flow",
        "meas3.unit l/h",
        "meas3.lo 2",
        "meas3.hi 12",
        "meas3.hold 10",
        "meas4.name T5",
        "meas4.unit degC",
        "meas4.lo 60",
        "meas4.hi 160",
        "meas4.hold 5",
        "meas4.rate_limit 3",
        "meas4.frozen 60",
        "meas5.name mean",
        "meas5.unit degC",
        "meas5.lo 60",
        "meas5.hi 160",
        "meas5.hold 10",
        "meas6.name apart",
        "meas6.unit degC",
        "meas6.lo -100",
        "meas6.hi 100",
        "mv1.name reflux",
        "mv1.unit l/h",
        "mv1.hi 10",
        "mv1.max 10",
        "mv1.safe 5",
        "mv2.name heat",
        "mv2.unit kW",
        "mv2.hi 2",
        "mv2.max 1.6",
        "mv2.safe 0.25",
        "loop1.name flow",
        "loop1.pv flow",
        "loop1.out reflux",
        "loop1.gain 0.5",
        "loop1.ti 10",
        "loop2.name bottom",
        "loop2.pv mean",
        "loop2.out heat",
        "loop2.gain 1",
        "loop2.ti 60",
        "block1.kind mean",
        "block1.inputs T1,T10",
        "block1.points mean,apart",
        "block2.kind both",
        "block2.loops bottom,flow",
        "block2.inputs T5",
        "block2.rate 0.01",
        "block2.cross 0",
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
    both_gives_up = false;
    both_adds = mean_adds = 0.0f;
    mean_again = waits = true;
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
    configure_blocks();
    connect_plant();
    steps(2);
    ask_ok("out bottom 1");
    ask_ok("out flow 5");
    steps(3);
    mode->enter();
    steps(300);
    board_forget();
}

/* No output moves by more than 2 % of its span from one sample to the next: the noise of the measurements moves it by less. */
static void quiet_steps(unsigned n, const char *command, const char *where)
{
    for (unsigned i = 0; i < n; i++) {
        double before[2] = {board.command.output[0].value, board.command.output[1].value};
        step();
        for (unsigned j = 0; j < 2; j++) {
            double moved = fabs(board.command.output[j].value - before[j]);
            TEST_ASSERT_TRUE_MESSAGE(moved <= 0.02 * (channels[j].hi - channels[j].lo), where);
        }
        if (command && i % 10 == 0)
            (void)ask(command);
    }
}

static bool block_is(const char *state)
{
    char text[60];
    ask_ok("block");
    snprintf(text, sizeof text, "block2 both %s", state);
    return said(text);
}

static void check_loops(const struct mode *mode, enum end end, const char *where)
{
    bool safe = end == SAFE;
    const char *bottom = safe || end == BOTTOM_LOST ? "manual" : "auto";
    const char *flow = safe || end == FLOW_LOST ? "manual" : mode->flow;
    TEST_ASSERT_TRUE_MESSAGE(loop_is("bottom", bottom), where);
    TEST_ASSERT_TRUE_MESSAGE(loop_is("flow", flow), where);
    TEST_ASSERT_TRUE_MESSAGE(block_is(mode->off    ? "off: asked"
                                      : end == OWN ? "off: "
                                                   : "on"),
                             where);
}

/* Events that are not BLOCK_GAVE_UP have their own columns: name and subject. */
static void check_told(const struct fault *fault, const struct mode *mode, const char *where)
{
    bool gave_up = fault->state == OWN;
    char text[80];
    if (!fault->event)
        return;
    snprintf(text, sizeof text, "%s", fault->event);
    char *block = strstr(text, "block2 ");
    if (gave_up) /* the event names the reason, and the block as its value */
        memmove(block, block + 7, strlen(block + 7) + 1);
    ask_ok("events");
    TEST_ASSERT_EQUAL_MESSAGE(!(gave_up && mode->off), said(text), where);
    TEST_ASSERT_EQUAL_MESSAGE(fault->listed && !(gave_up && mode->off), alarm_says(fault->event),
                              where);
}

static void repair(const struct fault *fault, const struct mode *mode, const char *where)
{
    event(fault->end);
    both_gives_up = false;
    both_adds = mean_adds = 0.0f;
    waits = true;
    quiet_steps(50, NULL, where);
    check_loops(mode, fault->state, where); /* nothing begins to act of itself */
    TEST_ASSERT_FALSE_MESSAGE(alarm_says("MEASUREMENT_BAD"), where);
    TEST_ASSERT_TRUE_MESSAGE(quality_is("mean", "good"), where);
    if (fault->state == SAFE)
        return;
    if (fault->state == OWN)
        ask_ok("block 2 on");
    if (fault->state == BOTTOM_LOST)
        ask_ok("mode bottom auto");
    if (fault->state == FLOW_LOST && strcmp(mode->flow, "auto") == 0)
        ask_ok("mode flow auto");
    quiet_steps(50, NULL, where);
    TEST_ASSERT_FALSE_MESSAGE(alarm_says("BLOCK_GAVE_UP"), where);
    TEST_ASSERT_TRUE_MESSAGE(block_is(mode->off && fault->state != OWN ? "off: asked" : "on"),
                             where);
    TEST_ASSERT_TRUE_MESSAGE(loop_is("bottom", "auto"), where);
    TEST_ASSERT_TRUE_MESSAGE(loop_is("flow", mode->flow), where);
}

static void one_combination(const struct fault *fault, const struct mode *mode)
{
    char where[120];
    snprintf(where, sizeof where, "%s in %s", fault->name, mode->name);
    begin(mode);
    TEST_ASSERT_TRUE_MESSAGE(block_is(mode->off ? "off: asked" : "on"), where);
    event(fault->begin);
    if (fault->act)
        fault->act();
    if (fault->state == SAFE)
        steps(100);
    else
        quiet_steps(waits ? 100u : 100u / AT_ONCE, mode->command, where);
    TEST_ASSERT_EQUAL_MESSAGE(fault->state == SAFE, board.command.safe, where);
    bool as_before = fault->state == OWN && mode->off;
    check_loops(mode, as_before ? SAME : fault->state, where);
    check_told(fault, mode, where);
    repair(fault, mode, where);
}

void setUp(void) {}
void tearDown(void) {}

static void every_fault_in_every_mode_ends_in_its_state(void)
{
    unsigned combinations = 0;
    for (unsigned m = 0; m < MODES; m++) {
        for (unsigned f = 0; f < FAULTS; f++) {
#ifdef REFLUX_FIXED_POINT
            if (faults[f].needs_float)
                continue;
#endif
            one_combination(&faults[f], &modes[m]);
            combinations++;
        }
    }
    printf("fault matrix of blocks: %u combinations\n", combinations);
}

/* A row of the table in tests/loop/fault-matrix.md. */
static void row(unsigned f, char *line, size_t size)
{
    const struct fault *fault = &faults[f];
    static const char *const ends[] = {
        [SAME] = "as before",
        [OWN] = "the loops' own controllers act",
        [BOTTOM_LOST] = "its loop in manual, the block acts for the other",
        [FLOW_LOST] = "that loop in manual, the block acts for the other",
        [SAFE] = "safe state",
    };
    snprintf(line, size, "| %s | %s%s%s | %s | %s%s%s |\n", fault->name, fault->begin ? "`" : "",
             fault->begin ? fault->begin : fault->by, fault->begin ? "`" : "", ends[fault->state],
             fault->event ? fault->event : "nobody", fault->listed ? ", listed" : "",
             fault->needs_float ? " (float)" : "");
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

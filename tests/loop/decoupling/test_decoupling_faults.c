/* Faults under the kinds `polynomial` and `rst`, with every loop in automatic, one by hand, one out of reach of its MV, and the block
 * off: what each must end in. To add a fault: a row of faults[]. */
#include <math.h>

#include "plant_board.h"

#define TICK_MS 120000u

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

/* ---- what controls ---- */

static const struct law {
    const char *name, *file[2], *line;
    unsigned block; /* of `switched off`; 0: there is none */
} laws[] = {
    {"PI behind polynomial", {DECOUPLING "/polynomial.conf"}, NULL, 3},
    {"PI behind polynomial, scaled", {DECOUPLING "/polynomial.conf"}, "set block3.limits scale", 3},
    {"rst behind polynomial",
     {DECOUPLING "/rst-behind.conf", DECOUPLING "/polynomial.conf"},
     NULL,
     1},
    {"rst alone", {DECOUPLING "/rst-alone.conf"}, NULL, 1},
    {"PI behind the static decoupler", {DECOUPLING "/static.conf"}, NULL, 0},
};
#define LAWS (sizeof laws / sizeof laws[0])

/* ---- modes of operation ---- */

static void both(const struct law *law)
{
    (void)law;
    ask_ok("mode one auto");
    ask_ok("mode two auto");
    ask_ok("sp one 0.1");
    ask_ok("sp two 0");
}

static void one_by_hand(const struct law *law)
{
    (void)law;
    ask_ok("mode one auto");
    ask_ok("sp one 0.1");
}

/* u1 cannot do what loop one asks for. */
static void clipped(const struct law *law)
{
    both(law);
    ask_ok("set mv1.max 0.4");
    ask_ok("sp one 0.3");
}

static void switched_off(const struct law *law)
{
    char line[40];
    both(law);
    snprintf(line, sizeof line, "block %u off", law->block);
    ask_ok(line);
}

static const struct mode {
    const char *name;
    void (*enter)(const struct law *law);
    const char *two; /* mode of that loop */
    bool clipped;
} modes[] = {
    {"both in auto", both, "auto", false},
    {"one by hand", one_by_hand, "manual", false},
    {"clipped", clipped, "auto", true},
    {"switched off", switched_off, "auto", false},
};
#define MODES (sizeof modes / sizeof modes[0])

/* ---- faults ---- */

static void silent_link(void)
{
    board.mute = true;
    pass(5000);
}

static void two_by_hand(void)
{
    ask_ok("mode two manual");
}

static void two_back(void)
{
    ask_ok("mode two auto");
}

static void less_of_u2(void)
{
    ask_ok("set mv2.max 0.05");
}

static void all_of_u2(void)
{
    ask_ok("set mv2.max 5");
}

enum end { GOES_ON, ONE_LOST, TWO_LOST, SAFE };

static const struct fault {
    const char *name, *begin, *end; /* of the instruments */
    void (*act)(void), (*undo)(void);
    const char *event;
    enum end state;
    bool needs_two; /* that loop acts */
} faults[] = {
    {"measurement flagged bad", "y1.quality=2", "y1.quality=0", NULL, NULL, "MEASUREMENT_BAD y1",
     ONE_LOST, false},
    {"measurement missing", "y1.quality=3", "y1.quality=0", NULL, NULL, "MEASUREMENT_BAD y1",
     ONE_LOST, false},
    {"measurement not a number", "y1.nan=1", "y1.nan=0", NULL, NULL, "MEASUREMENT_BAD y1", ONE_LOST,
     false},
    {"measurement frozen", "y1.frozen=1", "y1.free=1", NULL, NULL, "MEASUREMENT_BAD y1", ONE_LOST,
     false},
    {"the other measurement lost", "y2.quality=3", "y2.quality=0", NULL, NULL, "MEASUREMENT_BAD y2",
     TWO_LOST, true},
    {"samples lost at random", "y1.dropout=0.3", "y1.dropout=0", NULL, NULL, NULL, GOES_ON, false},
    {"spikes", "y2.spike=0.3 y2.spike_rate=6", NULL, NULL, NULL, NULL, GOES_ON, false},
    {"valve stuck", "u1.stuck=0.5", "u1.free=1", NULL, NULL, NULL, GOES_ON, false},
    {"valve half as strong", "u1.gain=0.5", "u1.gain=1", NULL, NULL, NULL, GOES_ON, false},
    {"the other input clipped", NULL, NULL, less_of_u2, all_of_u2, NULL, GOES_ON, false},
    {"a member taken into manual", NULL, NULL, two_by_hand, two_back, NULL, TWO_LOST, true},
    {"interlock", "y1.bias=1.6", "y1.bias=0", NULL, NULL, "INTERLOCK", GOES_ON, false},
    {"link silent", NULL, NULL, silent_link, plant_connect, "LINK_DOWN", SAFE, false},
};
#define FAULTS (sizeof faults / sizeof faults[0])

/* ---- the run ---- */

static void begin(const struct law *law, const struct mode *mode)
{
    plant_power_on("kotyk-column", TICK_MS, 3, 1);
    ask_file(DECOUPLING "/kotyk.conf");
    for (unsigned k = 0; k < 2; k++)
        if (law->file[k])
            ask_file(law->file[k]);
    if (law->line)
        ask_ok(law->line);
    plant_connect();
    plant_steps(2);
    ask_ok("out one 0");
    ask_ok("out two 0");
    plant_steps(50);
    mode->enter(law);
    plant_steps(100);
    board_forget();
}

static void bounded_steps(unsigned n, const char *where)
{
    for (unsigned k = 0; k < n; k++) {
        plant_step();
        TEST_ASSERT_TRUE_MESSAGE(fabs(commanded("u1")) <= 5 && fabs(commanded("u2")) <= 5, where);
        TEST_ASSERT_TRUE_MESSAGE(isfinite(truly("y1")) && isfinite(truly("y2")), where);
    }
}

static void check_loops(const struct fault *fault, const struct mode *mode, const char *where)
{
    const char *one = fault->state == ONE_LOST || fault->state == SAFE ? "manual" : "auto";
    const char *two = fault->state == TWO_LOST || fault->state == SAFE ? "manual" : mode->two;
    TEST_ASSERT_TRUE_MESSAGE(loop_is("one", one), where);
    TEST_ASSERT_TRUE_MESSAGE(loop_is("two", two), where);
    if (fault->event)
        TEST_ASSERT_TRUE_MESSAGE(events_say(fault->event), where);
}

/* A loop that comes back moves nothing in its first step by more than noise does: 5 % of an MV's span. */
static void back_to_auto(const char *loop, const char *where)
{
    char line[40];
    double before[2] = {commanded("u1"), commanded("u2")};
    snprintf(line, sizeof line, "mode %s auto", loop);
    ask_ok(line);
    plant_step();
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.5, before[0], commanded("u1"), where);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.5, before[1], commanded("u2"), where);
}

static void repair(const struct fault *fault, const struct mode *mode, const char *where)
{
    if (strcmp(fault->name, "spikes") == 0) {
        plant_event("y2.spike=0");
        plant_event("y2.spike_rate=0");
    }
    plant_event(fault->end);
    if (fault->undo)
        fault->undo();
    plant_steps(3);
    if (fault->state == SAFE) {
        TEST_ASSERT_TRUE_MESSAGE(loop_is("one", "manual"), where);
        TEST_ASSERT_TRUE_MESSAGE(loop_is("two", "manual"), where);
        ask_ok("out one 0");
        ask_ok("out two 0");
        plant_steps(60);
        back_to_auto("two", where);
    }
    if (fault->state == TWO_LOST && fault->undo == NULL)
        back_to_auto("two", where);
    if (fault->state == ONE_LOST || fault->state == SAFE) {
        TEST_ASSERT_TRUE_MESSAGE(loop_is("one", "manual"), where); /* by itself nothing begins */
        back_to_auto("one", where);
    }
    if (mode->clipped)
        ask_ok("set mv1.max 5");
    ask_ok("sp one 0.1");
    if (strcmp(mode->two, "auto") == 0 || fault->state == SAFE)
        ask_ok("sp two 0");
    bounded_steps(120, where);
    /* Five deviations of the noise, and the little it makes the process move. */
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.03, 0.1, truly("y1"), where);
    if (loop_is("two", "auto"))
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.04, 0, truly("y2"), where);
}

static void put_fault(const char *what)
{
    char text[80];
    if (!what)
        return;
    snprintf(text, sizeof text, "%s", what);
    for (char *one = strtok(text, " "); one; one = strtok(NULL, " "))
        plant_event(one);
}

/* Runs one combination; true if there is one. */
static bool one_combination(const struct law *law, const struct mode *mode,
                            const struct fault *fault)
{
    char where[160];
    snprintf(where, sizeof where, "%s, %s, %s", law->name, mode->name, fault->name);
    if ((fault->needs_two && strcmp(mode->two, "auto") != 0) ||
        (mode->enter == switched_off && law->block == 0))
        return false;
    begin(law, mode);
    put_fault(fault->begin);
    if (fault->act)
        fault->act();
    bounded_steps(fault->state == SAFE ? 5 : 40, where);
    check_loops(fault, mode, where);
    repair(fault, mode, where);
    plant_power_off();
    return true;
}

static void every_fault_under_every_law_in_every_mode_ends_as_it_must(void)
{
    unsigned combinations = 0;
    for (unsigned l = 0; l < LAWS; l++)
        for (unsigned m = 0; m < MODES; m++)
            for (unsigned f = 0; f < FAULTS; f++)
                combinations += one_combination(&laws[l], &modes[m], &faults[f]);
    printf("fault matrix of decoupling: %u combinations\n", combinations);
}

/* ---- a clipped input and the other loop ---- */

static void clipped_for_hours(const struct law *law)
{
    begin(law, &modes[0]);
    ask_ok("set mv1.max 0.4");
    ask_ok("sp one 0.3");
    ask_ok("sp two 0.2");
    plant_steps(300);
}

static void where_its_past_is_the_one_that_took_effect_the_other_loop_keeps_its_setpoint(void)
{
    static const unsigned which[] = {0, 2, 4};
    for (unsigned k = 0; k < 3; k++) {
        clipped_for_hours(&laws[which[k]]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, commanded("u1"));
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.04, 0.2, truly("y2"), laws[which[k]].name);
        plant_power_off();
    }
}

static void off_its_limit_the_input_moves_within_two_samples(void)
{
    for (unsigned l = 0; l < LAWS; l++) {
        clipped_for_hours(&laws[l]);
        ask_ok("sp one -0.2");
        plant_steps(2);
        TEST_ASSERT_TRUE_MESSAGE(commanded("u1") < 0.39, laws[l].name);
        plant_power_off();
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_fault_under_every_law_in_every_mode_ends_as_it_must);
    RUN_TEST(where_its_past_is_the_one_that_took_effect_the_other_loop_keeps_its_setpoint);
    RUN_TEST(off_its_limit_the_input_moves_within_two_samples);
    return UNITY_END();
}

/* Every fault in every step of the start-up and shut-down of the cold pilot column, and the state each ends in.
 *
 * One run goes through all steps. In each, soon after it began, the process forks for every fault: the child makes the
 * fault, goes on, and says in which state the sequence is then. To add a fault: a row of faults[]. The table stands in
 * tests/loop/sequence-matrix.md; `test_sequence_matrix table` prints it, with the ends of this run.
 */
#include <math.h>
#include <sys/wait.h>
#include <unistd.h>

#include "hal/identity.h"
#include "plant_board.h"

#define TICK_S 10
#define SAMPLES                                                                                    \
    320 /* after each fault: longer than any time-out of a step that waits for a measurement */

/* ---- steps ---- */

static const struct step {
    const char *headline; /* of `seq` */
    const char *watched;  /* measurement it waits for, or a guard looks at, or a loop controls */
    const char *met;      /* a sensor that sticks where the condition is met */
    bool waits;           /* for that, and for nothing else */
} steps[] = {
    {"start running at step 3", "Fcw", "Fcw.stuck=55", true},
    {"start running at step 5", "LB", "LB.stuck=25", true},
    {"start running at step 8", "T10", "T10.stuck=95", true},
    {"start running at step 9", "LD", "LD.stuck=5", true},
    {"start running at step 10", "LB", "LB.stuck=24", false},
    {"start confirm at step 11", "Fcw", "Fcw.stuck=55", false},
    {"start running at step 12", "F", "F.stuck=5", true},
    {"start running at step 17", "T10", "T10.stuck=104", true},
    {"start done at step 21", "T10", "T10.stuck=106", false},
    {"stop running at step 26", "LD", "LD.stuck=1", true},
    {"stop running at step 27", "TB", "TB.stuck=29", false},
    {"stop running at step 28", "TB", "TB.stuck=29", true},
};
#define STEPS (sizeof steps / sizeof steps[0])

/* ---- faults ---- */

static void nothing(void) {}

static void silent_link(void)
{
    board.mute = true;
    pass(3000);
    plant_connect();
}
static void plant_restarts(void)
{
    board.session++;
    plant_hello();
    board_run();
    plant_connect();
}
static void one_sample_lost(void)
{
    board.time_ms += TICK_S * 1000;
    TEST_ASSERT_TRUE(
        kind->advance(plant, (double)board.time_ms / 1000.0, plant_err, sizeof plant_err));
}
static void many_samples_lost(void)
{
    for (unsigned n = 0; n < 20; n++)
        one_sample_lost();
}
static void broken_frames(void)
{
    static const uint8_t noise[] = {7, 1, 2, 3, 4, 5, 6, 0, 99, 98, 0};
    (void)memory_port_give(HAL_UART_LINK, noise, sizeof noise);
    board_run();
}
static void again(void)
{
    board.ready = false;
    board_run();
    type("mode machine\n");
    plant_connect();
}
static void watchdog(void)
{
    memory_port_reset(HAL_RESET_WATCHDOG);
    again();
}
static void power_loss(void)
{
    memory_port_start();
    memory_port_set_clock(board.clock_ms);
    again();
}
static void say(const char *line)
{
    (void)ask(line);
}
static void operator_aborts(void)
{
    say("seq abort");
}
static void operator_holds(void)
{
    say("seq hold");
}
static void operator_stops(void)
{
    say("seq stop");
}
static void operator_takes_a_loop(void)
{
    say("mode sump manual");
}

#define FULL_ON                                                                                    \
    "Qrb.stuck=1.5" /* beyond any firmware's reach: the heater's own thermostat must do */
#define WATCHED "*" /* in an event: the measurement of the step; alone: its `met` */

/* Ends, a letter for each step: A aborted, safe state; H held; g goes on, or done; S safe state with no sequence; C the
 * heater is cut by an interlock with no sequence; M a loop in manual with no sequence; R resumed, with no sequence; i idle,
 * safe state. x is none of them: a step went on by a reading that is not valid. */
static const struct fault {
    const char *name;
    const char *event, *event_too;
    void (*act)(void);
    const char *ends;
} faults[] = {
    /* the process */
    {"cooling water lost", "supply=0", NULL, nothing, "AAAAAAAACggg"},
    {"reboiler runs dry", "leak=60", NULL, nothing, "AAAAAAAACggg"},
    {"heater fails", "Qrb.stuck=0", NULL, nothing, "AAAAAHHHgggg"},
    {"heater fails unseen", "Qrb.stuck=0", "Qrb.readback=2", nothing, "AAAAgggggggg"},
    {"heater full on", FULL_ON, NULL, nothing, "AAAAAAAACHHH"},
    {"feed lost", "vF.stuck=0", NULL, nothing, "ggggggAACggg"},
    {"feed lost unseen", "vF.stuck=0", "vF.readback=2", nothing, "ggggggAACggg"},
    {"reflux valve shut", "vLr.stuck=0", NULL, nothing, "AAAAAAAAgHHH"},
    {"bottoms valve open", "vB.stuck=100", NULL, nothing, "AAAAAAAACHHH"},
    /* the sensor of what the step watches */
    {"sensor not a number", "*.nan=1", NULL, nothing, "AAAAAAAHMHHH"},
    {"sensor flagged bad", "*.quality=2", NULL, nothing, "AAAAAAAHMHHH"},
    {"sensor missing", "*.quality=3", NULL, nothing, "AAAAAAAHMHHH"},
    {"sensor dead", "*.dead=1", NULL, nothing, "AAAAAAAHMgHH"},
    {"sensor frozen", "*.frozen=1", NULL, nothing, "gAAAAgAHMHHH"},
    {"sensor stuck as if met", WATCHED, NULL, nothing, "gAggAggHMgHH"},
    {"sensor drops out", "*.dropout=0.3", NULL, nothing, "gggggggggggg"},
    {"sensor spikes", "*.spike=30", "*.spike_rate=40", nothing, "AAggAHgggggg"},
    {"sensor noisy", "*.noise=1", NULL, nothing, "gggggggggggg"},
    /* flowmeters */
    {"cooling flowmeter dead", "Fcw.dead=1", NULL, nothing, "AAAAAAAACggg"},
    {"cooling flowmeter missing", "Fcw.quality=3", NULL, nothing, "AAAAAAAACggg"},
    {"reflux flowmeter dead", "Lr.dead=1", NULL, nothing, "gggggggggggg"},
    {"feed flowmeter missing", "F.quality=3", NULL, nothing, "ggggggAggggg"},
    /* the link, the board, people */
    {"link silent", NULL, NULL, silent_link, "AAAAAAAASAAA"},
    {"plant restarted", NULL, NULL, plant_restarts, "AAAAAAAASAAA"},
    {"one sample lost", NULL, NULL, one_sample_lost, "gggggggggggg"},
    {"many samples lost", NULL, NULL, many_samples_lost, "AAAAAAAASAAA"},
    {"broken frames", NULL, NULL, broken_frames, "gggggggggggg"},
    {"board reset by its watchdog", NULL, NULL, watchdog, "AAAAAAAARAAA"},
    {"board loses power", NULL, NULL, power_loss, "iiiiiiiiiiii"},
    {"operator aborts", NULL, NULL, operator_aborts, "AAAAAAAAgAAA"},
    {"operator holds", NULL, NULL, operator_holds, "HHAAHHHHgHHH"},
    {"operator stops", NULL, NULL, operator_stops, "gggggggggggg"},
    {"operator takes the level loop", NULL, NULL, operator_takes_a_loop, "gggggggHMggg"},
};
#define FAULTS (sizeof faults / sizeof faults[0])

static void make(const char *event, const struct step *step)
{
    char text[60];
    if (!event)
        return;
    if (strcmp(event, WATCHED) == 0)
        snprintf(text, sizeof text, "%s", step->met);
    else if (event[0] == '*')
        snprintf(text, sizeof text, "%s%s", step->watched, event + 1);
    else
        snprintf(text, sizeof text, "%s", event);
    plant_event(text);
}

/* ---- the end ---- */

static bool begins(const char *text, const char *with)
{
    return strncmp(text, with, strlen(with)) == 0;
}

static char end_now(void)
{
    ask_ok("alarm");
    bool cut = said(" holds Qrb");
    ask_ok("loop");
    bool manual = said(" manual ");
    ask_ok("seq");
    const char *at = strchr(reply[0], ' ');
    bool idle = strcmp(reply[0], "idle") == 0;
    char state = idle ? 'i' : at[1]; /* running, held, confirm, done, aborted */
    bool safe = board.command.safe;
    if (idle)
        return safe ? 'i' : 'R';
    if (state == 'a')
        return safe ? 'A' : '?';
    if (state == 'h')
        return safe ? '?' : 'H';
    if (state != 'd' || begins(reply[0], "stop"))
        return safe ? '?' : 'g';
    if (safe)
        return 'S';
    return cut ? 'C' : manual ? 'M' : 'g';
}

static double hottest; /* the heater, degC */

/* True if the fault makes a reading invalid in the sample it comes with. */
static bool unvalid(const struct fault *fault)
{
    return fault->event &&
           (strcmp(fault->event, "*.nan=1") == 0 || strcmp(fault->event, "*.quality=2") == 0 ||
            strcmp(fault->event, "*.quality=3") == 0);
}

/* "8" of "start running at step 8" */
static int step_of(const char *headline)
{
    const char *at = strstr(headline, "at step ");
    return at ? atoi(at + 8) : 0;
}

static char try(const struct fault *fault, const struct step *step)
{
    unsigned same = 0;
    char end = '?', before;
    make(fault->event, step);
    make(fault->event_too, step);
    fault->act();
    for (unsigned n = 0; n < SAMPLES; n++) {
        plant_step();
        hottest = fmax(hottest, truly("Theater"));
        if (n % 4 != 3)
            continue;
        before = end;
        end = end_now();
        same = end == before && (end == 'A' || end == 'i' || end == 'S') ? same + 1 : 0;
        if (same == 5)
            break;
    }
    if (unvalid(fault) && step->waits && step_of(reply[0]) != step_of(step->headline))
        return 'x';
    return end;
}

static int answer[2]; /* a pipe: end, and the hottest the heater was */

static char end_in_a_child(const struct fault *fault, const struct step *step, double *heater)
{
    struct {
        double heater;
        char end;
    } result = {0, '!'};
    fflush(stdout);
    TEST_ASSERT_EQUAL(0, pipe(answer));
    pid_t child = fork();
    TEST_ASSERT_TRUE(child >= 0);
    if (child == 0) {
        if (TEST_PROTECT())
            result.end = try(fault, step);
        result.heater = hottest;
        _exit(write(answer[1], &result, sizeof result) == sizeof result ? 0 : 1);
    }
    close(answer[1]);
    ssize_t n = read(answer[0], &result, sizeof result);
    close(answer[0]);
    int status = 0;
    TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
    *heater = result.heater;
    return n == sizeof result && WIFEXITED(status) && WEXITSTATUS(status) == 0 ? result.end : '!';
}

/* ---- the run ---- */

static void go_to(const struct step *step)
{
    for (unsigned n = 0; n < 1500; n++) {
        ask_ok("seq");
        if (strcmp(reply[0], step->headline) == 0)
            return;
        if (begins(reply[0], "start confirm"))
            ask_ok("seq confirm");
        plant_step();
    }
    TEST_FAIL_MESSAGE(step->headline);
}

static char ends[FAULTS][STEPS + 1];

static void run_all(void)
{
    plant_power_on("pilot-cold", TICK_S * 1000, 3, 1.0);
    ask_file("../host_sim/scenarios/pilot-cold.conf");
    ask_file("../host_sim/scenarios/pilot-cold-sequences.conf");
    plant_connect();
    plant_steps(3);
    ask_ok("set restart.policy resume"); /* which a sequence does not */
    plant_steps(2);
    ask_ok("save");
    ask_ok("seq start");
    double worst = 0;
    for (unsigned i = 0; i < STEPS; i++) {
        if (begins(steps[i].headline, "stop") && !begins(steps[i - 1].headline, "stop"))
            ask_ok("seq stop");
        go_to(&steps[i]);
        if (begins(steps[i].headline, "start done"))
            plant_steps(300);
        for (unsigned f = 0; f < FAULTS; f++) {
            double heater;
            ends[f][i] = end_in_a_child(&faults[f], &steps[i], &heater);
            if (!faults[f].event || strcmp(faults[f].event, FULL_ON) != 0)
                worst = fmax(worst, heater);
        }
    }
    plant_power_off();
    printf("hottest heater, where it can be cut: %.0f degC\n", worst);
    TEST_ASSERT_TRUE(worst < 260);
}

void setUp(void) {}
void tearDown(void) {}

static void every_fault_in_every_step_ends_in_its_state(void)
{
    unsigned wrong = 0;
    run_all();
    for (unsigned f = 0; f < FAULTS; f++)
        for (unsigned i = 0; i < STEPS; i++)
            if (ends[f][i] != faults[f].ends[i]) {
                printf("%s, %s: ends in %c, not in %c\n", faults[f].name, steps[i].headline,
                       ends[f][i], faults[f].ends[i]);
                wrong++;
            }
    TEST_ASSERT_EQUAL(0, wrong);
    printf("sequence matrix: %u combinations (%u faults, %u steps)\n", (unsigned)(FAULTS * STEPS),
           (unsigned)FAULTS, (unsigned)STEPS);
}

static void row(const struct fault *fault, const char *letters, char *line, size_t size)
{
    size_t n = (size_t)snprintf(line, size, "| %s |", fault->name);
    for (unsigned i = 0; i < STEPS; i++)
        n += (size_t)snprintf(line + n, size - n, " %c |", letters[i]);
}

static void the_table_in_the_document_is_this_one(void)
{
    static char page[60000];
    char line[200];
    FILE *file = fopen("loop/sequence-matrix.md", "r");
    TEST_ASSERT_NOT_NULL(file);
    page[fread(page, 1, sizeof page - 1, file)] = '\0';
    fclose(file);
    for (unsigned f = 0; f < FAULTS; f++) {
        row(&faults[f], faults[f].ends, line, sizeof line);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(page, line), line);
    }
}

int main(int argc, char **argv)
{
    char line[200];
    if (argc == 2 && strcmp(argv[1], "table") == 0) {
        run_all();
        for (unsigned f = 0; f < FAULTS; f++) {
            row(&faults[f], ends[f], line, sizeof line);
            puts(line);
        }
        return 0;
    }
    UNITY_BEGIN();
    RUN_TEST(the_table_in_the_document_is_this_one);
    RUN_TEST(every_fault_in_every_step_ends_in_its_state);
    return UNITY_END();
}

/* The tick interrupts the main loop anywhere (interrupting.h). Whatever plan a tick finds in force is whole.
 *
 *     test_interrupted           a sample
 *     test_interrupted 100000    so many applies
 *
 * Every `apply` gives the interlocks that hold the outputs of a plant one new common value, and adds or removes a
 * measurement, so that all states change their places. Four more outputs stand by hand and must stay where they are. So
 * in each COMMAND the values by hand are the same as ever, those held are all the same, and they never go back.
 */
#define _GNU_SOURCE /* NOLINT(bugprone-reserved-identifier): timer_create with strict headers */
#include <stdlib.h>
#include <sys/wait.h>

#include "interrupting.h"

#define MEASUREMENTS      2
#define OUTPUTS           8
#define BY_HAND           4 /* of them, the first; the others by interlocks */
#define SAMPLE_OF_APPLIES 1000u

static unsigned applies = SAMPLE_OF_APPLIES;

/* ---- the tick context: nothing of this is touched by the main loop while the signal can come ---- */

static struct {
    uint32_t number;
    unsigned torn, backwards;
    float value;          /* of the last command */
    float found[OUTPUTS]; /* of the first that was torn */
} plant;

static void hello(void)
{
    struct link_hello m = {.version = LINK_VERSION,
                           .role = LINK_ROLE_PLANT,
                           .session = 1,
                           .n_measurements = MEASUREMENTS,
                           .n_outputs = OUTPUTS,
                           .tick_ms = 1000,
                           .name = "interrupting"};
    struct frame f;
    pack_hello(&m, &f);
    give(&f);
}

static void page(uint8_t index)
{
    bool manipulated = index >= MEASUREMENTS;
    struct link_page m = {
        .index = index, .manipulated = manipulated, .hi = 1048576.0f, .unit = "-"};
    struct frame f;
    (void)snprintf(m.name, sizeof m.name, manipulated ? "u%u" : "y%u",
                   index + 1u - (manipulated ? MEASUREMENTS : 0u));
    pack_page(&m, &f);
    give(&f);
}

static void next_sample(void)
{
    struct link_sample m = {.number = ++plant.number,
                            .time_ms = 1000u * (uint64_t)plant.number,
                            .n_measurements = MEASUREMENTS};
    struct frame f;
    m.measurement[0].value = 150.0f;
    pack_sample(&m, &f);
    give(&f);
}

/* Value of output j by hand. */
static unsigned by_hand(unsigned j)
{
    return 1000 + j; /* whole numbers are exact fractions of the span, which is a power of two */
}

static void look_at(const struct link_command *m)
{
    bool torn = false;
    for (unsigned j = 0; j < OUTPUTS; j++)
        torn = torn ||
               m->output[j].value != (j < BY_HAND ? (float)by_hand(j) : m->output[BY_HAND].value);
    for (unsigned j = 0; torn && plant.torn == 0 && j < OUTPUTS; j++)
        plant.found[j] = m->output[j].value;
    plant.torn += torn;
    plant.backwards += m->output[BY_HAND].value < plant.value;
    plant.value = m->output[BY_HAND].value;
}

/* ---- the main loop ---- */

static bool apply(unsigned value)
{
    char line[64];
    bool good = typed("begin") && typed(value % 2 ? "set meas2.name y2" : "set meas2.name -");
    for (unsigned k = 1; k <= OUTPUTS - BY_HAND; k++) {
        (void)snprintf(line, sizeof line, "set lock%u.value %u", k, value);
        good = good && typed(line);
    }
    return good && typed("apply");
}

static void configured(void)
{
    char line[64];
    memset(&plant, 0, sizeof plant);
    memset(&plant_line, 0, sizeof plant_line);
    memory_port_erase_all();
    memory_port_start();
    memory_port_set_tick_lock(NULL, NULL);
    (void)memory_port_give(HAL_UART_CONSOLE, "mode machine\n", 13);
    (void)memory_port_run();
    TEST_ASSERT_TRUE(typed("begin"));
    TEST_ASSERT_TRUE(typed("set meas1.name y1"));
    TEST_ASSERT_TRUE(typed("set meas1.hi 200"));
    for (unsigned j = 1; j <= OUTPUTS; j++) {
        static const char *const settings[] = {"name u%u", "hi 1048576", "max 1048576"};
        for (unsigned k = 0; k < 3; k++) {
            int n = snprintf(line, sizeof line, "set mv%u.", j);
            (void)snprintf(line + n, sizeof line - (size_t)n, settings[k], j);
            TEST_ASSERT_TRUE(typed(line));
        }
    }
    for (unsigned k = 1; k <= OUTPUTS - BY_HAND; k++) {
        (void)snprintf(line, sizeof line, "set lock%u.meas y1", k);
        TEST_ASSERT_TRUE(typed(line));
        (void)snprintf(line, sizeof line, "set lock%u.mv u%u", k, k + BY_HAND);
        TEST_ASSERT_TRUE(typed(line));
        (void)snprintf(line, sizeof line, "set lock%u.limit 100", k);
        TEST_ASSERT_TRUE(typed(line));
    }
    TEST_ASSERT_TRUE(typed("apply"));
    for (unsigned n = 0; n < 2000 && plant_line.commands < 3; n++)
        tick();
    TEST_ASSERT_EQUAL(3, plant_line.commands);
    for (unsigned j = 0; j < BY_HAND; j++) {
        (void)snprintf(line, sizeof line, "out u%u %u", j + 1, by_hand(j));
        TEST_ASSERT_TRUE(typed(line));
    }
    tick();
    tick();
    plant.torn = 0;
}

/* True if every one of n applies was answered with ok and every command was whole. */
static bool all_whole(unsigned n, void (*lock_with)(void))
{
    bool good = true;
    memory_port_set_tick_lock(lock_with, unlock);
    begin_interrupting();
    for (unsigned k = 1; good && (k <= n || plant_line.commands < n); k++)
        good = apply(k) && plant.torn == 0 && plant.backwards == 0;
    end_interrupting();
    tick(); /* what is on the line, and the last apply */
    tick();
    return good && plant.torn == 0 && plant.backwards == 0;
}

void setUp(void)
{
    configured();
}
void tearDown(void)
{
    memory_port_set_tick_lock(NULL, NULL);
}

static void no_tick_finds_a_torn_plan_wherever_it_comes(void)
{
    char message[200];
    bool good = all_whole(applies, lock);
    (void)snprintf(message, sizeof message,
                   "seed 0x%x: torn %u, backwards %u of %u commands; the first: %g %g .. %g %g",
                   INTERRUPTING_SEED, plant.torn, plant.backwards, plant_line.commands,
                   (double)plant.found[0], (double)plant.found[1], (double)plant.found[OUTPUTS - 2],
                   (double)plant.found[OUTPUTS - 1]);
    TEST_ASSERT_TRUE_MESSAGE(good, message);
    TEST_ASSERT_TRUE(plant.value >= (float)applies);
    (void)printf("interrupted: %u applies at least, %u ticks, %u commands, none torn\n", applies,
                 plant_line.ticks, plant_line.commands);
}

/* This test would notice: the same in a process of its own with a lock that does nothing. */
static void without_the_lock_it_shows(void)
{
    (void)fflush(NULL);
    pid_t child = fork();
    TEST_ASSERT_TRUE(child >= 0);
    if (child == 0) {
        (void)!freopen("/dev/null", "w", stdout);
        (void)!freopen("/dev/null", "w", stderr);
        _exit(all_whole(100000, empty_lock) ? 0 : 1); /* it ends with the first that is torn */
    }
    int status = 0;
    TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
    TEST_ASSERT_FALSE_MESSAGE(WIFEXITED(status) && WEXITSTATUS(status) == 0,
                              "an empty lock went unnoticed");
}

int main(int argc, char **argv)
{
    if (argc > 1)
        applies = (unsigned)strtoul(argv[1], NULL, 10);
    UNITY_BEGIN();
    RUN_TEST(no_tick_finds_a_torn_plan_wherever_it_comes);
    RUN_TEST(without_the_lock_it_shows);
    return UNITY_END();
}

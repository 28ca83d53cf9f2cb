/* Blocks that work between ticks or show inner values, while the tick interrupts the main loop anywhere (interrupting.h): they are listed,
 * switched off and on, retuned and told their verbs in random order, and settings move the arena in which their states stand. The
 * sanitizers say what goes wrong; the board must answer to the end.
 *
 *     test_interrupted_blocks        a sample
 *     test_interrupted_blocks all    twenty times as many lines
 */
#define _GNU_SOURCE /* NOLINT(bugprone-reserved-identifier): timer_create with strict headers */
#include <math.h>
#include <stdlib.h>

#include "hal/tick.h"
#include "interrupting.h"
#include "operate/operate.h"
#include "sample.h"
#include "service/service.h"

#define LINES 150u

struct subject {
    const char *name;
    uint32_t tick_ms;
    const char *const *files; /* pasted in this order */
    const char *const *lines; /* that may be typed at any time */
};

#define LIST(...) ((const char *const[]){__VA_ARGS__, NULL})

static const struct subject subjects[] = {
    {"state_law, state", 30000, LIST(SCENARIOS "/pilot.conf", SCENARIOS "/pilot-state-law.conf"),
     LIST("block 2", "block 3", "block 2 design", "block 2 stop", "block 3 off", "block 3 on",
          "set block2.period 98640.1", "set block2.period 30", "set block2.left 3",
          "set block2.left 2")},
    {"composition, ahead", 30000, LIST(SCENARIOS "/pilot.conf", SCENARIOS "/pilot-ahead.conf"),
     LIST("block 2", "block 3", "block 3 off", "block 3 on", "block 2 freeze", "block 2 thaw",
          "set block3.period 60", "set block3.period 30")},
    {"gmv", 30000, LIST(SCENARIOS "/pilot.conf", SCENARIOS "/self-tuning-pair.conf"),
     LIST("block 1", "block 1 off", "block 1 on", "block 1 tune", "block 1 reset", "block 1 adopt",
          "block 1 freeze", "block 1 thaw", "set block1.check_time 600",
          "set block1.check_time 900", "set block1.na 2", "set block1.na 1")},
    {"experiment, state_law", 60000, LIST(DECOUPLING "/two-lags.conf"),
     LIST("block 1", "block 2", "block 3", "block 3 start", "block 3 stop", "block 3 design",
          "block 3 settle", "block 2 off", "block 2 on", "block 3 off", "block 3 on",
          "set block3.na 2", "set block3.na 1", "set block3.bits 5", "set block3.bits 6")},
    {"ff_tune", 1000, LIST(FEEDFORWARD "/tune.conf"),
     LIST("block 1", "block 1 off", "block 1 on", "block 1 tune", "block 1 stop",
          "set block1.learn 120", "set block1.learn 240", "set block1.lag_most 50",
          "set block1.lag_most 60")},
    {"polynomial, rst", 120000, LIST(SCENARIOS "/kotyk-decoupled.conf"),
     LIST("block 1", "block 2", "block 3", "block 1 off", "block 1 on", "block 2 off",
          "block 2 on")},
    {"inferential", 1000, LIST(SCENARIOS "/composition-cascade.conf"),
     LIST("block 1", "block 1 off", "block 1 on")},
};

/* Lines for every subject: the second and third move the arena. */
static const char *const anybody[] = {
    "loop",  "set meas16.name spare", "set meas16.name -", "status",
    "alarm", "proposal accept",       "proposal back"};

/* ---- the plant, in the tick context: the channels that are configured, each around the middle of its span ---- */

struct plant_channel {
    char name[CHANNEL_NAME_SIZE], unit[CHANNEL_UNIT_SIZE];
    float lo, hi;
};

static struct {
    struct random_source noise;
    struct plant_channel channel[2 * CHANNEL_MAX];
    uint8_t measurements, outputs;
    uint32_t number, tick_ms;
    bool no_number;
} plant;

static void hello(void)
{
    struct link_hello m = {.version = LINK_VERSION,
                           .role = LINK_ROLE_PLANT,
                           .session = 1,
                           .n_measurements = plant.measurements,
                           .n_outputs = plant.outputs,
                           .tick_ms = plant.tick_ms,
                           .name = "interrupting"};
    struct frame f;
    pack_hello(&m, &f);
    give(&f);
}

static void page(uint8_t index)
{
    const struct plant_channel *c = &plant.channel[index];
    struct link_page m = {
        .index = index, .manipulated = index >= plant.measurements, .lo = c->lo, .hi = c->hi};
    struct frame f;
    (void)snprintf(m.name, sizeof m.name, "%s", c->name);
    (void)snprintf(m.unit, sizeof m.unit, "%s", c->unit);
    pack_page(&m, &f);
    give(&f);
}

static void next_sample(void)
{
    struct link_sample m = {.number = ++plant.number,
                            .time_ms = plant.tick_ms * (uint64_t)plant.number,
                            .n_measurements = plant.measurements};
    struct frame f;
    for (unsigned i = 0; i < plant.measurements; i++) {
        const struct plant_channel *c = &plant.channel[i];
        float part = 0.49f + 0.02f * (float)random_below(&plant.noise, 1000) / 1000.0f;
        m.measurement[i].value = c->lo + part * (c->hi - c->lo);
    }
    pack_sample(&m, &f);
    give(&f);
}

static void look_at(const struct link_command *m)
{
    for (unsigned j = 0; j < plant.outputs; j++)
        plant.no_number = plant.no_number || !isfinite(m->output[j].value);
}

/* ---- the main loop ---- */

static void paste(const char *path)
{
    char line[400];
    FILE *file = fopen(path, "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    while (fgets(line, sizeof line, file)) {
        line[strcspn(line, "\r\n")] = '\0';
        if (line[0] && line[0] != '#')
            TEST_ASSERT_TRUE_MESSAGE(typed(line), line);
    }
    (void)fclose(file);
}

static void add_channel(const char *name, const char *unit, float lo, float hi)
{
    struct plant_channel *c = &plant.channel[plant.measurements + plant.outputs];
    (void)snprintf(c->name, sizeof c->name, "%s", name);
    (void)snprintf(c->unit, sizeof c->unit, "%s", unit);
    c->lo = lo;
    c->hi = hi;
}

/* Names in the settings; points are the estimators'. */
static void take_channels(void)
{
    const struct plan *plan = service_plan(app_door(app_instance())->service);
    for (uint8_t i = 0; i < CHANNEL_MAX; i++) {
        const struct measurement_config *m = &plan->config.measurement[i];
        if (!m->name[0] || plan_is_estimate(plan, i))
            continue;
        add_channel(m->name, m->unit, m->lo, m->hi);
        plant.measurements++;
    }
    for (uint8_t j = 0; j < CHANNEL_MAX; j++) {
        const struct mv_config *o = &plan->config.mv[j];
        if (!o->name[0])
            continue;
        add_channel(o->name, o->unit, o->lo, o->hi);
        plant.outputs++;
    }
}

static void loops_to_auto(void)
{
    const struct config *config = &service_plan(app_door(app_instance())->service)->config;
    for (unsigned i = 0; i < CONFIG_LOOPS; i++) {
        char line[64];
        (void)snprintf(line, sizeof line, "mode %s auto", config->loop[i].name);
        if (config->loop[i].name[0])
            (void)typed(line);
    }
}

static void configured(const struct subject *subject)
{
    memset(&plant, 0, sizeof plant);
    memset(&plant_line, 0, sizeof plant_line);
    plant.tick_ms = subject->tick_ms;
    memory_port_erase_all();
    memory_port_start();
    memory_port_set_tick_lock(NULL, NULL);
    (void)memory_port_give(HAL_UART_CONSOLE, "mode machine\n", 13);
    (void)memory_port_run();
    for (unsigned k = 0; subject->files[k]; k++)
        paste(subject->files[k]);
    take_channels();
    for (unsigned n = 0; n < 2000 && plant_line.commands < 3; n++) {
        tick();
        app_background(app_instance());
    }
    TEST_ASSERT_TRUE(plant_line.commands >= 3);
    loops_to_auto();
}

static unsigned length(const char *const *list)
{
    unsigned n = 0;
    while (list[n])
        n++;
    return n;
}

/* Draws from a source of its own: that of the timer is the tick's. */
static const char *drawn(const struct subject *subject, struct random_source *from)
{
    if (random_below(from, 3) == 0)
        return anybody[random_below(from, sizeof anybody / sizeof anybody[0])];
    return subject->lines[random_below(from, length(subject->lines))];
}

/* As a client that does not put a plan that waits into force first. A value is a number of the state that the tick finds or leaves. */
static void look_at_values(void)
{
    static struct session client;
    float value = 0;
    session_init(&client, app_door(app_instance()));
    for (uint8_t block = 0; block < CONFIG_BLOCKS; block++)
        for (unsigned i = 0; operate_block_value(&client, block, i, &value); i++)
            ;
}

static void interrupted(const struct subject *subject)
{
    struct random_source lines = {INTERRUPTING_SEED};
    unsigned n = sample_every_case ? 20u * LINES : LINES;
    configured(subject);
    memory_port_set_tick_lock(lock, unlock);
    refusals_expected = true;
    begin_interrupting();
    for (unsigned k = 0; k < n; k++) {
        hal_tick_lock();
        (void)typed(drawn(subject, &lines)); /* some are refused, as they should */
        arm(6000); /* a plan that waits comes into force in the midst of what follows */
        hal_tick_unlock();
        look_at_values();
        for (unsigned turns = random_below(&lines, 20); turns; turns--) {
            main_turns = main_turns + 1u;
            app_background(app_instance());
        }
        if (random_below(&lines, 16) == 0)
            loops_to_auto();
    }
    end_interrupting();
    refusals_expected = false;
    memory_port_set_tick_lock(NULL, NULL);
    TEST_ASSERT_TRUE_MESSAGE(typed("version"), subject->name);
    TEST_ASSERT_FALSE_MESSAGE(plant.no_number, subject->name);
    TEST_ASSERT_TRUE(plant_line.commands > n / 10);
}

void setUp(void) {}
void tearDown(void)
{
    memory_port_set_tick_lock(NULL, NULL);
}

static void blocks_bear_a_tick_anywhere_while_they_are_listed_switched_and_retuned(void)
{
    for (unsigned k = 0; k < sizeof subjects / sizeof subjects[0]; k++) {
        interrupted(&subjects[k]);
        (void)printf("%s: seed 0x%x, %u commands\n", subjects[k].name, INTERRUPTING_SEED,
                     plant_line.commands);
    }
}

int main(int argc, char **argv)
{
    sample_arguments(argc, argv);
    UNITY_BEGIN();
    RUN_TEST(blocks_bear_a_tick_anywhere_while_they_are_listed_switched_and_retuned);
    return UNITY_END();
}

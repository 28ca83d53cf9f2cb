/* Resets that leave the memory alone: what comes first, what comes back, and when nothing does. */
#include "board_bench.h"
#include "hal/identity.h"
#include "hal/retained.h"
#include "supervise/restart.h"

void setUp(void) {}
void tearDown(void) {}

static void set_policy(const char *policy)
{
    char line[64];
    snprintf(line, sizeof line, "set restart.policy %s", policy);
    ask_ok(line);
}

/* bottom in automatic at 118, top by hand at 4. */
static void acting(const char *policy)
{
    running();
    set_policy(policy);
    samples(1);
    ask_ok("mode bottom auto");
    ask_ok("sp bottom 118");
    ask_ok("out top 4");
    samples(30);
    board_forget();
}

/* The same plant, whose heat is counted in another unit. */
static void heat_in_watts(uint8_t index, struct link_page *m)
{
    *m = (struct link_page){.index = index, .manipulated = index >= 4, .hi = 200};
    const char *name = index < 4 ? board.names[index] : index == 4 ? "reflux" : "heat";
    const char *unit = index < 4 ? board.units[index] : index == 4 ? "l/h" : "W";
    snprintf(m->name, sizeof m->name, "%s", name);
    snprintf(m->unit, sizeof m->unit, "%s", unit);
    m->safe = index == 4 ? 1.0f : index == 5 ? 0.25f : 0.0f;
}

/* A reset, the plant met again; configured as before when that is wanted (by hand: no storage here). */
static void reset(enum hal_reset reason)
{
    memory_port_reset(reason);
    board.ready = false;
    board_run();
    type("mode machine\n");
    pass(1000);
    TEST_ASSERT_TRUE(board.ready);
    board_forget();
}

static void configured_as_before(const char *policy)
{
    configure();
    set_policy(policy);
}

static void the_first_command_is_safe_before_any_configuration_is_there(void)
{
    acting("resume");
    reset(HAL_RESET_WATCHDOG);
    samples(1);
    TEST_ASSERT_TRUE(board.command.safe);
    for (unsigned j = 0; j < 2; j++)
        TEST_ASSERT_TRUE(board.command.output[j].drive);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, board.command.output[0].value); /* as the plant announced it */
    TEST_ASSERT_EQUAL_FLOAT(0.25f, board.command.output[1].value);
}

static void with_policy_safe_nothing_comes_back(void)
{
    acting("safe");
    reset(HAL_RESET_WATCHDOG);
    samples(1);
    configured_as_before("safe");
    samples(30);
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, board.command.output[1].value);
}

static void hold_brings_the_outputs_back_in_manual(void)
{
    acting("hold");
    float heat = board.command.output[1].value;
    TEST_ASSERT_TRUE(heat > 0.51f); /* it had been working */
    reset(HAL_RESET_FAULT);
    samples(1);
    TEST_ASSERT_TRUE(board.command.safe);
    configured_as_before("hold");
    samples(1);
    TEST_ASSERT_TRUE(said("RESTART_DONE") || board.command.output[1].value == heat);
    TEST_ASSERT_EQUAL_FLOAT(4.0f, board.command.output[0].value);
    TEST_ASSERT_EQUAL_FLOAT(heat, board.command.output[1].value);
    samples(20);
    TEST_ASSERT_EQUAL_FLOAT(heat, board.command.output[1].value);
    ask_ok("loop bottom");
    TEST_ASSERT_TRUE(said("bottom manual"));
}

static void resume_brings_modes_and_setpoints_back_without_a_bump(void)
{
    acting("resume");
    float heat = board.command.output[1].value;
    reset(HAL_RESET_WATCHDOG);
    samples(1);
    configured_as_before("resume");
    samples(1);
    TEST_ASSERT_FLOAT_WITHIN(0.02f, heat, board.command.output[1].value);
    TEST_ASSERT_EQUAL_FLOAT(4.0f, board.command.output[0].value);
    float before = board.command.output[1].value;
    samples(20);
    TEST_ASSERT_TRUE(board.command.output[1].value >
                     before); /* still below its setpoint: it works */
    ask_ok("loop bottom");
    TEST_ASSERT_TRUE(said("bottom auto"));
    TEST_ASSERT_TRUE(said("118"));
}

static void with_the_configuration_in_storage_nobody_has_to_do_anything(void)
{
    static const char *const policies[] = {"safe", "hold", "resume"};
    for (unsigned k = 0; k < 3; k++) {
        memory_port_erase_all();
        running();
        set_policy(policies[k]);
        samples(1);
        ask_ok("save");
        pass(500);
        ask_ok("mode bottom auto");
        ask_ok("sp bottom 118");
        ask_ok("out top 4");
        samples(30);
        float heat = board.command.output[1].value;
        reset(HAL_RESET_WATCHDOG);
        samples(1);
        TEST_ASSERT_TRUE(board.command.safe); /* first, and always */
        pass(500);
        samples(2);
        TEST_ASSERT_EQUAL(k == 0, board.command.safe);
        TEST_ASSERT_FLOAT_WITHIN(0.03f, k == 0 ? 0.5f : heat, board.command.output[1].value);
        ask_ok("loop bottom");
        TEST_ASSERT_EQUAL(k == 2, said("bottom auto"));
    }
    memory_port_erase_all();
}

static void another_configuration_is_not_resumed(void)
{
    acting("resume");
    reset(HAL_RESET_WATCHDOG);
    samples(1);
    configured_as_before("resume");
    ask_ok("set loop2.gain 1.4");
    samples(1);
    TEST_ASSERT_TRUE(board.command.safe);
}

/* restart.limit is 60 s. The sample that brings the settings back is the second: the first command is the safe one. */
static void it_comes_back_at_the_limit_of_time_and_not_after_it(void)
{
    static const uint32_t late_ms[] = {59000, 59001};
    for (unsigned k = 0; k < 2; k++) {
        acting("hold");
        reset(HAL_RESET_WATCHDOG);
        configured_as_before("hold");
        sample_after(late_ms[k]);
        TEST_ASSERT_TRUE(board.command.safe);
        samples(1);
        TEST_ASSERT_EQUAL_MESSAGE(k == 1, board.command.safe, "at the limit, then after it");
    }
}

static void an_output_that_does_not_fit_the_plant_does_not_come_back_and_the_others_do(void)
{
    acting("hold");
    memory_port_reset(HAL_RESET_WATCHDOG);
    board.ready = false;
    board.announce = heat_in_watts;
    board.n_measurements = 4;
    board.n_outputs = 2;
    board_run();
    type("mode machine\n");
    pass(1000);
    samples(1);
    configured_as_before("hold");
    board_forget();
    samples(2);
    TEST_ASSERT_TRUE(said("RESTART_DONE"));
    TEST_ASSERT_TRUE(board.command.output[0].drive);
    TEST_ASSERT_EQUAL_FLOAT(4.0f, board.command.output[0].value);
    TEST_ASSERT_FALSE(board.command.output[1].drive); /* nobody's */
    /* Once it fits it begins at the safe value, not where the heater was before the reset. */
    ask_ok("set mv2.unit W");
    samples(2);
    TEST_ASSERT_EQUAL_FLOAT(4.0f, board.command.output[0].value);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, board.command.output[1].value);
}

static void a_plant_that_comes_late_or_was_restarted_is_not_resumed(void)
{
    acting("resume");
    reset(HAL_RESET_WATCHDOG);
    sample_after(61000);
    configured_as_before("resume");
    board_forget();
    samples(1);
    TEST_ASSERT_TRUE(board.command.safe);
    acting("resume");
    memory_port_reset(HAL_RESET_WATCHDOG);
    board.session++;
    board.time_ms = 0;
    board.ready = false;
    board_run();
    type("mode machine\n");
    pass(1000);
    samples(1);
    configured_as_before("resume");
    samples(3);
    TEST_ASSERT_TRUE(board.command.safe);
}

static void an_operator_who_acts_first_is_not_overruled(void)
{
    acting("resume");
    reset(HAL_RESET_WATCHDOG);
    samples(1);
    configure();
    ask_ok("out top 7");
    samples(1);
    set_policy("resume");
    samples(3);
    TEST_ASSERT_EQUAL_FLOAT(7.0f, board.command.output[0].value);
    ask_ok("loop bottom");
    TEST_ASSERT_TRUE(said("bottom manual"));
}

static void after_power_on_nothing_is_resumed_whatever_the_memory_holds(void)
{
    acting("resume");
    reset(HAL_RESET_POWER_ON); /* a dip too short for the memory to forget */
    samples(1);
    configured_as_before("resume");
    samples(3);
    TEST_ASSERT_TRUE(board.command.safe);
}

static void a_record_with_any_bit_wrong_is_not_resumed(void)
{
    uint8_t *record = hal_retained(HAL_RETAINED_RESTART, sizeof(struct restart_record));
    unsigned refused = 0;
    TEST_ASSERT_NOT_NULL(record);
    acting("resume");
    struct restart_record copy;
    memcpy(&copy, record, sizeof copy);
    for (size_t bit = 0; bit < 8 * sizeof copy; bit++) {
        struct restart r;
        memcpy(record, &copy, sizeof copy);
        record[bit / 8] ^= (uint8_t)(1u << (bit % 8));
        restart_init(&r, record, true);
        refused += !r.pending && r.damaged;
    }
    TEST_ASSERT_EQUAL(8 * sizeof copy, refused);
    printf("restart record: %u of %u single-bit errors refused\n", refused,
           (unsigned)(8 * sizeof copy));
}

static void a_damaged_record_is_told_once(void)
{
    acting("hold");
    uint8_t *record = hal_retained(HAL_RETAINED_RESTART, sizeof(struct restart_record));
    record[sizeof(struct restart_record) / 2] ^= 1u;
    reset(HAL_RESET_PIN);
    samples(1);
    TEST_ASSERT_TRUE(said("RESTART_REFUSED record"));
    board_forget();
    configured_as_before("hold");
    samples(3);
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_FALSE(said("RESTART_REFUSED"));
}

static void a_board_that_resets_again_and_again_stays_safe_in_the_end(void)
{
    acting("resume");
    for (unsigned n = 1; n <= 5; n++) {
        reset(HAL_RESET_FAULT);
        samples(1);
        configured_as_before("resume");
        samples(2);
        TEST_ASSERT_EQUAL_MESSAGE(n > RESTART_ATTEMPTS, board.command.safe, "attempt");
    }
    acting("resume");
    for (unsigned n = 1; n <= 5; n++) { /* each lasted */
        reset(HAL_RESET_FAULT);
        samples(1);
        configured_as_before("resume");
        samples(RESTART_LASTED + 5);
        TEST_ASSERT_FALSE(board.command.safe);
    }
}

static void a_loop_whose_measurement_is_bad_stays_in_manual(void)
{
    acting("resume");
    reset(HAL_RESET_WATCHDOG);
    board.values[1] = 1000;
    samples(1);
    configured_as_before("resume");
    samples(2);
    ask_ok("loop bottom");
    TEST_ASSERT_TRUE(said("bottom manual"));
    TEST_ASSERT_FALSE(board.command.safe);
}

static void the_reason_of_the_start_is_told(void)
{
    acting("safe");
    reset(HAL_RESET_WATCHDOG);
    ask_ok("version");
    TEST_ASSERT_TRUE(said("started by: watchdog"));
    ask_ok("events");
    TEST_ASSERT_TRUE(said("STARTED watchdog"));
}

static void alarms_are_acknowledged_and_shelved_on_the_console(void)
{
    running();
    ask_ok("begin");
    ask_ok("set alarm1.on T10");
    ask_ok("set alarm1.limit 120");
    ask_ok("set alarm1.group a");
    ask_ok("set alarm1.priority high");
    ask_ok("apply");
    board.values[1] = 121;
    samples(2);
    ask_ok("alarm");
    TEST_ASSERT_EQUAL_STRING("ALARM_ON T10.hi alarm1 high unacknowledged first of its group"
                             ", T10 = 121 degC, limit 120 degC",
                             reply[0]);
    ask_ok("alarm ack T10.hi");
    samples(1);
    ask_ok("alarm");
    TEST_ASSERT_EQUAL_STRING("ALARM_ON T10.hi alarm1 high acknowledged first of its group"
                             ", T10 = 121 degC, limit 120 degC",
                             reply[0]);
    ask_ok("alarm shelve alarm1 60");
    samples(1);
    ask_ok("alarm");
    TEST_ASSERT_EQUAL_STRING_LEN("SHELVED T10.hi alarm1 high until ", reply[0], 33);
    TEST_ASSERT_TRUE_MESSAGE(said(", T10 = 121 degC, limit 120 degC\n"), board.said);
    ask_ok("alarm ack all");
    ask_refused("alarm ack nobody", "UNKNOWN");
    ask_refused("alarm shelve all 5", "UNKNOWN");
    ask_refused("alarm shelve T10.hi", "PARSE");
    ask_refused("alarm shelve T10.hi 1e6", "RANGE");
    ask_refused("alarm what", "PARSE");
}

static void a_plant_that_is_there_but_sends_no_samples_is_noticed_where_that_is_wanted(void)
{
    acting("safe");
    pass(20000); /* a simulator may take its time */
    samples(1);
    TEST_ASSERT_FALSE(board.command.safe);
    ask_ok("set tick.timeout 1.5");
    samples(1);
    pass(1400);
    samples(1);
    TEST_ASSERT_FALSE(board.command.safe);
    pass(20000);
    TEST_ASSERT_EQUAL(1, times_said(" SAMPLE_OVERDUE "));
    samples(1);
    TEST_ASSERT_TRUE(board.command.safe);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_first_command_is_safe_before_any_configuration_is_there);
    RUN_TEST(with_policy_safe_nothing_comes_back);
    RUN_TEST(hold_brings_the_outputs_back_in_manual);
    RUN_TEST(resume_brings_modes_and_setpoints_back_without_a_bump);
    RUN_TEST(with_the_configuration_in_storage_nobody_has_to_do_anything);
    RUN_TEST(another_configuration_is_not_resumed);
    RUN_TEST(it_comes_back_at_the_limit_of_time_and_not_after_it);
    RUN_TEST(an_output_that_does_not_fit_the_plant_does_not_come_back_and_the_others_do);
    RUN_TEST(a_plant_that_comes_late_or_was_restarted_is_not_resumed);
    RUN_TEST(an_operator_who_acts_first_is_not_overruled);
    RUN_TEST(after_power_on_nothing_is_resumed_whatever_the_memory_holds);
    RUN_TEST(a_record_with_any_bit_wrong_is_not_resumed);
    RUN_TEST(a_damaged_record_is_told_once);
    RUN_TEST(a_board_that_resets_again_and_again_stays_safe_in_the_end);
    RUN_TEST(a_loop_whose_measurement_is_bad_stays_in_manual);
    RUN_TEST(the_reason_of_the_start_is_told);
    RUN_TEST(alarms_are_acknowledged_and_shelved_on_the_console);
    RUN_TEST(a_plant_that_is_there_but_sends_no_samples_is_noticed_where_that_is_wanted);
    return UNITY_END();
}

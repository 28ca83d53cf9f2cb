/* The work of `ff_tune` between ticks shows nowhere: with one turn of the main loop for each of the tick's, every command is the same to the
 * bit as where the work is always done at once. */
#include "tune_bench.h"

#define SECONDS 2400u

static double commands[2][SECONDS];

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

static void hear_link(void)
{
    uint8_t byte;
    struct frame f;
    char said[256];
    while (memory_port_take(HAL_UART_CONSOLE, said, sizeof said) != 0) {
    }
    while (memory_port_take(HAL_UART_LINK, &byte, 1))
        if (frame_decode(&board.decoder, byte, &f))
            plant_answers(&f);
}

/* No more turns of the main loop than the answer to a sample takes. Returns whether it had to wait for work. */
static bool slow_second(void)
{
    struct link_sample sample;
    struct frame f;
    unsigned before = board.commands, turns = 0;
    instruments_measure(&instruments, plant, 1.0, &sample);
    sample.number = ++board.number;
    sample.time_ms = board.time_ms;
    pack_sample(&sample, &f);
    link_give(&f);
    for (; board.commands == before; turns++) {
        TEST_ASSERT_TRUE(turns < 10000);
        memory_port_turn();
        hear_link();
    }
    instruments_command(&instruments, &board.command);
    TEST_ASSERT_TRUE(instruments_drive(&instruments, plant, 1.0, plant_err, sizeof plant_err));
    board.time_ms += board.tick_ms;
    TEST_ASSERT_TRUE(
        kind->advance(plant, (double)board.time_ms / 1000.0, plant_err, sizeof plant_err));
    return turns > 1;
}

/* Seconds that have waited. */
static unsigned keep_commands(bool slow)
{
    unsigned waited = 0;
    tune_begin(FEEDFORWARD, 5, 1);
    ask_ok("begin");
    ask_ok("set block1.learn 1000");
    ask_ok("set block1.check 320");
    ask_ok("set block1.confident 200"); /* it is short */
    ask_ok("apply");
    tune_seconds(300);
    ask_ok("block 1 tune");
    for (unsigned k = 0; k < SECONDS; k++) {
        double t = (double)board.time_ms / 1000.0;
        set_disturbance(fmod(t, course.period) < course.period / 2 ? course.size : -course.size);
        if (slow)
            waited += slow_second();
        else
            plant_step();
        commands[slow][k] = commanded("u");
    }
    board_run();
    board_forget();
    ask_ok("get ff1.gain");
    TEST_ASSERT_FALSE_MESSAGE(said("ff1.gain = 0 "), "nothing was adopted");
    return waited;
}

static void every_command_is_the_same_however_fast_the_board_is(void)
{
    (void)keep_commands(false);
    plant_power_off();
    memory_port_erase_all();
    TEST_ASSERT_TRUE_MESSAGE(keep_commands(true) > 0, "no sample ever met work under way");
    for (unsigned k = 0; k < SECONDS; k++)
        if (commands[0][k] < commands[1][k] || commands[0][k] > commands[1][k])
            TEST_FAIL_MESSAGE("a command differs");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_command_is_the_same_however_fast_the_board_is);
    return UNITY_END();
}

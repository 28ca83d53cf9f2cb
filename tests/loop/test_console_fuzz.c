/* The console under input nobody meant: seeded noise, mutilated commands. The seed is in the failure message. */
#include "board_bench.h"
#include "random_source.h"

#define SEED 0xC0501Eu

static struct random_source source;
static char before[SAID_MAX];
static char message[300];

void setUp(void)
{
    running();
    source.state = SEED;
}
void tearDown(void) {}

static void remember_settings(void)
{
    ask_ok("list all");
    memcpy(before, board.said, board.n_said + 1);
}

static void settings_are_as_remembered(void)
{
    ask_ok("list all");
    TEST_ASSERT_EQUAL_STRING_MESSAGE(before, board.said, message);
}

static void noise_changes_nothing_and_the_console_answers_afterwards(void)
{
    snprintf(message, sizeof message, "seed 0x%x", SEED);
    remember_settings();
    for (unsigned n = 0; n < 3000; n++) {
        uint8_t noise[64];
        for (unsigned i = 0; i < sizeof noise; i++)
            noise[i] = (uint8_t)random_next(&source);
        memory_port_give(HAL_UART_CONSOLE, noise, sizeof noise);
        board_run();
        board_forget();
    }
    type("\x11\nmode machine\n"); /* XON: there was an XOFF in the noise */
    settings_are_as_remembered();
    samples(2);
    TEST_ASSERT_TRUE(board.command.safe);
}

static const char *const commands[] = {"set loop1.gain 2.5",
                                       "set meas1.hi 170",
                                       "set mv2.safe 0.25",
                                       "mode bottom auto",
                                       "sp bottom 118",
                                       "out top 4",
                                       "get loop2.ti",
                                       "help loop1.ti",
                                       "log on 3",
                                       "log off",
                                       "list tick",
                                       "begin",
                                       "apply",
                                       "abandon",
                                       "diff defaults",
                                       "status",
                                       "stats",
                                       "alarm",
                                       "events",
                                       "loop bottom",
                                       "mode top manual",
                                       "tune top simc 1 2 3",
                                       "set loop1.name top",
                                       "version"};

static void mutilate(char *line, size_t size)
{
    static const char letters[] = "abcdefgxyz0123456789.-+ ,|_!%ETH[]";
    for (unsigned n = 1 + random_below(&source, 3); n; n--) {
        size_t length = strlen(line);
        size_t at = length ? random_below(&source, (uint32_t)length) : 0;
        char c = letters[random_below(&source, sizeof letters - 1)];
        switch (random_below(&source, 4)) {
        case 0: /* changed */
            if (length)
                line[at] = c;
            break;
        case 1: /* left out */
            memmove(line + at, line + at + (length ? 1 : 0), length - at + (length ? 0 : 1));
            break;
        case 2: /* put in */
            if (length + 2 < size) {
                memmove(line + at + 1, line + at, length - at + 1);
                line[at] = c;
            }
            break;
        default: /* cut off */
            line[at] = '\0';
        }
    }
}

static void a_mutilated_command_gets_one_answer_and_a_refused_one_changes_nothing(void)
{
    char line[150];
    for (unsigned n = 0; n < 6000; n++) {
        snprintf(line, sizeof line, "%s",
                 commands[random_below(&source, sizeof commands / sizeof commands[0])]);
        mutilate(line, sizeof line);
        if (strspn(line, " ") == strlen(line) || strcmp(line, "mode human") == 0)
            continue;
        bool look = n % 20 == 0;
        if (look)
            remember_settings();
        snprintf(message, sizeof message, "seed 0x%x, line %u: %s", SEED, n, line);
        board_forget();
        type(line);
        type("\n");
        cut_reply();
        TEST_ASSERT_EQUAL_MESSAGE(1, n_replies, message);
        TEST_ASSERT_TRUE_MESSAGE(ends_reply(reply[n_reply - 1]), message);
        if (look && strcmp(reply[n_reply - 1], "ok") != 0)
            settings_are_as_remembered();
        if (n % 10 == 0)
            samples(1);
    }
}

static void noise_on_both_lines_at_once_never_leaves_the_safe_state_by_itself(void)
{
    for (unsigned n = 0; n < 1000; n++) {
        uint8_t noise[48];
        for (unsigned i = 0; i < sizeof noise; i++)
            noise[i] = (uint8_t)random_next(&source);
        memory_port_give(HAL_UART_CONSOLE, noise, sizeof noise);
        for (unsigned i = 0; i < sizeof noise; i++)
            noise[i] = (uint8_t)random_next(&source);
        memory_port_give(HAL_UART_LINK, noise, sizeof noise);
        memory_port_give(HAL_UART_LINK, "", 1);
        board_run();
        board_forget();
        samples(1);
        TEST_ASSERT_TRUE(board.command.safe);
        TEST_ASSERT_EQUAL_FLOAT(0.5f, board.command.output[1].value);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(noise_changes_nothing_and_the_console_answers_afterwards);
    RUN_TEST(a_mutilated_command_gets_one_answer_and_a_refused_one_changes_nothing);
    RUN_TEST(noise_on_both_lines_at_once_never_leaves_the_safe_state_by_itself);
    return UNITY_END();
}

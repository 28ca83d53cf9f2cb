/* Functions of the firmware that one line at the console enters: prints their addresses, `idle` for those of a turn of the main loop and
 * of the tick without a line. Built with -finstrument-functions by tests/bench/entered.py. */
#include "board_bench.h"

#define FUNCTIONS_MAX 4096

static const void *function[FUNCTIONS_MAX];
static unsigned functions;
static bool recording;

__attribute__((no_instrument_function)) void __cyg_profile_func_enter(void *entered, void *caller);
__attribute__((no_instrument_function)) void __cyg_profile_func_exit(void *entered, void *caller);

void __cyg_profile_func_enter(void *entered, void *caller)
{
    (void)caller;
    for (unsigned k = 0; recording && k < functions; k++)
        if (function[k] == entered)
            return;
    if (recording && functions < FUNCTIONS_MAX)
        function[functions++] = entered;
}

void __cyg_profile_func_exit(void *entered, void *caller)
{
    (void)entered;
    (void)caller;
}

static void print_functions(const char *during)
{
    recording = false;
    for (unsigned k = 0; k < functions; k++)
        printf("%s %p\n", during, function[k]);
    functions = 0;
}

void setUp(void) {}

void tearDown(void) {}

int main(int argc, char **argv)
{
    UNITY_BEGIN();
    power_on();
    configure();
    connect_plant();
    samples(3);
    ask_ok("begin");
    recording = true;
    board_run();
    samples(1);
    print_functions("idle");
    recording = true;
    (void)ask(argc > 1 ? argv[1] : "set loop1.gain 2");
    print_functions("line");
    return 0;
}

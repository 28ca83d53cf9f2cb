/* Counts the instructions of what decouples, a tick and a design, on the emulated STM32F405 (machine.c). */
#include "decoupling.h"
#include "cost.h"

int main(void)
{
    cost_of_decoupling_ticks();
    cost_of_decoupling_designs();
    cost_of_experiments();
    cost_say("done", 0, 0, 0, 0);
    for (;;) {
    }
}

/* The kind `experiment` where there is no model to be had: it has to say so, and why. */
#include "experiment_plant.h"

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

static const struct experiment_case kotyk = {
    "kotyk-column", 120000,       2,
    {"y1", "y2"},   {"u1", "u2"}, {"bits 7", "clock 4", "amplitude.1 1", "amplitude.2 1",
                                   "band.1 1.9", "band.2 2.9"}};
/* Its first output integrates. */
static const struct experiment_case integrating = {
    DECOUPLING "/integrating.json", 120000,       2,
    {"y1", "y2"},                   {"u1", "u2"}, {"bits 7", "clock 4", "amplitude.1 0.5",
                                                   "amplitude.2 0.5", "band.1 1.9", "band.2 2.9"}};
/* Not linear, and slower than the sequence is long. */
static const struct experiment_case pilot = {
    "pilot",       30000,         2,
    {"T1", "T9"},  {"Lr", "Qrb"}, {"bits 6", "clock 2", "periods 4", "amplitude.1 0.3",
                                   "amplitude.2 0.05", "band.1 10", "band.2 20"}};

static void show(const struct experiment_case *c)
{
    printf("%s: stage %d reason %g verdict %g at %g, fit %.1f %.1f apart %.1f %.1f gains %.4g %.4g %.4g %.4g others %.3g\n", c->plant,
           stage_of(1), value_of(1, "reason"), value_of(1, "verdict"), value_of(1, "at_fault"), value_of(1, "fit_1"),
           value_of(1, "fit_2"), value_of(1, "apart_1"), value_of(1, "apart_2"), value_of(1, "gain11"), value_of(1, "gain12"),
           value_of(1, "gain21"), value_of(1, "gain22"), value_of(1, "others_1"));
}

static void try_them(void)
{
    static const struct experiment_case *const all[] = {&integrating, &pilot};
    for (unsigned c = 0; c < 2; c++)
        for (uint64_t seed = 1; seed < 4; seed++) {
            begin_case(all[c], seed, 200);
            ask_ok("block 1 start");
            (void)until_over(1, 4000);
            show(all[c]);
            plant_power_off();
        }
    begin_case(&kotyk, 1, 200);
    ask_ok("set block1.amplitude.1 0.005");
    ask_ok("set block1.amplitude.2 0.005");
    plant_steps(2);
    ask_ok("block 1 start");
    (void)until_over(1, 4000);
    show(&kotyk);
    plant_power_off();
    begin_case(&kotyk, 1, 200);
    ask_ok("set loop1.action reverse");
    ask_ok("set loop1.gain 1");
    ask_ok("set loop1.ti 500");
    ask_ok("set loop2.action direct");
    ask_ok("set loop2.gain 1");
    ask_ok("set loop2.ti 1200");
    ask_ok("set block1.reach.1 4");
    ask_ok("set block1.reach.2 4");
    plant_steps(2);
    ask_ok("mode l1 auto");
    ask_ok("mode l2 auto");
    plant_steps(40);
    ask_ok("block 1 start");
    (void)until_over(1, 4000);
    show(&kotyk);
    plant_power_off();
    begin_case(&kotyk, 1, 200);
    ask_ok("block 1 start");
    plant_steps(100);
    plant_event("y2.frozen=1");
    (void)until_over(1, 4000);
    show(&kotyk);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(try_them);
    return UNITY_END();
}

/* The kind `experiment` from its verb to a proposal, over the real link. */
#include "experiment_plant.h"

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

/* Both inputs by 1 V, a fifth of the span to either side. */
static const struct experiment_case kotyk = {
    "kotyk-column", 120000,       2,
    {"y1", "y2"},   {"u1", "u2"}, {"bits 7", "clock 4", "amplitude.1 1", "amplitude.2 1",
                                   "band.1 0.8", "band.2 1.2"}};
static const struct experiment_case wood_berry = {
    "wood-berry", 60000,      2,
    {"xD", "xB"}, {"R", "S"}, {"period 120", "bits 7", "clock 4", "na 2", "nb 8",
                               "amplitude.1 0.05", "amplitude.2 0.05", "band.1 4", "band.2 6"}};
static const struct experiment_case kiln = {
    "lime-kiln",  30000,        2,
    {"y1", "y2"}, {"u1", "u2"}, {"period 60", "bits 7", "clock 4", "nb 8", "amplitude.1 5",
                                 "amplitude.2 5", "band.1 40", "band.2 40"}};

static void show(const char *name)
{
    printf("%s: verdict %g at %g, fit %.1f %.1f, gains %.4f %.4f %.4f %.4f\n", name,
           value_of(1, "verdict"), value_of(1, "at_fault"), value_of(1, "fit_1"),
           value_of(1, "fit_2"), value_of(1, "gain11"), value_of(1, "gain12"),
           value_of(1, "gain21"), value_of(1, "gain22"));
}

static void try_it(void)
{
    static const struct experiment_case *const all[] = {&kotyk, &wood_berry, &kiln};
    for (unsigned c = 0; c < 3; c++)
        for (uint64_t seed = 1; seed < 6; seed++) {
            begin_case(all[c], seed, 400);
            ask_ok("block 1 start");
            unsigned n = until_over(1, 8000);
            printf("%u steps, stage %d reason %g apart %.1f %.1f ", n, stage_of(1), value_of(1, "reason"), value_of(1,"apart_1"),value_of(1,"apart_2"));
            show(all[c]->plant);
            ask_ok("block 1");
            for (unsigned k = 0; k < n_reply; k++)
                if (0)
                    printf("%s", reply[k]);
            printf("\n");
            plant_power_off();
        }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(try_it);
    return UNITY_END();
}

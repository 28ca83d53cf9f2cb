#include "bench.h"

void setUp(void) {}
void tearDown(void)
{
    plant_power_off();
}

static void show(const char *what)
{
    printf("--- %s T1 %.3f T10 %.3f Lr %.3f Qrb %.4f\n", what, truly("T1"), truly("T10"), commanded("Lr"), commanded("Qrb"));
    ask("block 1");
    for (unsigned i = 0; i < n_reply; i++)
        printf("%s\n", reply[i]);
}

static void smoke(void)
{
    plant_power_on("pilot", TICK_MS, 1, 1.0);
    ask_file("../host_sim/scenarios/pilot.conf");
    ask_file(SELF_TUNING "/pair.conf");
    plant_connect();
    plant_steps(2);
    ask("status");
    for (unsigned i = 0; i < n_reply; i++)
        printf("%s\n", reply[i]);
    show("begin");
    ask_ok("mode top auto");
    ask_ok("mode bottom auto");
    double a = truly("T1"), b = truly("T10");
    setpoint("top", a);
    setpoint("bottom", b);
    for (unsigned k = 0; k < 12; k++) {
        setpoint("top", a + (k % 2 ? 0.3 : 0));
        setpoint("bottom", b + ((k + 1) / 2 % 2 ? 0.5 : 0));
        plant_steps(20);
        show("");
    }
    ask("log");
    for (unsigned i = 0; i < n_reply; i++)
        printf("%s\n", reply[i]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(smoke);
    return UNITY_END();
}

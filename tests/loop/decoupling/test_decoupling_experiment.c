#include "plant_board.h"
void setUp(void) { memory_port_erase_all(); }
void tearDown(void) { plant_power_off(); }
static void t(void)
{
    plant_power_on("kotyk-column", 120000, 3, 1);
    ask_file(DECOUPLING "/kotyk.conf");
    ask_file(DECOUPLING "/experiment.conf");
    plant_connect();
    plant_steps(2);
    ask_ok("out one 0");
    ask_ok("out two 0");
    plant_steps(60);
    ask_ok("block 4 start");
    plant_steps(300);
    (ask("block 4"), printf("%s\n", board.said));
    plant_steps(1300);
    (ask("block 4"), printf("%s\n", board.said));
    (ask("events"), printf("%s\n", board.said));
    (ask("proposal"), printf("%s\n", board.said));
    for (int k = 0; k < 6; k++) {
        (ask("proposal accept"), printf("%s\n", board.said));
        plant_steps(3);
    }
    (ask("list block4"), printf("%s\n", board.said));
    (ask("get block4.known"), printf("%s\n", board.said));
}
int main(void) { UNITY_BEGIN(); RUN_TEST(t); return UNITY_END(); }

/* Brings the board up and hands over to the firmware. */
#include "app/app.h"
#include "board.h"

int main(void)
{
    guard_start();
    clock_start();
    supply_start();
    identity_start();
    tick_start_timebase();
    uart_start();
    app_init(app_instance());
    tick_start();
    for (;;) {
        app_background(app_instance());
    }
}

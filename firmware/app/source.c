/* Where the plant is: at the link, or at the board's own pins. With the board clock, which steps what is at the pins.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "app/parts.h"

#include "hal/tick.h"
#include "outputs/outputs.h"

void binding_take_source(struct app *app)
{
    const struct config *config = &service_in_force(&app->service)->config;
    bool was_board = app->service.io.context == &app->board_io,
         is_board = pins_are_source(&config->pins);
    board_io_take(&app->board_io, config);
    if (is_board == was_board)
        return;
    app->service.io = is_board ? board_io_port(&app->board_io) : plant_link_port(&app->link);
    app->binding.io_state =
        IO_DOWN; /* whatever the tables of the two have in common, the plant is another one */
    app->binding.generation = app->service.io.generation(app->service.io.context) - 1u;
}

void source_main_loop_turns(void)
{
    outputs_report(OUTPUTS_MAIN_LOOP);
}

void source_clock(struct app *app, uint32_t now_ms)
{
    if (board_io_clock(&app->board_io, now_ms))
        hal_tick_request();
}

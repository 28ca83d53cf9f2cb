/* Where the plant is: at the link, at the board's own pins, or at both. With the board clock, which steps what is at the pins.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "app/parts.h"

#include "hal/tick.h"
#include "outputs/outputs.h"

static struct io_port port_of(struct app *app, enum io_source source)
{
    if (!CONFIG_LINK || source == IO_SOURCE_BOARD)
        return board_io_port(&app->board_io);
    return source == IO_SOURCE_LINK ? plant_link_port(app->link) : both_io_port(&app->both_io);
}

void binding_take_source(struct app *app)
{
    const struct config *config = &service_in_force(&app->service)->config;
    struct io_port port = port_of(app, pins_source(&config->pins));
    board_io_take(&app->board_io, config);
    if (port.context == app->service.io.context)
        return;
    if (CONFIG_LINK)
        plant_link_judge_anew(app->link); /* it may have been refused for what is at the pins */
    if (CONFIG_LINK && pins_source(&config->pins) == IO_SOURCE_BOTH)
        both_io_init(&app->both_io, &app->board_io, app->link);
    app->service.io = port;
    app->binding.io_state =
        IO_DOWN; /* whatever the tables of the two have in common, the plant is another one */
    app->binding.generation = port.generation(port.context) - 1u;
}

bool source_changed(const struct app *app)
{
    return app->service.io.generation(app->service.io.context) != app->binding.generation;
}

void source_follow_link(struct app *app)
{
    if (!CONFIG_LINK || app->service.io.context != &app->both_io ||
        !both_io_link_changed(&app->both_io))
        return;
    uint8_t first = both_io_first_of_link(&app->both_io, true);
    for (unsigned j = first; j < IO_CHANNELS_MAX; j++)
        app->tick.driven[j] = app->tick.command.output[j].drive = false;
    if (app->binding.announce_pending)
        binding_announce(app);
    else if (both_io_has_link(&app->both_io))
        binding_bind(app);
    else
        binding_lose_outputs(app, first);
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

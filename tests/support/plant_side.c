#include "plant_side.h"

#include "plant_board.h"

void plant_side_power_on(const char *name, uint32_t tick_ms)
{
    if (plant)
        plant_power_off();
    plant_power_on(name, tick_ms, 1, 0.0);
}

void plant_side_connect(void)
{
    plant_connect();
}

void plant_side_step(void)
{
    plant_step();
}

bool plant_side_channel(unsigned i, struct plant_side_channel *channel)
{
    const struct plant_channel *c = kind->channels;
    for (const struct plant_channel *end = c + kind->n_channels; c < end; c++)
        if ((c->kind == PLANT_MV || c->kind == PLANT_MEASUREMENT) && i-- == 0)
            break;
    if (c == kind->channels + kind->n_channels)
        return false;
    *channel = (struct plant_side_channel){.name = c->name,
                                           .unit = c->unit,
                                           .lo = c->lo,
                                           .hi = c->hi,
                                           .safe = c->safe,
                                           .manipulated = c->kind == PLANT_MV};
    return true;
}

double truly_is(const char *name)
{
    return truly(name);
}

double is_commanded(const char *name)
{
    return commanded(name);
}

void board_side_run(void)
{
    board_run();
}

void board_side_pass(uint32_t ms)
{
    pass(ms);
}

void console_types(const char *text)
{
    board_forget();
    type(text);
}

void console_does(const char *command)
{
    ask_ok(command);
}

void console_is_refused(const char *command, const char *code)
{
    ask_refused(command, code);
}

bool console_has_said(const char *text)
{
    return said(text);
}

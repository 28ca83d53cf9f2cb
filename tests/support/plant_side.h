/* plant_board.h and the console of board_bench.h for a test that looks into the firmware's headers itself, which the headers of
 * the bench do not agree with: they have double precision and events of their own. */
#ifndef REFLUX_TESTS_PLANT_SIDE_H
#define REFLUX_TESTS_PLANT_SIDE_H

#include <stdbool.h>
#include <stdint.h>

struct plant_side_channel {
    const char *name, *unit;
    double lo, hi, safe;
    bool manipulated;
};

/* Board and plant from the beginning, without noise, not yet connected. */
void plant_side_power_on(const char *name, uint32_t tick_ms);
void plant_side_connect(void);
/* A sample, its answer, and the plant goes on by one tick. */
void plant_side_step(void);
/* Channel i of the plant; false past the last. */
bool plant_side_channel(unsigned i, struct plant_side_channel *channel);
/* True values, and the last command. */
double truly_is(const char *name);
double is_commanded(const char *name);

/* Everything runs until nobody has anything more to say; or the board's clock goes on. */
void board_side_run(void);
void board_side_pass(uint32_t ms);

/* At the console. */
void console_types(const char *text);
void console_does(const char *command);
void console_is_refused(const char *command, const char *code);
/* ... since the last command. */
bool console_has_said(const char *text);

#endif

/* The whole firmware in one context. Every board's main() does the same three things:
 *
 *     static struct app app;
 *     app_init(&app);
 *     for (;;) app_background(&app);          main loop
 *     app_tick(&app);                         from the tick context (hal/tick.h)
 */
#ifndef REFLUX_APP_APP_H
#define REFLUX_APP_APP_H

#include <stddef.h>
#include <stdint.h>

struct app;
struct operate;

/* Returns the one instance, placed statically by app.c. */
struct app *app_instance(void);

/* Brings everything into its safe state. Call once, before interrupts reach the firmware. */
void app_init(struct app *app);

/* One turn of the main loop: console, telemetry, transmit rings, watchdog, idling. */
void app_background(struct app *app);

/* Returns the door (operate/operate.h), for a client beside the console. */
struct operate *app_door(struct app *app);

/* Handles link input, the tick when a sample is due, and silence of the link. Short and never waits. */
void app_tick(struct app *app);

/* The board clock: what is at the board's pins goes on by a millisecond. Called once for each, above the tick context, which it may ask for.
 * Short and never waits. Boards without HAL_BOARD_CLOCK (hal/tick.h) have none. */
void app_clock(struct app *app, uint32_t now_ms);

/* Writes the next frame that keeps the plant link alive, for a port that sends it while it erases flash and no tick can run. Returns its
 * bytes, 0 if no plant is there. For the main loop, with the tick held off. */
#define APP_KEEP_ALIVE_BYTES 9
size_t app_keep_alive(struct app *app, uint8_t *wire);

/* Returns the large memory that families lease (base/workspace.h), and tests that play one; NULL if the board has
 * none. For the main loop. */
struct workspace;
struct workspace *app_workspace(struct app *app);

#endif

/* The pins of an STM32's port as a release build has them, under other names beside those of a debug build. */
#undef NDEBUG
#define NDEBUG
#define pins_start           release_pins_start
#define pins_freeze_watchdog release_pins_freeze_watchdog
#define hal_board_name       release_board_name
#define hal_board_text       release_board_text
/* NOLINTNEXTLINE(bugprone-suspicious-include) */
#include "pins.c"

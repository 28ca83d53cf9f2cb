/* Limits that fit 8 KiB of RAM: those of the STM32F100 build, read before every file (tools/cmake/options.cmake).
 * The headers that own these names say what they mean; `version` prints those that a user meets.
 *
 * Shortened against the larger boards: channels, loops, feedforwards, interlocks, alarms, dead times, history of
 * events, queues, console lines. Left out: history of console lines, sequences, measurement offsets, guard and deviation
 * alarm of loops that act, help for people at the console (CONFIG_PEOPLE).
 */
#ifndef REFLUX_STM32F100_LIMITS_H
#define REFLUX_STM32F100_LIMITS_H

#define CHANNEL_MAX         4
#define CONFIG_LOOPS        2
#define DECOUPLER_MAX       2
#define CONFIG_FEEDFORWARDS 1
#define CONFIG_INTERLOCKS   2
#define CONFIG_ALARMS       1
#define COMMISSION_CHANNELS 0
#define JOBS_MAX            0
#define WORKSPACE_BYTES     0
#define CONFIG_STEPS        0
#define CONFIG_DEVICES      0
#define CONFIG_LOOP_GUARD   0
#define EVENT_LOG_JOINS     0
#define PLAN_ARENA_BYTES    1280

/* A plant may have more channels than can be configured; their names must fit. */
#define IO_CHANNELS_MAX    6
#define LINK_CHANNELS_ROOM 6
#define LINK_TEXT_BYTES    80
#define LINK_RX_BLOCK      8
#define FRAME_PAYLOAD_MAX  76

/* Look-up table of the checksum: 64 bytes of flash instead of 1 KiB. */
#ifndef CRC32_TABLE
#define CRC32_TABLE 16
#endif

#define REQUEST_QUEUE_SIZE   4
#define EVENT_QUEUE_SIZE     4
#define TELEMETRY_QUEUE_SIZE 2
#define EVENT_HISTORY        4

#define STORAGE_PIECE       16u
#define CONSOLE_RX_BLOCK    8
#define LINE_EDITOR_MAX     56
#define LINE_EDITOR_HISTORY 1
#define LINE_EDITOR_CHOICES 80
#define SECRET_CAPITALS     0
#define CONSOLE_OUTPUT_MAX  120
#define CONSOLE_REPLY_ROOM  248

#define HAL_RETAINED_RESTART_BYTES 64
#define HAL_RETAINED_EVENTS_BYTES  (32 * EVENT_HISTORY)
#define UART_CONSOLE_RX            64
#define UART_CONSOLE_TX            256
#define UART_LINK_RX               64
#define UART_LINK_TX               64

#define BOARD_CHECKS 0 /* hal/self_check.h */

#endif

/* Limits of the STM32F100 whose plant is at its own pins (-DREFLUX_PINS=ON), in 8 KiB of RAM. Read before every file (tools/cmake/options.cmake);
 * the headers that own these names say what they mean.
 *
 * Against limits.h it has devices and outputs, and no plant link. Devices are MAX31865, DS18B20 and contacts, outputs are windows, relays and a
 * contactor. A device takes 320 bytes and an output 324, of which 136 and 168 are its settings in two plans. So there are two of each, half as
 * many channels, one interlock less, and 368 bytes less of the arena.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_STM32F100_LIMITS_PINS_H
#define REFLUX_STM32F100_LIMITS_PINS_H

#define CONFIG_LINK      0
#define CONFIG_DEVICES   2
#define OUTPUTS_MAX      2u
#define DEVICE_ALL_KINDS 0
#define DEVICE_CODES     2u
#define DEVICE_BUFFER    20u
#define DEVICE_KEPT      8u
#define LINE_CLAIMS_MAX  4u /* the bus of each device, and its chip */
#define OUTPUT_ALL_KINDS 0

#define CHANNEL_MAX         2
#define CONFIG_LOOPS        2
#define DECOUPLER_MAX       2
#define CONFIG_FEEDFORWARDS 1
#define CONFIG_INTERLOCKS   1
#define CONFIG_ALARMS       1
#define COMMISSION_CHANNELS 0
#define JOBS_MAX            0
#define WORKSPACE_BYTES     0
#define CONFIG_STEPS        0
#define CONFIG_LOOP_GUARD   0
#define EVENT_LOG_JOINS     0
#define PLAN_ARENA_BYTES    912

#define IO_CHANNELS_MAX 2

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
/* An event and what contradicts an output, as far as "relay stuck or shorted". */
#define CONSOLE_OUTPUT_MAX 192
#define CONSOLE_REPLY_ROOM 248

#define HAL_RETAINED_RESTART_BYTES 64
#define HAL_RETAINED_EVENTS_BYTES  (32 * EVENT_HISTORY)
#define UART_CONSOLE_RX            64
#define UART_CONSOLE_TX            256

#define BOARD_CHECKS 0 /* hal/self_check.h */

#endif

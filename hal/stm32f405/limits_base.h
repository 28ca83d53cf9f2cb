/* The base image of the STM32F405 (-DREFLUX_BASE=ON): regulatory control alone, on little memory. Read before every
 * file (tools/cmake/options.cmake); the headers that own these names say what they mean.
 *
 * Left out: sequences, measurement offsets, automatic start-up, calibration, guard and alarms of acting loops, help for people, one entry for
 * events that repeat. Short: half as many channels as the full image, and
 * queues and rings that hold what such a configuration needs. ^L does not clear the screen.
 */
#ifndef REFLUX_STM32F405_LIMITS_BASE_H
#define REFLUX_STM32F405_LIMITS_BASE_H

#define CONFIG_STEPS        0
#define CONFIG_DEVICES      0
#define CONFIG_LOOP_GUARD   0
#define EVENT_LOG_JOINS     0
#define COMMISSION_CHANNELS 0
#define JOBS_MAX            0
#define WORKSPACE_BYTES     0
#define CHANNEL_MAX         8

/* The plant may have twice as many channels as can be configured, if their names fit. */
#define LINK_TEXT_BYTES 448

/* Look-up table of the checksum: 64 bytes of flash instead of 1 KiB. */
#ifndef CRC32_TABLE
#define CRC32_TABLE 16
#endif

#define LINK_RX_BLOCK        32
#define CONSOLE_RX_BLOCK     16
#define LINE_EDITOR_CLEARS   0
#define SECRET_CAPITALS      0
#define LINE_EDITOR_HISTORY  192
#define EVENT_QUEUE_SIZE     16
#define TELEMETRY_QUEUE_SIZE 4

#define HAL_RETAINED_RESTART_BYTES 160
#define UART_CONSOLE_RX            512
#define UART_CONSOLE_TX            1024
#define UART_LINK_RX               256
#define UART_LINK_TX               256

#endif

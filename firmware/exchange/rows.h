/* Rows of tables for parts that a board may lack: START_UP_ROWS({...}, {...}) stands for these rows, or for nothing. */
#ifndef REFLUX_EXCHANGE_ROWS_H
#define REFLUX_EXCHANGE_ROWS_H

#include "exchange/config.h"

#define ROWS_HERE(...) __VA_ARGS__,
#define ROWS_NOWHERE(...)

#if CONFIG_BLOCKS
#define BLOCK_ROWS ROWS_HERE
#else
#define BLOCK_ROWS ROWS_NOWHERE
#endif
#if COMMISSION_CHANNELS
#define START_UP_ROWS ROWS_HERE
#else
#define START_UP_ROWS ROWS_NOWHERE
#endif
#if CONFIG_STEPS
#define SEQUENCE_ROWS ROWS_HERE
#else
#define SEQUENCE_ROWS ROWS_NOWHERE
#endif
#if CONFIG_LOOP_GUARD
#define GUARD_ROWS ROWS_HERE
#else
#define GUARD_ROWS ROWS_NOWHERE
#endif
#if CONFIG_ANALYSERS
#define ANALYSER_ROWS ROWS_HERE
#else
#define ANALYSER_ROWS ROWS_NOWHERE
#endif
#if CONFIG_CALIBRATION
#define CALIBRATION_ROWS ROWS_HERE
#else
#define CALIBRATION_ROWS ROWS_NOWHERE
#endif
#if CONFIG_DEVICES
#define DEVICE_ROWS             ROWS_HERE
#define DEVICE_NUMBER_ROWS(...) __VA_ARGS__ /* each ends with its comma */
#define DEVICE_VALUES(...)      __VA_ARGS__
#else
#define DEVICE_ROWS ROWS_NOWHERE
#define DEVICE_NUMBER_ROWS(...)
#define DEVICE_VALUES(...)
#endif

#endif

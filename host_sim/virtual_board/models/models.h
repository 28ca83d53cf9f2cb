/* The models that chips are made of; each file says from which manual.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_VIRTUAL_BOARD_MODELS_H
#define REFLUX_VIRTUAL_BOARD_MODELS_H

#include "chip.h"

extern const struct part_class system_control_class, trace_class; /* system_control.c */
extern const struct part_class rcc_f4_class, rcc_f1_class;        /* clocks */
extern const struct part_class flash_f4_class, flash_f1_class, stored_flash_class;
extern const struct part_class power_f4_class, power_f1_class;
extern const struct part_class watchdog_class;
extern const struct part_class usart_class;
extern const struct part_class gpio_f4_class, gpio_f1_class;
extern const struct part_class spi_class, spi_f1_class;
extern const struct part_class wire_class, wire_f1_class;
extern const struct part_class i2c_class;
extern const struct part_class exti_class, syscfg_class;
extern const struct part_class adc_class, adc_common_class, factory_class;
extern const struct part_class pwm_class, pwm32_class;
extern const struct part_class timer32_class, timer_capture_class;
extern const struct part_class debug_f4_class, debug_f1_class;
extern const struct part_class rtc_f1_class;

/* Clocks of the buses, of the RCC's model that the chip names. Hz. */
uint64_t bus_clock_hz(struct board *b, const char *bus);
uint64_t timer_clock_hz(struct board *b, const char *bus);
uint64_t rtc_clock_hz(struct board *b); /* 0: none chosen, or it does not run */
bool crystal_runs(struct board *b);
/* The crystal's far end: it fails or comes back in the run. */
void crystal_changed(struct board *b);
extern const struct clocks clocks_f4, clocks_f1;
/* For those models: dividers by their code in RCC_CFGR, and timers that run twice as fast as a divided bus. */
uint32_t ahb_divider(uint32_t code);
uint32_t apb_divider(uint32_t code);
uint64_t timer_of_bus_hz(struct board *b, const char *bus);

/* Of the RTC that lies in the backup domain: RCC_BDCR or what feeds it has changed; the domain is reset. */
void rtc_f1_clock_changed(struct board *b);
void rtc_f1_backup_reset(struct board *b);

/* voltage_detector.c: PVDO, for the bits of PWR_CR and the thresholds that they choose. */
struct voltage_detector {
    bool low;
};
void voltage_detector_reset(struct part *p, enum board_reset kind);
uint32_t voltage_detector(struct part *p, uint32_t cr, uint32_t falling_mv, uint32_t rising_mv);

/* The alternate function that a pin (0 = PA0) is given to. Where a chip does not number them: 0 drives the pin, PIN_INPUT listens. */
#define PIN_NO_FUNCTION 0xFFu
#define PIN_INPUT       0xFEu
uint8_t pin_function(struct board *b, char port, unsigned pin);
uint8_t pin_function_f4(struct board *b, char port, unsigned pin);
uint8_t pin_function_f1(struct board *b, char port, unsigned pin);
extern const struct pins_model pins_f4, pins_f1;

/* A glitch has set BUSY of this I2C bus, though both lines are high. */
void i2c_lock_busy(struct board *b, unsigned bus);
/* The part tells a bus error that was none, and goes on. */
void i2c_tell_bus_error(struct board *b, unsigned bus);

/* The flash interface decides what a store into the array does. */
void flash_f4_store(struct board *b, uint32_t at, unsigned bytes, uint32_t word);
void flash_f1_store(struct board *b, uint32_t at, unsigned bytes, uint32_t word);

/* Flash that the firmware writes: bytes, and bits that read differently each time. */
struct stored_flash {
    uint8_t *bytes;
    uint8_t *unstable;                  /* a set bit: read as either */
    bool cache_on;                      /* the chip's cache of data */
    bool cache_old;                     /* it holds what was there before a write */
    bool open;                          /* its interface takes stores and erases */
    bool watched;                       /* reads are counted */
    uint64_t words, erase_count, reads; /* since board_new() */
    /* For campaigns: the supply is cut within this word (1 = the first), or in this erase at this part of it. */
    uint64_t cut_word, cut_erase;
    uint32_t cut_per_mille;
    bool cut; /* it has been: the board has lost its supply */
};
struct stored_flash *stored_flash(struct board *b);

#endif

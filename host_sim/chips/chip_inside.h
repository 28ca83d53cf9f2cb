/* For the models of chips: what they share.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_CHIPS_CHIP_INSIDE_H
#define REFLUX_CHIPS_CHIP_INSIDE_H

#include "chips/chip.h"

#define CHIP_COUNT(table) (sizeof(table) / sizeof((table)[0]))
#define CHIP_MS(ms)       ((uint64_t)((ms)*1e6 + 0.5)) /* ns */

extern const struct chip_kind chip_max31865, chip_max31856, chip_ds18b20, chip_ads1115, chip_bme280,
    chip_bmp280, chip_xgzp6897, chip_ad5422, chip_analog, chip_flow, chip_mains, chip_level;

/* Notes a broken rule of the data sheet, behind the chip's name: "max31865: register 00h: notch changed in automatic mode". The first one
 * stays in c->wrong, all are counted. */
void chip_wrong(struct chip *c, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Random numbers that are the same on every machine: splitmix64 (Steele, Lea, Flood 2014). Uniform: in [0, 1). Normal: mean 0, standard
 * deviation 1, as the sum of twelve uniform ones. */
uint64_t chip_random(uint64_t *state);
double chip_uniform(uint64_t *state);
double chip_normal(uint64_t *state);

/* The nearest integer within lo..hi. */
int32_t chip_code(double x, int32_t lo, int32_t hi);

/* Parser of properties: hexadecimal, 0x48. */
bool chip_parse_hex(const char *text, double *value);

#endif

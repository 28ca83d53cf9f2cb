/* What the STM32F100 has and this port does not use: I2C, the converter, and pulses at pins.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "board.h"
#include "hal/analog.h"
#include "hal/i2c.h"

uint8_t hal_i2c_buses(void)
{
    return 0;
}

bool hal_i2c_pins(uint8_t bus, hal_pin pins[2])
{
    (void)bus;
    (void)pins;
    return false;
}

enum err hal_i2c_open(uint8_t bus)
{
    (void)bus;
    return ERR_RANGE;
}

enum err hal_i2c_start(uint8_t bus, uint8_t address, struct transfer *transfer)
{
    (void)bus;
    (void)address;
    (void)transfer;
    return ERR_RANGE;
}

void hal_i2c_stop(uint8_t bus)
{
    (void)bus;
}

bool hal_analog_has(hal_pin pin)
{
    (void)pin;
    return false;
}

void analog_clock(void) {}

void pulse_clock(void) {}

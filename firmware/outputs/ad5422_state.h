/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_OUTPUTS_AD5422_STATE_H
#define REFLUX_OUTPUTS_AD5422_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/spi.h"
#include "outputs/output_span.h"

#define AD5422_FRAME 3u /* bytes */

/* Owner: ad5422.c. */
struct output_ad5422 {
    struct transfer transfer; /* points to the bytes below */
    struct spi_device spi;
    uint8_t out[AD5422_FRAME], in[AD5422_FRAME];
    hal_pin clear;
    uint8_t stage;
    uint8_t range;    /* enum output_range */
    uint8_t status;   /* as last read */
    uint8_t failures; /* rounds in a row in which the chip did not have what it was given */
    uint8_t refusals; /* turns in a row in which the bus was somebody else's */
    uint8_t rest_ms;  /* to the next round */
    bool wrong;       /* the chip does not have what it was given, in this round */
    bool silent;      /* for so long that people are told; it is cleared */
    bool ready;       /* the chip has its range */
    bool wanted;      /* there is a command */
    bool released;    /* the clear pin is off */
    bool stored;      /* the chip has the code of `written` */
    uint32_t command; /* newest */
    uint32_t written;
    uint32_t actual; /* command whose code was read back; 0 while it is cleared */
    struct output_span span;
};

#endif

/* A chip that makes a current or a voltage: AD5422 and AD5420 (Analog Devices), DAC8760 and DAC8750 (Texas Instruments), which all have 16 bits
 * and the same commands. 4-20 mA, or 0-10 V, for a valve, a pump or a power controller.
 *
 * Safe: the clear pin (CLEAR, CLR), high with a pull-up resistor, holds the output at the bottom of its range, whatever the chip has been
 * told; so hal_output_safe(), a reset and a board without firmware let it fall. Its off is that pin. A safe position that is not off goes
 * through the bus. The output remains at the bottom when the pin is released, and a new value cannot be written before (SBAS538D, DAC Clear). A
 * pulse of the select without clocks would bring the old value back, so the first frame after a release writes the new one.
 *
 * What is written is read back in rounds: code, control register, status. A chip that does not have what it was given in FAILURES_MAX rounds is
 * told as not answering, and cleared. It is tried again in rounds further apart, and cleared at the first failure of such a round.
 *
 * Frames are an address and 16 bits of data, taken over when the select rises (SBAS528D 8.5.1). The clock rests low, and bits are read when it
 * rises: mode 0. A chip that is read answers in the frame behind the one that asks (AD5422 rev. I, p. 29). From one to the other it drives its data
 * output with each clock of the bus, whoever is selected, so that nobody else may have the bus between the two.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs/ad5422_state.h"

#include "devices/device.h"
#include "devices/line.h"
#include "outputs/output_kind.h"

/* Address bytes: AD5422 rev. I tables 6 to 9 (unverified); SBAS528D tables 8-14 to 8-16. */
#define SEND_DATA    0x01u
#define SEND_READ    0x02u
#define SEND_CONTROL 0x55u
#define READ_STATUS  0x00u
#define READ_DATA    0x01u
#define READ_CONTROL 0x02u

/* Control register, SBAS528D table 8-17: high byte. No external resistor, no slewing, no chain. */
#define CONTROL_ENABLE 0x10u

/* Status register, SBAS528D, read-only register: bits 5 to 15 are 0. */
#define STATUS_CURRENT 0x04u /* open circuit, or too little voltage for the current */
#define STATUS_HOT     0x01u
#define STATUS_UNUSED  0xE0u

#define CODE_MOST      0xFFFFu
#define SPI_HZ         1000000u
#define FRAME_MS       1u
#define ASK_MS         2u   /* a frame that asks, and the turn of the one that gets the answer */
#define REST_MS        50u  /* between two rounds: others have the bus for 9 of 10 milliseconds */
#define RETRY_MS       250u /* between two rounds of a chip that does not answer */
#define FAILURES_MAX   3u
#define REFUSALS_MAX   250u /* turns in which the bus was somebody else's */
#define CURRENT_RANGES 3u

enum ad5422_stage {
    AD5422_REST,
    AD5422_DISABLE, /* before another range, so that the output does not jump (SBAS538D, DAC Clear) */
    AD5422_ENABLE,
    AD5422_WRITE,
    AD5422_ASK_DATA,
    AD5422_GET_DATA,
    AD5422_ASK_CONTROL,
    AD5422_GET_CONTROL,
    AD5422_ASK_STATUS,
    AD5422_GET_STATUS
};

/* Of the words of out.range: bits of the control register. Those of currents first. */
static const uint8_t ranges[OUTPUT_RANGES] = {5, 6, 7, 0, 1};

static const char *ad5422_check(const struct output_settings *s)
{
    if (s->bus == 0)
        return "its chip needs an SPI bus";
    if (s->range >= OUTPUT_RANGES)
        return "there is no such range";
    return output_span_check(s);
}

static enum err ad5422_open(void *state, const struct output_settings *s, float *full)
{
    struct output_ad5422 *x = state;
    *full = 1.0f;
    *x = (struct output_ad5422){
        .clear = s->pin[OUTPUT_PIN],
        .range = s->range,
        .span = output_span_of(s),
        .spi = {.bus = s->bus, .select = s->pin[OUTPUT_SECOND_PIN], .mode = 0, .hz = SPI_HZ}};
    enum err err = hal_output_open(x->clear, true);
    return err ? err : hal_spi_open(&x->spi);
}

static void ad5422_close(void *state)
{
    struct output_ad5422 *x = state;
    if (x->transfer.state == TRANSFER_RUNS)
        hal_spi_stop(x->spi.bus);
    line_release(x);
}

static void ad5422_clear(struct output_ad5422 *x)
{
    hal_output_set(x->clear, false);
    x->released = false;
    x->stored = false;
    x->actual = 0;
}

static uint32_t ad5422_step(void *state, uint32_t command, uint32_t elapsed_ms)
{
    struct output_ad5422 *x = state;
    uint32_t amount = x->actual * elapsed_ms;
    x->wanted = true;
    x->command = command;
    return amount;
}

static uint32_t ad5422_off(void *state, uint32_t elapsed_ms)
{
    struct output_ad5422 *x = state;
    uint32_t amount = x->actual * elapsed_ms;
    x->wanted = false;
    ad5422_clear(x);
    return amount;
}

/* Output = bottom of the range + code / 2^16 of the range, so that its top is a code too much. */
static uint16_t ad5422_code(const struct output_ad5422 *x, uint32_t command)
{
    uint32_t part = output_span_part(&x->span, command);
    return (uint16_t)(part < CODE_MOST ? part : CODE_MOST);
}

/* A chip that is silent gets no value before a round in which it was not. */
static bool ad5422_has_to_write(const struct output_ad5422 *x)
{
    return x->wanted && x->ready && (!x->stored || x->command != x->written) &&
           (!x->silent || x->failures == 0);
}

static void ad5422_put(struct output_ad5422 *x, uint8_t address, uint8_t high, uint8_t low)
{
    x->out[0] = address;
    x->out[1] = high;
    x->out[2] = low;
}

/* The bytes of a frame. Returns whether it is one that goes out; false: zeros go out, and an answer comes in. */
static bool ad5422_fill(struct output_ad5422 *x)
{
    uint16_t code = ad5422_code(x, x->command);
    switch (x->stage) {
    case AD5422_DISABLE:
        ad5422_put(x, SEND_CONTROL, 0, ranges[x->range]);
        return true;
    case AD5422_ENABLE:
        ad5422_put(x, SEND_CONTROL, CONTROL_ENABLE, ranges[x->range]);
        return true;
    case AD5422_WRITE:
        x->stored = false;
        x->written = x->command;
        ad5422_put(x, SEND_DATA, (uint8_t)(code >> 8), (uint8_t)code);
        return true;
    case AD5422_ASK_DATA:
        ad5422_put(x, SEND_READ, 0, READ_DATA);
        return true;
    case AD5422_ASK_CONTROL:
        ad5422_put(x, SEND_READ, 0, READ_CONTROL);
        return true;
    case AD5422_ASK_STATUS:
        ad5422_put(x, SEND_READ, 0, READ_STATUS);
        return true;
    default:
        return false;
    }
}

static void ad5422_begin(struct output_ad5422 *x, uint32_t now_ms)
{
    bool sends = ad5422_fill(x);
    x->transfer = (struct transfer){.out = x->out,
                                    .in = x->in,
                                    .n_out = sends ? AD5422_FRAME : 0,
                                    .n_in = sends ? 0 : AD5422_FRAME,
                                    .state = TRANSFER_IDLE};
    bool asks = sends && x->out[0] == SEND_READ;
    bool free = line_claim(DEVICE_SPI, x->spi.bus, LINE_WHOLE, x, now_ms, asks ? ASK_MS : FRAME_MS);
    if (free && x->stage == AD5422_WRITE && !x->released) {
        x->released = true;
        hal_output_set(x->clear, true);
    }
    if (free && hal_spi_start(&x->spi, &x->transfer) == ERR_OK) {
        x->refusals = 0;
        return;
    }
    x->transfer.state = TRANSFER_IDLE;
    if (++x->refusals == REFUSALS_MAX) {
        x->refusals = 0;
        x->transfer.state = TRANSFER_FAILED;
    }
}

static void ad5422_end_round(struct output_ad5422 *x)
{
    x->stage = AD5422_REST;
    if (!x->wrong)
        x->failures = 0;
    else if (x->failures < FAILURES_MAX)
        x->failures++;
    /* It answers again when it has what is wanted of it. */
    if (!x->wrong && (x->stored || !x->wanted))
        x->silent = false;
    if (x->failures == FAILURES_MAX || (x->wrong && x->silent)) {
        x->silent = true;
        ad5422_clear(x);
    }
    /* A good round of a silent chip is followed by one that writes. */
    x->rest_ms = x->silent && x->wrong ? RETRY_MS : REST_MS;
}

static void ad5422_took_data(struct output_ad5422 *x)
{
    if (!x->stored)
        return; /* it is cleared, or never had one */
    uint16_t code = ad5422_code(x, x->written);
    if (x->in[1] == code >> 8 && x->in[2] == (code & 0xFFu)) {
        x->actual = x->written;
        return;
    }
    x->stored = false;
    x->wrong = true;
}

/* Takes what a frame has brought, and goes to the next one. */
static void ad5422_took(struct output_ad5422 *x)
{
    switch (x->stage) {
    case AD5422_ENABLE:
        x->ready = true;
        break;
    case AD5422_WRITE:
        x->stored = x->released; /* it may have been cleared meanwhile */
        break;
    case AD5422_GET_DATA:
        ad5422_took_data(x);
        break;
    case AD5422_GET_CONTROL:
        if (x->in[1] != CONTROL_ENABLE || x->in[2] != ranges[x->range]) {
            x->wrong = true;
            x->ready = x->stored = false;
            x->actual = 0;
        }
        break;
    case AD5422_GET_STATUS:
        x->wrong |= x->in[1] != 0 || (x->in[2] & STATUS_UNUSED) != 0;
        x->status = x->in[2];
        ad5422_end_round(x);
        return;
    default:
        break;
    }
    x->stage++;
    /* A new command does not wait for the end of a round, unless the chip has to be judged first. */
    bool between = x->stage == AD5422_ASK_CONTROL || x->stage == AD5422_ASK_STATUS;
    if (between && !x->wrong && ad5422_has_to_write(x))
        x->stage = AD5422_WRITE;
}

static void ad5422_clock(void *state, uint32_t now_ms)
{
    struct output_ad5422 *x = state;
    uint8_t end = x->transfer.state;
    if (end == TRANSFER_RUNS)
        hal_spi_stop(x->spi.bus);
    x->transfer.state = TRANSFER_IDLE;
    if (end == TRANSFER_DONE) {
        ad5422_took(x);
    } else if (end != TRANSFER_IDLE) {
        x->wrong = true;
        x->stored = false;
        ad5422_end_round(x);
    }
    if (x->stage == AD5422_REST) {
        bool hurries = ad5422_has_to_write(x) && !x->silent;
        if (x->rest_ms > 0 && !hurries) {
            x->rest_ms--;
            return;
        }
        x->wrong = false;
        x->stage = !x->ready                ? AD5422_DISABLE
                   : ad5422_has_to_write(x) ? AD5422_WRITE
                                            : AD5422_ASK_DATA;
    }
    if (x->stage == AD5422_WRITE && !ad5422_has_to_write(x))
        x->stage = AD5422_ASK_DATA; /* nothing to write, or not any more */
    ad5422_begin(x, now_ms);
}

static uint8_t ad5422_faults(const void *state)
{
    const struct output_ad5422 *x = state;
    if (x->silent)
        return OUTPUT_NO_CHIP;
    bool current = x->range < CURRENT_RANGES;
    return (uint8_t)((current && (x->status & STATUS_CURRENT) != 0 ? OUTPUT_LOOP_OPEN : 0) |
                     ((x->status & STATUS_HOT) != 0 ? OUTPUT_HOT : 0));
}

const struct output_kind ad5422_output = {.check = ad5422_check,
                                          .open = ad5422_open,
                                          .close = ad5422_close,
                                          .step = ad5422_step,
                                          .off = ad5422_off,
                                          .clock = ad5422_clock,
                                          .faults = ad5422_faults,
                                          .keeps_position = true};

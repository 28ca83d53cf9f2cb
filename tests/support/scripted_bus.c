/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "scripted_bus.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/analog.h"
#include "hal/pulse.h"
#include "random_source.h"
#include "unity.h"

#define LINES_MAX 256u
#define BYTES_MAX 64u

struct line_of_script {
    uint8_t out[BYTES_MAX], in[BYTES_MAX];
    unsigned n_out, n_in;
    enum transfer_state end;
    bool search;
    uint8_t branch, next_branch, last_rom[ONEWIRE_ROM_BYTES];
};

static struct line_of_script lines[LINES_MAX];
static uint32_t began_ms[LINES_MAX];
static unsigned written, made;
static bool noise;
static struct random_source noise_source;

struct script_seen script_seen;
struct script_board script_board;

void script_clear(void)
{
    written = made = 0;
    noise = false;
    script_seen = (struct script_seen){0};
    script_board = (struct script_board){.now_ms = 1000, .pulled_up = HAL_PIN_NONE};
}

static unsigned bytes_of(const char *hex, uint8_t *bytes)
{
    unsigned n = 0;
    for (const char *at = hex; *at != '\0';) {
        char *end;
        unsigned long byte = strtoul(at, &end, 16);
        TEST_ASSERT_TRUE_MESSAGE(end != at && byte <= 0xFF && n < BYTES_MAX, hex);
        bytes[n++] = (uint8_t)byte;
        at = end + strspn(end, " ");
    }
    return n;
}

static struct line_of_script *new_line(const char *out)
{
    TEST_ASSERT_LESS_THAN(LINES_MAX, written);
    struct line_of_script *line = &lines[written++];
    memset(line, 0, sizeof *line);
    line->n_out = bytes_of(out, line->out);
    line->end = TRANSFER_DONE;
    return line;
}

void script(const char *out, const char *in)
{
    struct line_of_script *line = new_line(out);
    line->n_in = bytes_of(in, line->in);
}

void script_fails(const char *out, unsigned n_in, enum transfer_state end)
{
    struct line_of_script *line = new_line(out);
    line->n_in = n_in;
    line->end = end;
}

void script_search(const char *last_rom, uint8_t branch, const char *rom, uint8_t next_branch)
{
    struct line_of_script *line = new_line("");
    bytes_of(last_rom, line->last_rom);
    line->n_in = bytes_of(rom, line->in);
    line->search = true;
    line->branch = branch;
    line->next_branch = next_branch;
}

void script_is_done(void)
{
    char text[80];
    snprintf(text, sizeof text, "transfers that were made, of those in the script");
    TEST_ASSERT_EQUAL_MESSAGE(written, made, text);
}

void script_run_several(struct device *const d[], unsigned n, uint32_t ms)
{
    for (uint32_t k = 0; k < ms; k++) {
        for (unsigned i = 0; i < n; i++)
            device_clock(d[i], script_board.now_ms);
        script_board.now_ms++;
    }
}

void script_run(struct device *d, uint32_t ms)
{
    script_run_several(&d, 1, ms);
}

uint32_t script_began_ms(unsigned n)
{
    TEST_ASSERT_LESS_THAN(made, n);
    return began_ms[n];
}

struct device_result script_result(const struct device *d)
{
    struct device_result result;
    device_read(d, &result);
    return result;
}

void script_noise(uint64_t seed)
{
    noise = true;
    noise_source.state = seed;
}

static enum err make_noise(struct transfer *t)
{
    static uint8_t before[BYTES_MAX];
    static const uint8_t ends[] = {TRANSFER_NO_ANSWER, TRANSFER_FAILED, TRANSFER_RUNS};
    uint32_t choice = random_below(&noise_source, 100);
    script_seen.transfers++;
    if (choice < 3)
        return ERR_STATE;
    t->state = choice < 9 ? ends[choice % 3] : TRANSFER_DONE;
    uint32_t how = random_below(&noise_source, 4);
    for (unsigned k = 0; k < t->n_in; k++) {
        if (how > 1)
            before[k] = (uint8_t)random_next(&noise_source);
        if (how == 1)
            before[k] = (choice & 1) != 0 ? 0xFF : 0x00;
        t->in[k] = before[k];
    }
    return ERR_OK;
}

static void hex_of(const uint8_t *bytes, unsigned n, char text[3 * BYTES_MAX + 1])
{
    text[0] = '\0';
    for (size_t k = 0; k < n; k++)
        snprintf(text + 3 * k, 4, "%02X ", bytes[k]);
}

/* The next line of the script, which this transfer must be. */
static struct line_of_script *follow(enum device_line bus_line, uint8_t bus,
                                     const struct transfer *t)
{
    char sent[3 * BYTES_MAX + 1], wanted[3 * BYTES_MAX + 1], where[64];
    script_seen.line = bus_line;
    script_seen.bus = bus;
    script_seen.transfers++;
    hex_of(t->out, t->n_out, sent);
    snprintf(where, sizeof where, "transfer %u at %u ms", made, (unsigned)script_board.now_ms);
    if (made == written) {
        char surplus[sizeof where + sizeof sent + 32];
        snprintf(surplus, sizeof surplus, "%s is not in the script: %s", where, sent);
        TEST_FAIL_MESSAGE(surplus);
    }
    struct line_of_script *line = &lines[made];
    began_ms[made++] = script_board.now_ms;
    hex_of(line->out, line->n_out, wanted);
    TEST_ASSERT_EQUAL_STRING_MESSAGE(wanted, sent, where);
    TEST_ASSERT_EQUAL_MESSAGE(line->n_in, t->n_in, where);
    return line;
}

static enum err start(enum device_line bus_line, uint8_t bus, struct transfer *t)
{
    if (noise)
        return make_noise(t);
    if (script_board.busy > 0) {
        script_board.busy--;
        return ERR_STATE;
    }
    struct line_of_script *line = follow(bus_line, bus, t);
    TEST_ASSERT_FALSE(line->search);
    if (line->end == TRANSFER_DONE)
        memcpy(t->in, line->in, line->n_in);
    else
        memset(t->in, 0x5A, line->n_in); /* means nothing */
    t->state = line->end;
    return ERR_OK;
}

enum err hal_spi_open(const struct spi_device *device)
{
    (void)device;
    return script_board.no_bus ? ERR_RANGE : ERR_OK;
}

enum err hal_spi_start(const struct spi_device *device, struct transfer *transfer)
{
    script_seen.spi = *device;
    return start(DEVICE_SPI, device->bus, transfer);
}

void hal_spi_stop(uint8_t bus)
{
    (void)bus;
    script_seen.stops++;
}

enum err hal_i2c_open(uint8_t bus)
{
    (void)bus;
    return script_board.no_bus ? ERR_RANGE : ERR_OK;
}

enum err hal_i2c_start(uint8_t bus, uint8_t address, struct transfer *transfer)
{
    script_seen.address = address;
    return start(DEVICE_I2C, bus, transfer);
}

void hal_i2c_stop(uint8_t bus)
{
    (void)bus;
    script_seen.stops++;
}

enum err hal_onewire_open(uint8_t bus)
{
    (void)bus;
    return script_board.no_bus ? ERR_RANGE : ERR_OK;
}

enum err hal_onewire_start(uint8_t bus, struct transfer *transfer)
{
    return start(DEVICE_ONEWIRE, bus, transfer);
}

enum err hal_onewire_search(uint8_t bus, struct transfer *transfer, volatile uint8_t *branch)
{
    if (noise) {
        *branch = (uint8_t)random_below(&noise_source, 65);
        return make_noise(transfer);
    }
    if (script_board.busy > 0) {
        script_board.busy--;
        return ERR_STATE;
    }
    struct line_of_script *line = follow(DEVICE_ONEWIRE, bus, transfer);
    TEST_ASSERT_TRUE(line->search || line->end != TRANSFER_DONE);
    if (line->search) {
        TEST_ASSERT_EQUAL(line->branch, *branch);
        TEST_ASSERT_EQUAL_HEX8_ARRAY(line->last_rom, transfer->in, ONEWIRE_ROM_BYTES);
    }
    if (line->end == TRANSFER_DONE) {
        memcpy(transfer->in, line->in, line->n_in);
        *branch = line->next_branch;
    }
    transfer->state = line->end;
    return ERR_OK;
}

void hal_onewire_stop(uint8_t bus)
{
    (void)bus;
    script_seen.stops++;
}

bool hal_pin_is_free(hal_pin pin)
{
    return pin != HAL_PIN_NONE && !script_board.pin_used;
}

void hal_pin_use(hal_pin pin, enum hal_pin_use use)
{
    TEST_ASSERT_EQUAL(HAL_PIN_INPUT_PULLED, use);
    script_board.pulled_up = pin;
}

bool hal_pin_read(hal_pin pin)
{
    return script_board.level[pin];
}

enum err hal_analog_open(hal_pin pin)
{
    return pin == HAL_PIN_NONE ? ERR_RANGE : ERR_OK;
}

bool hal_analog_read(hal_pin pin, uint16_t *code)
{
    (void)pin;
    *code = script_board.analog_code;
    return script_board.analog_ready;
}

float hal_analog_reference(void)
{
    return script_board.analog_reference;
}

enum err hal_pulse_open(hal_pin pin)
{
    return pin == HAL_PIN_NONE ? ERR_RANGE : ERR_OK;
}

uint32_t hal_pulse_count(hal_pin pin)
{
    (void)pin;
    return script_board.pulses;
}

void hal_pulse_set_dead_time(hal_pin pin, uint8_t dead_ms)
{
    (void)pin;
    script_board.dead_ms = dead_ms;
}

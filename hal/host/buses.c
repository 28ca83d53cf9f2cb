/* Buses and pins of the host: each transfer is done when it is begun. As many as the STM32F405 has, at the same pins.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "buses.h"

#include <string.h>

#include "hal/analog.h"
#include "hal/clock.h"
#include "hal/i2c.h"
#include "hal/onewire.h"
#include "hal/output.h"
#include "hal/pulse.h"
#include "hal/spi.h"
#include "hal/stm32f405/board_pins.h"

#define PINS        256u
#define SEARCH_BITS 64u
#define SUPPLY_MV   3300u
#define MEAN        16u /* conversions */
#define NS_PER_MS   UINT64_C(1000000)

static struct world outside;
static struct {
    bool output, low, pulled, on;
    bool counts, high; /* high: when an edge was looked for */
    bool converts;
    uint8_t dead_ms;
    uint8_t converted; /* conversions so far, at most MEAN */
    enum pin_level level;
    uint32_t pulses;
    uint64_t edge_ns; /* of the last falling edge; 0: there was none */
    uint16_t code[MEAN];
} pins[PINS];
static uint64_t looked_ns; /* edges of the world are counted up to here */
static unsigned turns;     /* of the clock */
static unsigned n_converting;

void buses_set_world(const struct world *world)
{
    outside = world != NULL ? *world : (struct world){.context = NULL};
    looked_ns = hal_clock_ms() * NS_PER_MS;
}

static uint64_t now_ns(void)
{
    return hal_clock_ms() * NS_PER_MS;
}

/* ---- pins ---- */

bool hal_pin_is_free(hal_pin pin)
{
    static const uint16_t free_pins[] = {FREE_A, FREE_B, FREE_C, FREE_D};
    return pin < WORLD_PINS && ((unsigned)free_pins[pin / 16u] >> pin % 16u & 1u) != 0;
}

static void drive(unsigned pin, enum pin_drive drive)
{
    if (outside.pin_driven != NULL)
        outside.pin_driven(outside.context, now_ns(), pin, drive);
}

static void drive_level(unsigned pin)
{
    drive(pin, pins[pin].on != pins[pin].low ? PIN_HIGH : PIN_LOW);
}

void hal_pin_use(hal_pin pin, enum hal_pin_use use)
{
    pins[pin].output = use == HAL_PIN_OUTPUT;
    pins[pin].pulled = use == HAL_PIN_INPUT_PULLED;
    pins[pin].on = pins[pin].low = false;
    if (pins[pin].output)
        drive_level(pin);
    else
        drive(pin, pins[pin].pulled ? PIN_PULLED_UP : PIN_FLOATS);
}

static bool is_high(unsigned pin, uint64_t at_ns)
{
    if (pins[pin].output)
        return pins[pin].on != pins[pin].low;
    enum pin_level level = PIN_LEVEL_OPEN;
    if (outside.pin_input != NULL)
        level = outside.pin_input(outside.context, at_ns, pin);
    if (level == PIN_LEVEL_OPEN)
        level = pins[pin].level;
    return level == PIN_LEVEL_OPEN ? pins[pin].pulled : level == PIN_LEVEL_HIGH;
}

bool hal_pin_read(hal_pin pin)
{
    return is_high(pin, now_ns());
}

void hal_pin_write(hal_pin pin, bool high)
{
    hal_output_set(pin, high);
}

/* A falling edge counts where no contact bounces. */
static void look_for_edge(unsigned pin, uint64_t at_ns)
{
    bool before = pins[pin].high;
    pins[pin].high = is_high(pin, at_ns);
    if (!pins[pin].counts || !before || pins[pin].high)
        return;
    bool bounces =
        pins[pin].edge_ns != 0 && at_ns - pins[pin].edge_ns < pins[pin].dead_ms * NS_PER_MS;
    pins[pin].edge_ns = at_ns;
    pins[pin].pulses += !bounces;
}

void buses_set_pin(unsigned pin, enum pin_level level)
{
    pins[pin].level = level;
    look_for_edge(pin, now_ns());
}

/* The edges that the world has made by itself since it was looked at. */
static void catch_up(void)
{
    uint64_t now = now_ns(), at_ns;
    while (outside.next_edge != NULL &&
           (at_ns = outside.next_edge(outside.context, looked_ns)) <= now) {
        looked_ns = at_ns;
        for (unsigned pin = 0; pin < WORLD_PINS; pin++)
            if (pins[pin].counts)
                look_for_edge(pin, at_ns);
    }
    looked_ns = now;
}

static unsigned convert(unsigned pin)
{
    double part = outside.pin_volts != NULL
                      ? outside.pin_volts(outside.context, now_ns(), pin) * 1000.0 / SUPPLY_MV
                      : 0.0;
    return part <= 0.0 ? 0 : part >= 1.0 ? 4095u : (unsigned)(part * 4095.0 + 0.5);
}

void buses_clock(void)
{
    catch_up();
    turns++;
    for (unsigned pin = 0; n_converting != 0 && pin < WORLD_PINS; pin++)
        if (pins[pin].converts) {
            pins[pin].code[turns % MEAN] = (uint16_t)convert(pin);
            pins[pin].converted = (uint8_t)(pins[pin].converted + (pins[pin].converted < MEAN));
        }
}

void buses_reset(void)
{
    for (unsigned pin = 0; pin < WORLD_PINS; pin++) {
        hal_pin_use((hal_pin)pin, HAL_PIN_CLOSED);
        pins[pin].counts = pins[pin].converts = false;
    }
    n_converting = 0;
}

/* ---- outputs ---- */

enum err hal_output_open(hal_pin pin, bool low)
{
    if (!hal_pin_is_free(pin))
        return ERR_RANGE;
    pins[pin].output = true;
    pins[pin].low = low;
    pins[pin].on = false;
    drive_level(pin);
    return ERR_OK;
}

void hal_output_set(hal_pin pin, bool on)
{
    if (!pins[pin].output || pins[pin].on == on)
        return;
    pins[pin].on = on;
    drive_level(pin);
}

static uint32_t pulse_hz[PINS];

static const struct {
    hal_pin pin;
    struct hal_pwm_place place;
} pwm_pins[] = {
#define ROW(port, number, timer, channel) {HAL_PIN(port, number), {timer, channel}},
    PWM_PINS(ROW)
#undef ROW
};

bool hal_pwm_find(hal_pin pin, uint32_t hz, struct hal_pwm_place *place)
{
    for (unsigned i = 0; i < sizeof(pwm_pins) / sizeof(pwm_pins[0]); i++) {
        *place = pwm_pins[i].place;
        if (pwm_pins[i].pin == pin)
            return hal_pin_is_free(pin) && hz != 0 && hz <= PWM_HZ_MOST;
    }
    return false;
}

enum err hal_pwm_open(hal_pin pin, uint32_t hz, bool low)
{
    struct hal_pwm_place place;
    if (!hal_pwm_find(pin, hz, &place))
        return ERR_RANGE;
    pulse_hz[pin] = hz;
    return hal_output_open(pin, low);
}

void hal_pwm_set(hal_pin pin, uint16_t part)
{
    if (!pins[pin].output)
        return;
    uint32_t counts = pwm_counts(PWM_TIMER_HZ, pulse_hz[pin]);
    double on = (double)pwm_compare(counts, part) / counts; /* in steps, as the chip has them */
    pins[pin].on = part != 0;
    if (outside.pin_pulses != NULL)
        outside.pin_pulses(outside.context, now_ns(), pin, pulse_hz[pin],
                           pins[pin].low ? 1.0 - on : on);
}

void hal_output_safe(void)
{
    for (unsigned pin = 0; pin < WORLD_PINS; pin++)
        hal_output_set((hal_pin)pin, false);
}

/* ---- SPI ---- */

uint8_t hal_spi_buses(void)
{
    return 3;
}

bool hal_spi_pins(uint8_t bus, hal_pin at[3])
{
    static const hal_pin of[3][3] = {{SPI1_PINS}, {SPI2_PINS}, {SPI3_PINS}};
    if (bus < 1 || bus > 3)
        return false;
    (void)memcpy(at, of[bus - 1u], sizeof(of[0]));
    return true;
}

enum err hal_spi_open(const struct spi_device *device)
{
    if (device->bus < 1 || device->bus > 3)
        return ERR_RANGE;
    drive(device->select, PIN_HIGH);
    return ERR_OK;
}

static uint8_t exchange(const struct spi_device *d, uint8_t out)
{
    return outside.spi_exchange != NULL
               ? outside.spi_exchange(outside.context, now_ns(), d->bus, d->mode, out)
               : 0xFFu;
}

enum err hal_spi_start(const struct spi_device *device, struct transfer *t)
{
    drive(device->select, PIN_LOW);
    for (unsigned i = 0; i < t->n_out; i++)
        (void)exchange(device, t->out[i]);
    for (unsigned i = 0; i < t->n_in; i++)
        t->in[i] = exchange(device, 0);
    drive(device->select, PIN_HIGH);
    t->state = TRANSFER_DONE;
    return ERR_OK;
}

void hal_spi_stop(uint8_t bus)
{
    (void)bus; /* nothing is ever under way */
}

/* ---- I2C ---- */

uint8_t hal_i2c_buses(void)
{
    return 2;
}

bool hal_i2c_pins(uint8_t bus, hal_pin at[2])
{
    static const hal_pin of[2][2] = {{I2C1_PINS}, {I2C2_PINS}};
    if (bus < 1 || bus > 2)
        return false;
    (void)memcpy(at, of[bus - 1u], sizeof(of[0]));
    return true;
}

enum err hal_i2c_open(uint8_t bus)
{
    return bus < 1 || bus > 2 ? ERR_RANGE : ERR_OK;
}

static bool address(uint8_t bus, uint8_t at, bool read)
{
    return outside.i2c_address != NULL &&
           outside.i2c_address(outside.context, now_ns(), bus, at, read);
}

static enum transfer_state i2c(uint8_t bus, uint8_t at, const struct transfer *t)
{
    if (outside.i2c_held != NULL && outside.i2c_held(outside.context, now_ns(), bus) != 0)
        return TRANSFER_FAILED;
    if ((t->n_out != 0 || t->n_in == 0) && !address(bus, at, false))
        return TRANSFER_NO_ANSWER;
    for (unsigned i = 0; i < t->n_out; i++)
        if (!outside.i2c_write(outside.context, now_ns(), bus, t->out[i]))
            return TRANSFER_FAILED;
    if (t->n_in != 0 && !address(bus, at, true))
        return TRANSFER_NO_ANSWER;
    for (unsigned i = 0; i < t->n_in; i++)
        t->in[i] = outside.i2c_read(outside.context, now_ns(), bus, i + 1u < t->n_in);
    return TRANSFER_DONE;
}

void hal_i2c_stop(uint8_t bus)
{
    if (outside.i2c_stop != NULL)
        outside.i2c_stop(outside.context, now_ns(), bus);
}

enum err hal_i2c_start(uint8_t bus, uint8_t at, struct transfer *t)
{
    t->state = (uint8_t)i2c(bus, at, t);
    hal_i2c_stop(bus);
    return ERR_OK;
}

/* ---- 1-wire ---- */

uint8_t hal_onewire_buses(void)
{
    return 2;
}

bool hal_onewire_pin(uint8_t bus, hal_pin *pin)
{
    if (bus < 1 || bus > 2)
        return false;
    *pin = bus == 1 ? WIRE1_PIN : WIRE2_PIN;
    return true;
}

enum err hal_onewire_open(uint8_t bus)
{
    return bus < 1 || bus > 2 ? ERR_RANGE : ERR_OK;
}

/* A bit written, or with true a bit read. */
static bool slot(uint8_t bus, bool out)
{
    if (outside.wire_bit == NULL)
        return out;
    return outside.wire_bit(outside.context, now_ns(), bus, out) == WIRE_SILENT && out;
}

static enum transfer_state wire_reset(uint8_t bus)
{
    enum wire_answer answer = outside.wire_reset != NULL
                                  ? outside.wire_reset(outside.context, now_ns(), bus)
                                  : WIRE_SILENT;
    return answer == WIRE_SILENT   ? TRANSFER_NO_ANSWER
           : answer == WIRE_PULLED ? TRANSFER_DONE
                                   : TRANSFER_FAILED;
}

static void byte_out(uint8_t bus, uint8_t byte)
{
    for (unsigned bit = 0; bit < 8; bit++)
        (void)slot(bus, ((unsigned)byte >> bit & 1u) != 0);
}

enum err hal_onewire_start(uint8_t bus, struct transfer *t)
{
    t->state = (uint8_t)wire_reset(bus);
    if (t->state != TRANSFER_DONE)
        return ERR_OK;
    for (unsigned i = 0; i < t->n_out; i++)
        byte_out(bus, t->out[i]);
    for (unsigned i = 0; i < t->n_in; i++) {
        t->in[i] = 0;
        for (unsigned bit = 0; bit < 8; bit++)
            t->in[i] |= (uint8_t)((slot(bus, true) ? 1u : 0u) << bit);
    }
    return ERR_OK;
}

enum err hal_onewire_search(uint8_t bus, struct transfer *t, volatile uint8_t *branch)
{
    uint8_t last = *branch, next = 0;
    t->state = (uint8_t)wire_reset(bus);
    if (t->state != TRANSFER_DONE)
        return ERR_OK;
    t->state = TRANSFER_NO_ANSWER;
    byte_out(bus, 0xF0u);
    for (unsigned k = 0; k < SEARCH_BITS; k++) {
        uint8_t *at = &t->in[k / 8u], mask = (uint8_t)(1u << k % 8u);
        bool one = slot(bus, true), zero = slot(bus, true);
        if (one && zero)
            return ERR_OK; /* nobody there any more */
        bool take = one;
        if (!one && !zero)
            take = k + 1u < last ? (*at & mask) != 0 : k + 1u == last;
        if (!one && !zero && !take)
            next = (uint8_t)(k + 1u);
        *at = (uint8_t)(take ? *at | mask : *at & ~mask);
        (void)slot(bus, take);
    }
    *branch = next;
    t->state = TRANSFER_DONE;
    return ERR_OK;
}

void hal_onewire_stop(uint8_t bus)
{
    (void)bus;
}

/* ---- inputs of the chip ---- */

bool hal_analog_has(hal_pin pin)
{
    bool converts = pin < HAL_PIN('A', 8) || pin == HAL_PIN('B', 0) || pin == HAL_PIN('B', 1) ||
                    (pin >= HAL_PIN('C', 0) && pin < HAL_PIN('C', 6));
    return converts && hal_pin_is_free(pin);
}

enum err hal_analog_open(hal_pin pin)
{
    if (!hal_analog_has(pin))
        return ERR_RANGE;
    if (!pins[pin].converts) {
        pins[pin].converted = 0;
        n_converting++;
    }
    pins[pin].converts = true;
    return ERR_OK;
}

/* 16 conversions of 12 bits, as the chip has. */
bool hal_analog_read(hal_pin pin, uint16_t *code)
{
    unsigned sum = 0;
    for (unsigned i = 0; i < MEAN; i++)
        sum += pins[pin].code[i];
    *code = (uint16_t)(sum + (sum >> 12));
    return pins[pin].converts && pins[pin].converted == MEAN;
}

float hal_analog_reference(void)
{
    return (float)SUPPLY_MV / 1000.0f;
}

enum err hal_pulse_open(hal_pin pin)
{
    if (!hal_pin_is_free(pin))
        return ERR_RANGE;
    hal_pin_use(pin, HAL_PIN_INPUT_PULLED);
    catch_up();
    pins[pin].counts = true;
    pins[pin].high = is_high(pin, now_ns());
    pins[pin].pulses = 0;
    pins[pin].edge_ns = 0;
    pins[pin].dead_ms = 0;
    return ERR_OK;
}

uint32_t hal_pulse_count(hal_pin pin)
{
    catch_up();
    return pins[pin].pulses;
}

void hal_pulse_set_dead_time(hal_pin pin, uint8_t dead_ms)
{
    pins[pin].dead_ms = dead_ms;
}

/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "outputs_bench.h"

#include "hal/pulse.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

struct bench_pin bench_pins[256];
uint32_t bench_now;
unsigned bench_safe;
static uint32_t last_seed;

bool hal_pin_is_free(hal_pin pin)
{
    return !bench_pins[pin].taken;
}

void hal_pin_use(hal_pin pin, enum hal_pin_use use)
{
    TEST_ASSERT_FALSE_MESSAGE(bench_pins[pin].taken, "a pin that is not free is used");
    bench_pins[pin].use = use;
    bench_pins[pin].high = false;
    bench_pins[pin].pwm = false;
    bench_pins[pin].part = 0;
}

bool hal_pin_read(hal_pin pin)
{
    TEST_ASSERT_EQUAL_MESSAGE(HAL_PIN_INPUT_PULLED, bench_pins[pin].use, "no contact to read");
    return !bench_pins[pin].contact;
}

enum err hal_output_open(hal_pin pin, bool low)
{
    struct bench_pin *p = &bench_pins[pin];
    if (p->taken || p->refuses)
        return ERR_RANGE;
    p->use = HAL_PIN_OUTPUT;
    p->low = low;
    p->high = low;
    return ERR_OK;
}

void hal_output_set(hal_pin pin, bool on)
{
    struct bench_pin *p = &bench_pins[pin];
    TEST_ASSERT_EQUAL_MESSAGE(HAL_PIN_OUTPUT, p->use, "an output that is not open is set");
    p->rises += on && p->high == p->low;
    p->high = on != p->low;
}

bool hal_pwm_find(hal_pin pin, uint32_t hz, struct hal_pwm_place *place)
{
    const struct bench_pin *p = &bench_pins[pin];
    *place = (struct hal_pwm_place){p->timer != 0 ? p->timer : pin, p->channel};
    return !p->no_timer && hz != 0;
}

enum err hal_pwm_open(hal_pin pin, uint32_t hz, bool low)
{
    struct bench_pin *p = &bench_pins[pin];
    if (p->taken || p->refuses)
        return ERR_RANGE;
    p->use = HAL_PIN_OUTPUT;
    p->pwm = true;
    p->hz = hz;
    p->low = low;
    p->part = 0;
    return ERR_OK;
}

void hal_pwm_set(hal_pin pin, uint16_t part)
{
    TEST_ASSERT_TRUE_MESSAGE(bench_pins[pin].pwm, "a pulse width that is not open is set");
    bench_pins[pin].part = part;
    bench_pins[pin].pwm_set++;
}

void hal_output_safe(void)
{
    bench_safe++;
    for (unsigned k = 0; k < 256; k++)
        if (bench_pins[k].use == HAL_PIN_OUTPUT) {
            bench_pins[k].high = bench_pins[k].low;
            bench_pins[k].part = 0;
        }
}

uint32_t bench_edges[256];
enum transfer_state (*bench_spi)(const struct spi_device *device, struct transfer *t);
unsigned bench_spi_stops;
bool bench_spi_busy;

enum err hal_pulse_open(hal_pin pin)
{
    struct bench_pin *p = &bench_pins[pin];
    if (p->taken || p->refuses)
        return ERR_RANGE;
    p->use = HAL_PIN_INPUT_PULLED;
    return ERR_OK;
}

uint32_t hal_pulse_count(hal_pin pin)
{
    return bench_edges[pin];
}

void hal_pulse_set_dead_time(hal_pin pin, uint8_t dead_ms)
{
    (void)pin;
    TEST_ASSERT_TRUE(dead_ms > 0 && dead_ms < 7); /* half a cycle at 65 Hz is 7.7 ms */
}

enum err hal_spi_open(const struct spi_device *device)
{
    bench_pins[device->select].use = HAL_PIN_OUTPUT;
    return device->bus == 1 ? ERR_OK : ERR_RANGE;
}

enum err hal_spi_start(const struct spi_device *device, struct transfer *t)
{
    if (bench_spi_busy)
        return ERR_STATE;
    t->state = TRANSFER_DONE;
    if (bench_spi)
        t->state = (uint8_t)bench_spi(device, t);
    else
        memset(t->in, 0xFF, t->n_in);
    return ERR_OK;
}

void hal_spi_stop(uint8_t bus)
{
    TEST_ASSERT_EQUAL(1, bus);
    bench_spi_stops++;
}

void bench_begin(void)
{
    uint8_t failed;
    for (unsigned k = 0; k < 256; k++)
        bench_pins[k].taken = bench_pins[k].refuses = false;
    outputs_resume();
    TEST_ASSERT_EQUAL(ERR_OK, outputs_open(NULL, 0, &failed));
    for (unsigned k = 0; k < 256; k++)
        bench_pins[k] = (struct bench_pin){.use = HAL_PIN_CLOSED};
    bench_now = 0u - BENCH_WRAP_MS;
    bench_safe = bench_spi_stops = 0;
    bench_spi = NULL;
    bench_spi_busy = false;
}

struct output_settings bench_settings(enum output_type type, uint8_t index)
{
    struct output_settings s;
    output_settings_init(&s);
    s.type = (uint8_t)type;
    for (unsigned k = 0; k < OUTPUT_PINS; k++)
        if (output_uses(s.type, k) && k != OUTPUT_CROSSING)
            s.pin[k] = (hal_pin)(16u * (index % 15u) + 4u * (index / 15u) + k);
    if (type == OUTPUT_ENABLE)
        s.least_off = 5.0f;
    s.bus = 1;
    return s;
}

void bench_open(const struct output_settings *settings, uint8_t n)
{
    struct output_problem problem;
    uint8_t failed;
    for (uint8_t k = 0; k < n; k++) {
        bool right = output_check(settings, n, k, &problem);
        TEST_ASSERT_TRUE_MESSAGE(right, problem.words);
    }
    TEST_ASSERT_EQUAL(ERR_OK, outputs_open(settings, n, &failed));
    bench_turn();
}

void bench_turn(void)
{
    bench_turn_after(1);
}

void bench_turn_after(uint32_t ms)
{
    bench_now += ms;
    outputs_clock(bench_now);
}

bool bench_on(hal_pin pin)
{
    return bench_pins[pin].use == HAL_PIN_OUTPUT && bench_pins[pin].high != bench_pins[pin].low;
}

int64_t bench_whole(double fraction)
{
    return (int64_t)(fraction * 65536.0 + 0.5);
}

struct random_source bench_random(uint32_t seed)
{
    last_seed = seed;
    return (struct random_source){seed};
}

void bench_tell_seed(void)
{
    if (Unity.CurrentTestFailed && last_seed)
        printf("\nThe seed was %u.\n", (unsigned)last_seed);
    last_seed = 0;
}

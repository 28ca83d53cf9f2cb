/* Pulse widths, counts of pulses, and analogue inputs.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "board_io.h"

/* ---- pulse widths ---- */

static enum err open_pwm(struct bench *bench, unsigned pin, uint32_t hz, uint32_t low)
{
    volatile struct mailbox *box = bench_prepare(bench, IO_PWM_OPEN);
    box->pin = pin;
    box->hz = hz;
    box->mode = low;
    bench_ask(bench);
    return bench_wait(bench);
}

static void expect_part(struct bench *bench, unsigned pin, uint32_t hz, uint32_t part, bool low)
{
    (void)bench_do(bench, IO_PWM_SET, pin, 0, part);
    double wanted = part / 65535.0, high = low ? 1 - wanted : wanted;
    CHECK(fabs(plant.hz[pin] / hz - 1) < 0.002, "pin %u: %g Hz instead of %u", pin, plant.hz[pin],
          hz);
    CHECK(fabs(plant.high[pin] - high) < 0.0013, "pin %u: high for %g instead of %g", pin,
          plant.high[pin], high);
    if (part == 0 || part == 65535u) /* off is off, and on is on */
        CHECK(plant.high[pin] == high, "pin %u: high for %.9f", pin, plant.high[pin]);
}

void case_pwm(const char *image)
{
    static const uint8_t pins[] = {HAL_PIN('A', 0), HAL_PIN('A', 1),  HAL_PIN('A', 6),
                                   HAL_PIN('A', 7), HAL_PIN('B', 0),  HAL_PIN('B', 1),
                                   HAL_PIN('B', 6), HAL_PIN('B', 7),  HAL_PIN('B', 8),
                                   HAL_PIN('B', 9), HAL_PIN('B', 14), HAL_PIN('B', 15)};
    static const uint32_t rates[] = {1, 50, 1000, 20000, 100000},
                          parts[] = {0, 1, 655, 32768, 65000, 65535};
    struct bench bench;
    bench_start(&bench, image, 1);
    CHECK(open_pwm(&bench, HAL_PIN('A', 4), 1000, 0) == ERR_RANGE, "no timer at PA4");
    CHECK(open_pwm(&bench, HAL_PIN('B', 0), 0, 0) == ERR_RANGE, "0 Hz");
    CHECK(open_pwm(&bench, HAL_PIN('B', 0), 100001, 0) == ERR_RANGE, "100,001 Hz");
    for (unsigned r = 0; r < sizeof(rates) / sizeof(rates[0]); r++) {
        for (unsigned i = 0; i < sizeof(pins); i++) {
            bool low = i % 2u != 0;
            CHECK(open_pwm(&bench, pins[i], rates[r], low) == ERR_OK, "pin %u not opened", pins[i]);
            CHECK(plant.high[pins[i]] == (low ? 1 : 0), "pin %u is on when it is opened", pins[i]);
            for (unsigned k = 0; k < sizeof(parts) / sizeof(parts[0]); k++)
                expect_part(&bench, pins[i], rates[r], parts[k], low);
        }
        for (unsigned i = 0; r == 0 && i < sizeof(pins); i++)
            CHECK(open_pwm(&bench, pins[i], 2, 0) == ERR_FULL, "two frequencies on one timer");
        CHECK(open_pwm(&bench, HAL_PIN('C', 6), rates[r], 0) == ERR_FULL, "two pins, one channel");
        uint64_t before = bench.board->instructions;
        (void)bench_do(&bench, IO_PIN_FREE, 0, 0, 0);
        uint64_t request = bench.board->instructions - before;
        (void)bench_do(&bench, IO_OUTPUT_SAFE, 0, 0, 0);
        if (r == 0)
            printf("all off: %lld instructions, with 12 pulse widths\n",
                   (long long)(bench.board->instructions - before - 2u * request));
        for (unsigned i = 0; i < sizeof(pins); i++) {
            CHECK(plant.high[pins[i]] == (i % 2u != 0 ? 1 : 0), "pin %u is not off", pins[i]);
            (void)bench_do(&bench, IO_PIN_USE, pins[i], HAL_PIN_CLOSED, 0);
            CHECK(plant.hz[pins[i]] == 0, "pin %u still has pulses", pins[i]);
        }
    }
    CHECK(open_pwm(&bench, HAL_PIN('C', 6), 500, 0) == ERR_OK, "its channel is free");
    (void)bench_do(&bench, IO_PWM_SET, HAL_PIN('C', 6), 0, 40000);
    (void)bench_do(&bench, IO_PWM_SET, HAL_PIN('A', 6), 0, 100); /* no longer open */
    CHECK(fabs(plant.high[HAL_PIN('C', 6)] - 40000.0 / 65535.0) < 0.001, "another pin's value");
    bench_reset(&bench);
    CHECK(plant.hz[HAL_PIN('C', 6)] == 0, "pulses after a reset");
    bench_stop(&bench);
}

/* ---- pulses ---- */

static uint32_t count_of(struct bench *bench, unsigned pin)
{
    CHECK(bench_do(bench, IO_PULSE_COUNT, pin, 0, 0) == ERR_OK, "no answer");
    return bench->box->result;
}

/* A pulse: low for some time, then high for some. */
static void pulse(struct bench *bench, unsigned pin, uint64_t low_ns, uint64_t high_ns)
{
    board_set_pin(bench->board, pin, PIN_LEVEL_LOW);
    bench_run(bench, low_ns);
    board_set_pin(bench->board, pin, PIN_LEVEL_HIGH);
    bench_run(bench, high_ns);
}

static void count_on(struct bench *bench, unsigned pin)
{
    board_set_pin(bench->board, pin, PIN_LEVEL_HIGH);
    CHECK(bench_do(bench, IO_PULSE_OPEN, pin, 0, 0) == ERR_OK, "pin %u not opened", pin);
    CHECK(count_of(bench, pin) == 0, "pin %u: pulses at first", pin);
    for (unsigned i = 0; i < 100; i++) /* 2 kHz */
        pulse(bench, pin, 250000, 250000);
    CHECK(count_of(bench, pin) == 100, "pin %u: %u pulses instead of 100", pin,
          count_of(bench, pin));
    (void)bench_do(bench, IO_PULSE_DEAD, pin, 0, 5);
    bench_run(bench, 6u * MS);
    for (unsigned i = 0; i < 10;
         i++) { /* each bounces: an edge every 4.4 ms, later none for 5.1 ms */
        for (unsigned k = 0; k < 4; k++)
            pulse(bench, pin, 4200000, 200000);
        bench_run(bench, 900000);
    }
    CHECK(count_of(bench, pin) == 110, "pin %u: %u pulses instead of 110", pin,
          count_of(bench, pin));
    (void)bench_do(bench, IO_PULSE_OPEN, pin, 0, 0);
    CHECK(count_of(bench, pin) == 0, "pin %u: pulses after it was opened again", pin);
}

void case_pulses(const char *image)
{
    struct bench bench;
    bench_start(&bench, image, 1);
    CHECK(bench_do(&bench, IO_PULSE_OPEN, HAL_PIN('A', 13), 0, 0) == ERR_RANGE, "the debugger's");
    for (unsigned line = 0; line < 16; line++)
        for (unsigned port = 0; port < 4; port++) {
            (void)bench_do(&bench, IO_PIN_FREE, 16u * port + line, 0, 0);
            if (bench.box->result == 0)
                continue;
            count_on(&bench, 16u * port + line);
            for (unsigned other = port + 1u; other < 4; other++) {
                (void)bench_do(&bench, IO_PIN_FREE, 16u * other + line, 0, 0);
                CHECK(bench.box->result == 0 ||
                          bench_do(&bench, IO_PULSE_OPEN, 16u * other + line, 0, 0) == ERR_FULL,
                      "two pins on line %u", line);
            }
            port = 4;
        }
    /* two pins of one interrupt at the same time, and what an edge costs */
    bench_reset(&bench);
    static const unsigned one = HAL_PIN('C', 8), two = HAL_PIN('B', 9);
    board_set_pin(bench.board, one, PIN_LEVEL_HIGH);
    board_set_pin(bench.board, two, PIN_LEVEL_HIGH);
    CHECK(bench_do(&bench, IO_PULSE_OPEN, one, 0, 0) == ERR_OK, "not opened");
    CHECK(bench_do(&bench, IO_PULSE_OPEN, two, 0, 0) == ERR_OK, "not opened");
    uint64_t before = bench.board->instructions;
    bench_run(&bench, 100u * MS);
    uint64_t idle = bench.board->instructions - before;
    for (unsigned i = 0; i < 100; i++) {
        pulse(&bench, one, 100000, 150000);
        pulse(&bench, two, 100000, 150000);
        board_set_pin(bench.board, two, PIN_LEVEL_LOW);
        pulse(&bench, one, 100000, 150000);
        board_set_pin(bench.board, two, PIN_LEVEL_HIGH);
        bench_run(&bench, 250000);
    }
    uint64_t spent = bench.board->instructions - before - idle;
    CHECK(count_of(&bench, one) == 200 && count_of(&bench, two) == 200, "%u and %u pulses",
          count_of(&bench, one), count_of(&bench, two));
    printf("pulses: %.0f instructions each\n", ((double)spent - (double)idle) / 400.0);
    /* a wire that picks up 500 kHz: at most eight edges a millisecond are served, and later all count again */
    uint32_t counted = count_of(&bench, one);
    before = bench.board->instructions;
    for (unsigned i = 0; i < 50000; i++)
        pulse(&bench, one, 1000, 1000);
    spent = bench.board->instructions - before;
    printf("noise of 500 kHz at an input: %llu instructions a millisecond\n",
           (unsigned long long)spent / 100u);
    uint32_t noise = count_of(&bench, one) - counted;
    CHECK(noise >= 700u && noise <= 900u, "%u edges of noise in 0.1 s", noise);
    bench_run(&bench, 2u * MS);
    counted = count_of(&bench, one);
    for (unsigned i = 0; i < 20; i++)
        pulse(&bench, one, 250000, 250000);
    CHECK(count_of(&bench, one) == counted + 20u, "pulses behind noise do not count");
    bench_stop(&bench);
}

/* ---- analogue inputs ---- */

static uint32_t code_of(struct bench *bench, unsigned pin)
{
    CHECK(bench_do(bench, IO_ANALOG_READ, pin, 0, 0) == ERR_OK, "pin %u has no code", pin);
    return bench->box->result;
}

static void expect_code(struct bench *bench, unsigned pin, double part)
{
    double code = code_of(bench, pin);
    CHECK(fabs(code - part * 65535) <= 16, "pin %u: %g instead of %g", pin, code, part * 65535);
}

void case_analog(const char *image)
{
    struct bench bench;
    unsigned n = 0, last = 0;
    bench_start(&bench, image, 1);
    (void)bench_do(&bench, IO_ANALOG_REFERENCE, 0, 0, 0);
    CHECK(bench.box->result == 0, "a reference before anything is converted");
    CHECK(bench_do(&bench, IO_ANALOG_OPEN, HAL_PIN('B', 6), 0, 0) == ERR_RANGE, "PB6 has none");
    CHECK(bench_do(&bench, IO_ANALOG_OPEN, HAL_PIN('A', 2), 0, 0) == ERR_RANGE, "the link's");
    for (unsigned pin = 0; pin < WORLD_PINS; pin++) {
        (void)bench_do(&bench, IO_ANALOG_HAS, pin, 0, 0);
        if (bench.box->result == 0)
            continue;
        plant.volts[pin] = 0.1 + 0.25 * n;
        enum err err = bench_do(&bench, IO_ANALOG_OPEN, pin, 0, 0);
        CHECK(err == (n < 8u ? ERR_OK : ERR_FULL), "input %u: %d", n, (int)err);
        if (n == 0) {
            CHECK(bench_do(&bench, IO_ANALOG_READ, pin, 0, 0) == ERR_EMPTY, "a code at once");
            bench_run(&bench, 8u * MS);
            CHECK(bench_do(&bench, IO_ANALOG_READ, pin, 0, 0) == ERR_EMPTY,
                  "a code of fewer than 16 conversions");
            bench_run(&bench, 20u * MS);
        }
        last = n < 8u ? pin : last;
        n++;
    }
    printf("%u pins have an analogue input\n", n);
    bench_run(&bench, 20u * MS);
    n = 0;
    for (unsigned pin = 0; pin <= last; pin++)
        if (plant.volts[pin] > 0 && n < 8u) {
            expect_code(&bench, pin, (0.1 + 0.25 * n) / 3.3);
            n++;
        }
    CHECK(n == 8, "%u inputs", n);
    /* both ends, and a step that is all there after 16 conversions, and half of it after 8 */
    plant.volts[last] = 0;
    bench_run(&bench, 20u * MS);
    CHECK(code_of(&bench, last) == 0, "not 0");
    plant.volts[last] = 3.3;
    bench_run(&bench, 7u * MS);
    double half = code_of(&bench, last);
    CHECK(half > 65535.0 * 6 / 16 && half < 65535.0 * 10 / 16, "%g after 8 conversions", half);
    bench_run(&bench, 17u * MS);
    CHECK(code_of(&bench, last) == 65535, "not full");
    /* interrupts held off for longer than a conversion takes */
    volatile struct mailbox *box = bench_prepare(&bench, IO_WIRE_OPEN);
    box->bus = 1;
    bench_ask(&bench);
    CHECK(bench_wait(&bench) == ERR_OK, "no wire");
    bench.hold_ms = 3;
    bench_prepare(&bench, IO_WIRE)->bus = 1;
    bench_ask(&bench);
    (void)bench_wait(&bench);
    plant.volts[last] = 1.1;
    bench_run(&bench, 30u * MS);
    expect_code(&bench, last, 1.1 / 3.3);
    /* the supply falls, and the reference tells */
    for (uint32_t mv = 3300; mv >= 2900; mv -= 200) {
        bench.board->around.supply_mv = mv;
        bench_run(&bench, 20u * MS);
        (void)bench_do(&bench, IO_ANALOG_REFERENCE, 0, 0, 0);
        CHECK(abs((int)bench.box->result - (int)mv) <= 3, "%u mV instead of %u", bench.box->result,
              mv);
    }
    bench.board->around.supply_mv = 3300;
    uint64_t before = bench.board->instructions;
    bench_run(&bench, 100u * MS);
    printf("analogue inputs: %.0f instructions a millisecond for eight and the reference\n",
           (double)(bench.board->instructions - before) / 100.0);
    bench_stop(&bench);
}

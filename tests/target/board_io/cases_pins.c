/* Pins and outputs.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdio.h>

#include "board_io.h"
#include "hal/output.h"

static const uint8_t refused[] = {
    HAL_PIN('A', 13), HAL_PIN('A', 14), HAL_PIN('A', 15), HAL_PIN('B', 3),  HAL_PIN('B', 4),
    HAL_PIN('A', 9),  HAL_PIN('A', 10), HAL_PIN('A', 2),  HAL_PIN('A', 3),  HAL_PIN('B', 2),
    HAL_PIN('C', 13), HAL_PIN('C', 14), HAL_PIN('C', 15), HAL_PIN('B', 10), HAL_PIN('B', 11),
    HAL_PIN('C', 10), HAL_PIN('C', 11), HAL_PIN('A', 11), HAL_PIN('A', 12), HAL_PIN('B', 5),
    HAL_PIN('B', 13), HAL_PIN('D', 0),  HAL_PIN('D', 3),  HAL_PIN('H', 0),  HAL_PIN('H', 1),
    HAL_PIN_NONE};

static bool is_free(struct bench *bench, unsigned pin)
{
    CHECK(bench_do(bench, IO_PIN_FREE, pin, 0, 0) == ERR_OK, "no answer");
    return bench->box->result != 0;
}

static bool reads(struct bench *bench, unsigned pin)
{
    CHECK(bench_do(bench, IO_PIN_READ, pin, 0, 0) == ERR_OK, "no answer");
    return bench->box->result != 0;
}

/* Which pins are free, and that the others stay as they are whatever is asked. Inputs read what is wired. */
void case_pins(const char *image)
{
    struct bench bench;
    unsigned n = 0;
    bench_start(&bench, image, 1);
    for (unsigned pin = 0; pin < 256u; pin++)
        n += is_free(&bench, pin) ? 1u : 0;
    for (unsigned i = 0; i < sizeof(refused); i++) {
        unsigned pin = refused[i];
        CHECK(!is_free(&bench, pin), "pin %u is free", pin);
        if (pin >= WORLD_PINS)
            continue;
        uint32_t moves = plant.moves[pin];
        (void)bench_do(&bench, IO_PIN_USE, pin, HAL_PIN_OUTPUT, 0);
        CHECK(bench_do(&bench, IO_OUTPUT_OPEN, pin, 0, 0) == ERR_RANGE, "pin %u is opened", pin);
        CHECK(plant.moves[pin] == moves, "pin %u has moved", pin);
    }
    printf("%u pins are free\n", n);
    for (unsigned pin = 0; pin < WORLD_PINS; pin++) {
        if (!is_free(&bench, pin))
            continue;
        (void)bench_do(&bench, IO_PIN_USE, pin, HAL_PIN_INPUT_PULLED, 0);
        CHECK(reads(&bench, pin), "pin %u is not pulled up", pin);
        board_set_pin(bench.board, pin, PIN_LEVEL_LOW);
        CHECK(!reads(&bench, pin), "pin %u does not read low", pin);
        board_set_pin(bench.board, pin, PIN_LEVEL_OPEN);
        (void)bench_do(&bench, IO_PIN_USE, pin, HAL_PIN_INPUT, 0);
        board_set_pin(bench.board, pin, PIN_LEVEL_HIGH);
        CHECK(reads(&bench, pin), "pin %u does not read high", pin);
        board_set_pin(bench.board, pin, PIN_LEVEL_OPEN);
        (void)bench_do(&bench, IO_PIN_USE, pin, HAL_PIN_OUTPUT, 0);
        CHECK(plant.pins[pin] == PIN_LOW, "output %u is not low", pin);
        (void)bench_do(&bench, IO_PIN_WRITE, pin, 0, 1);
        CHECK(plant.pins[pin] == PIN_HIGH && reads(&bench, pin), "output %u is not high", pin);
        (void)bench_do(&bench, IO_PIN_USE, pin, HAL_PIN_CLOSED, 0);
        CHECK(plant.pins[pin] == PIN_FLOATS, "pin %u is not closed", pin);
    }
    bench_stop(&bench);
}

/* An output that is off at low, and one that is off at high. Neither is ever on but when it is set. */
void case_outputs(const char *image)
{
    static const unsigned plain = HAL_PIN('C', 0), inverted = HAL_PIN('B', 0);
    struct bench bench;
    bench_start(&bench, image, 1);
    CHECK(plant.pins[plain] == PIN_FLOATS && plant.moves[plain] == 0, "it drives after a reset");
    (void)bench_do(&bench, IO_OUTPUT_SET, plain, 0, 1); /* it is not open yet */
    CHECK(bench_do(&bench, IO_OUTPUT_OPEN, plain, 0, 0) == ERR_OK, "not opened");
    CHECK(bench_do(&bench, IO_OUTPUT_OPEN, inverted, 1, 0) == ERR_OK, "not opened");
    CHECK(plant.pins[plain] == PIN_LOW && plant.moves[plain] == 1, "on when it is opened");
    CHECK(plant.pins[inverted] == PIN_HIGH && plant.moves[inverted] == 1, "on when it is opened");
    for (unsigned round = 0; round < 2; round++) {
        (void)bench_do(&bench, IO_OUTPUT_SET, plain, 0, 1);
        (void)bench_do(&bench, IO_OUTPUT_SET, inverted, 0, 1);
        CHECK(plant.pins[plain] == PIN_HIGH && plant.pins[inverted] == PIN_LOW, "not on");
        if (round == 0) {
            (void)bench_do(&bench, IO_OUTPUT_SET, plain, 0, 0);
            (void)bench_do(&bench, IO_OUTPUT_SET, inverted, 0, 0);
        } else {
            (void)bench_do(&bench, IO_OUTPUT_SAFE, 0, 0, 0);
        }
        CHECK(plant.pins[plain] == PIN_LOW && plant.pins[inverted] == PIN_HIGH, "not off");
    }
    (void)bench_do(&bench, IO_OUTPUT_SET, inverted, 0, 1);
    uint32_t moves = plant.moves[inverted];
    (void)bench_do(&bench, IO_PIN_USE, inverted, HAL_PIN_CLOSED, 0); /* off first, then open */
    CHECK(plant.moves[inverted] == moves + 2u && plant.pins[inverted] == PIN_FLOATS,
          "it did not go off before it was closed");
    (void)bench_do(&bench, IO_OUTPUT_SET, plain, 0, 1);
    bench_reset(&bench);
    CHECK(plant.pins[plain] == PIN_FLOATS, "it drives after a reset");
    bench_stop(&bench);
}

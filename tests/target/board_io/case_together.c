/* All at once, as a column has it: a transfer on a bus of each kind, analogue inputs, and pulses at 2 kHz.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdio.h>
#include <stdlib.h>

#include "board_io.h"

#define ROUNDS   400u
#define COUNTED  HAL_PIN('C', 8)
#define MEASURED HAL_PIN('C', 1)

static void open_bus(struct bench *bench, enum io_command command, unsigned bus)
{
    volatile struct mailbox *box = bench_prepare(bench, command);
    box->bus = bus;
    box->pin = plant.spi[bus - 1u].pin;
    box->mode = 1;
    box->hz = 1000000;
    bench_ask(bench);
    CHECK(bench_wait(bench) == ERR_OK, "request of kind %u: not opened", (unsigned)command);
}

static void ask_together(struct bench *bench, unsigned bus, unsigned n_out, unsigned n_in)
{
    volatile struct mailbox *box = bench_prepare(bench, IO_TOGETHER);
    box->bus = bus;
    box->pin = plant.spi[bus - 1u].pin;
    box->mode = 3;
    box->hz = 400000u << bench_random(bench, 5);
    box->value = PLANT_ADDRESS;
    box->n_out = n_out;
    box->n_in = n_in;
    box->limit_ms = 40;
    for (unsigned i = 0; i < 3u * IO_THIRD; i++)
        box->out[i] = (uint8_t)bench_random(bench, i == IO_THIRD ? 128 : 256);
    box->out[2u * IO_THIRD] = 0xCC; /* all chips of the wire */
    box->out[2u * IO_THIRD + 1u] = (uint8_t)n_out;
    bench_ask(bench);
}

/* Pulses go on until the transfers have ended; returns how many there were. */
static uint32_t pulse_until_done(struct bench *bench)
{
    uint32_t pulses = 0;
    while (bench->box->done != bench->asked) {
        board_set_pin(bench->board, COUNTED, PIN_LEVEL_LOW);
        bench_run(bench, 250000u - bench_random(bench, 3000));
        board_set_pin(bench->board, COUNTED, PIN_LEVEL_HIGH);
        bench_run(bench, 250000u - bench_random(bench, 3000));
        pulses++;
        CHECK(pulses < 1000u, "transfers hang");
    }
    return pulses;
}

static void check_bytes(const struct bench *bench, unsigned bus, uint8_t at)
{
    volatile struct mailbox *box = bench->box;
    const struct plant_i2c *c = &plant.i2c[bus - 1u];
    uint32_t sums[3] = {0, 0, 0};
    for (unsigned k = 0; k < box->n_out; k++) {
        CHECK(plant.spi[bus - 1u].bytes[k] == box->out[k], "SPI: byte %u out", k);
        CHECK(plant.wires[bus - 1u].chips[0].bytes[k] == box->out[2u * IO_THIRD + 2u + k],
              "1-wire: byte %u out", k);
        sums[0] += box->out[k];
        sums[2] += box->out[2u * IO_THIRD + 2u + k];
        if (k == 0)
            at = box->out[IO_THIRD];
        else
            CHECK(c->registers[at++] == box->out[IO_THIRD + k], "I2C: byte %u out", k);
    }
    for (unsigned k = 0; k < box->n_in; k++) {
        CHECK(box->in[k] == plant_answer(sums[0], box->n_out + k), "SPI: byte %u in", k);
        CHECK(box->in[IO_THIRD + k] == c->registers[at++], "I2C: byte %u in", k);
        CHECK(box->in[2u * IO_THIRD + k] == plant_answer(sums[2], k), "1-wire: byte %u in", k);
    }
}

void case_together(const char *image)
{
    struct bench bench;
    uint32_t pulses = 0;
    bench_start(&bench, image, 1);
    plant.volts[MEASURED] = 1.65;
    for (unsigned bus = 1; bus <= 2; bus++) {
        open_bus(&bench, IO_SPI_OPEN, bus);
        open_bus(&bench, IO_I2C_OPEN, bus);
        open_bus(&bench, IO_WIRE_OPEN, bus);
        plant.wires[bus - 1u].n = 1;
    }
    static const uint8_t inputs[] = {HAL_PIN('A', 1), HAL_PIN('B', 0), HAL_PIN('B', 1),
                                     HAL_PIN('C', 0), HAL_PIN('C', 1)};
    for (unsigned i = 0; i < sizeof(inputs); i++)
        CHECK(bench_do(&bench, IO_ANALOG_OPEN, inputs[i], 0, 0) == ERR_OK, "not opened");
    board_set_pin(bench.board, COUNTED, PIN_LEVEL_HIGH);
    CHECK(bench_do(&bench, IO_PULSE_OPEN, COUNTED, 0, 0) == ERR_OK, "not opened");
    for (unsigned i = 0; i < ROUNDS; i++) {
        unsigned bus = 1u + i % 2u;
        uint8_t at = plant.i2c[bus - 1u].at;
        ask_together(&bench, bus, bench_random(&bench, 6), 1u + bench_random(&bench, 7));
        pulses += pulse_until_done(&bench);
        CHECK(bench.box->err == ERR_OK && bench.box->state == TRANSFER_DONE * 0x010101u,
              "round %u: states %06x", i, bench.box->state);
        check_bytes(&bench, bus, at);
    }
    CHECK(bench_do(&bench, IO_PULSE_COUNT, COUNTED, 0, 0) == ERR_OK && bench.box->result == pulses,
          "%u pulses instead of %u", bench.box->result, pulses);
    CHECK(bench_do(&bench, IO_ANALOG_READ, MEASURED, 0, 0) == ERR_OK &&
              abs((int)bench.box->result - 32768) < 16,
          "%u at an analogue input", bench.box->result);
    printf("at once: %u transfers on each kind of bus, %u pulses\n", ROUNDS, pulses);
    bench_stop(&bench);
}

/* SPI: bytes both ways, clocks, errors, and many transfers with bit errors and resets.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdio.h>

#include "board_io.h"

static volatile struct mailbox *prepare_spi(struct bench *bench, enum io_command command,
                                            unsigned bus, unsigned mode, uint32_t hz)
{
    volatile struct mailbox *box = bench_prepare(bench, command);
    box->bus = bus;
    box->pin = bus >= 1u && bus <= PLANT_CHIPS ? plant.spi[bus - 1u].pin : 0;
    box->mode = mode;
    box->hz = hz;
    return box;
}

static enum err open_spi(struct bench *bench, unsigned bus, unsigned mode, uint32_t hz)
{
    (void)prepare_spi(bench, IO_SPI_OPEN, bus, mode, hz);
    bench_ask(bench);
    return bench_wait(bench);
}

static void ask_spi(struct bench *bench, unsigned bus, unsigned mode, uint32_t hz, unsigned n_out,
                    unsigned n_in, uint32_t limit_ms)
{
    volatile struct mailbox *box = prepare_spi(bench, IO_SPI, bus, mode, hz);
    box->n_out = n_out;
    box->n_in = n_in;
    box->limit_ms = limit_ms;
    for (unsigned i = 0; i < n_out; i++)
        box->out[i] = (uint8_t)bench_random(bench, 256);
    bench_ask(bench);
}

/* Whether the answer is what the chip gives for what it was sent; the chip has heard it in any case. */
static bool spi_bytes_are_right(const struct bench *bench, unsigned bus)
{
    const struct plant_spi *c = &plant.spi[bus - 1u];
    volatile struct mailbox *box = bench->box;
    uint32_t sum = 0;
    bool same = true;
    CHECK(c->heard == box->n_out + box->n_in, "%u bytes instead of %u", c->heard,
          box->n_out + box->n_in);
    for (unsigned k = 0; k < c->heard; k++) {
        uint8_t sent = k < box->n_out ? box->out[k] : 0;
        CHECK(c->bytes[k] == sent, "byte %u: %02x instead of %02x", k, c->bytes[k], sent);
        if (k >= box->n_out && box->in[k - box->n_out] != plant_answer(sum, k))
            same = false;
        sum += sent;
    }
    for (unsigned k = box->n_in; k < sizeof(box->in); k++)
        CHECK(box->in[k] == 0xEE, "a byte behind the answer was written");
    return same;
}

static uint64_t spi_instructions(struct bench *bench, unsigned n)
{
    ask_spi(bench, 1, 1, 3000000, 1, n, 0);
    uint64_t before = bench->board->instructions;
    CHECK(bench_wait(bench) == ERR_OK, "not sent");
    CHECK(bench->box->took_ms == 1, "took %u ms", bench->box->took_ms);
    return bench->board->instructions - before;
}

void case_spi(const char *image)
{
    static const uint32_t clocks[] = {400000, 1000000, 5000000, 10000000};
    struct bench bench;
    bench_start(&bench, image, 1);
    ask_spi(&bench, 1, 1, 1000000, 1, 1, 0);
    CHECK(bench_wait(&bench) == ERR_STATE, "a bus that is not open was used");
    CHECK(open_spi(&bench, 0, 1, 1000000) == ERR_RANGE, "bus 0");
    CHECK(open_spi(&bench, 4, 1, 1000000) == ERR_RANGE, "bus 4");
    CHECK(open_spi(&bench, 1, 1, 1000) == ERR_RANGE, "a clock that is too slow");
    for (unsigned bus = 1; bus <= PLANT_CHIPS; bus++) {
        CHECK(open_spi(&bench, bus, 1, 1000000) == ERR_OK, "not opened");
        CHECK(plant.pins[plant.spi[bus - 1u].pin] == PIN_HIGH, "select is not high");
        for (unsigned mode = 0; mode < 4; mode++)
            for (unsigned c = 0; c < sizeof(clocks) / sizeof(clocks[0]); c++)
                for (unsigned n = 1; n < 24; n += 3) {
                    const struct plant_spi *chip = &plant.spi[bus - 1u];
                    if ((chip->modes >> mode & 1u) == 0)
                        continue;
                    ask_spi(&bench, bus, mode, clocks[c], n / 2u, n - n / 2u, 0);
                    CHECK(bench_wait(&bench) == ERR_OK && bench.box->state == TRANSFER_DONE,
                          "state %u", bench.box->state);
                    CHECK(spi_bytes_are_right(&bench, bus), "SPI%u, mode %u: wrong bytes", bus,
                          mode);
                    CHECK(!chip->selected, "still selected");
                    uint64_t least = UINT64_C(8000000000) * n / clocks[c],
                             took = chip->released_ns - chip->selected_ns;
                    CHECK(took >= least, "%u bytes in %llu ns; %llu at the least", n,
                          (unsigned long long)took, (unsigned long long)least);
                }
    }
    /* a transfer of nothing, and the longest */
    ask_spi(&bench, 1, 1, 1000000, 0, 0, 0);
    CHECK(bench_wait(&bench) == ERR_OK && bench.box->state == TRANSFER_DONE, "nothing, not done");
    ask_spi(&bench, 1, 1, 1000000, 255, 255, 0);
    CHECK(bench_wait(&bench) == ERR_OK && spi_bytes_are_right(&bench, 1), "the longest, wrong");
    /* stopped on its way */
    ask_spi(&bench, 1, 1, 400000, 255, 255, 3);
    CHECK(bench_wait(&bench) == ERR_TIMEOUT && bench.box->state == TRANSFER_FAILED, "not stopped");
    CHECK(!plant.spi[0].selected && plant.spi[0].heard < 510u, "still selected");
    ask_spi(&bench, 1, 3, 400000, 3, 5, 0);
    CHECK(bench_wait(&bench) == ERR_OK && spi_bytes_are_right(&bench, 1), "wrong after a stop");
    bench.hold_ms = 3; /* interrupts held off in the middle */
    ask_spi(&bench, 1, 1, 400000, 100, 155, 0);
    CHECK(bench_wait(&bench) == ERR_OK && spi_bytes_are_right(&bench, 1), "wrong after a hold");
    uint64_t few = spi_instructions(&bench, 20), many = spi_instructions(&bench, 220);
    printf("SPI: %.1f instructions a byte\n", (double)(many - few) / 200.0);
    bench_stop(&bench);
}

void case_spi_campaign(const char *image, uint32_t count, uint64_t seed)
{
    struct bench bench;
    unsigned wrong = 0, resets = 0, stopped = 0;
    bench_start(&bench, image, seed);
    for (unsigned bus = 1; bus <= PLANT_CHIPS; bus++)
        CHECK(open_spi(&bench, bus, 1, 1000000) == ERR_OK, "not opened");
    plant.errors_per_million = 100;
    for (uint32_t i = 0; i < count; i++) {
        unsigned bus = 1u + bench_random(&bench, PLANT_CHIPS), n_out = bench_random(&bench, 8),
                 n_in = bench_random(&bench, 16);
        bool short_limit = bench_random(&bench, 50) == 0;
        uint32_t errors = plant.errors;
        if (short_limit)
            n_in = 200;
        ask_spi(&bench, bus, 1u + 2u * bench_random(&bench, 2), 400000u << bench_random(&bench, 4),
                n_out, n_in, short_limit ? 2u : 10u);
        if (bench_random(&bench, 200) == 0) {
            bench_run(&bench, bench_random(&bench, 1500000));
            bench_reset(&bench);
            resets++;
            CHECK(!plant.spi[bus - 1u].selected, "selected after a reset");
            for (unsigned k = 1; k <= PLANT_CHIPS; k++)
                CHECK(open_spi(&bench, k, 1, 1000000) == ERR_OK, "not opened");
            continue;
        }
        if (bench_wait(&bench) == ERR_TIMEOUT) {
            CHECK(short_limit, "transfer %u hung", i);
            stopped++;
            continue;
        }
        CHECK(bench.box->state == TRANSFER_DONE, "transfer %u: state %u", i, bench.box->state);
        bool right = n_out + n_in == 0 || spi_bytes_are_right(&bench, bus);
        CHECK(right || plant.errors != errors, "transfer %u is wrong without a bit error", i);
        wrong += right ? 0 : 1u;
    }
    printf("SPI: %u transfers, seed %llu: %u bit errors, %u wrong answers, %u stopped, %u resets, "
           "0 hung, %.1f s of the board\n",
           count, (unsigned long long)seed, plant.errors, wrong, stopped, resets,
           (double)board_ns(bench.board) / 1e9);
    bench_stop(&bench);
}

/* I2C: bytes both ways, chips that refuse, lines that are held, and many transfers with bit errors and resets.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdio.h>

#include "board_io.h"
#include "models/models.h"

static enum err open_i2c(struct bench *bench, unsigned bus)
{
    bench_prepare(bench, IO_I2C_OPEN)->bus = bus;
    bench_ask(bench);
    return bench_wait(bench);
}

static void ask_i2c(struct bench *bench, unsigned bus, unsigned address, unsigned n_out,
                    unsigned n_in, uint32_t limit_ms)
{
    volatile struct mailbox *box = bench_prepare(bench, IO_I2C);
    box->bus = bus;
    box->mode = address;
    box->n_out = n_out;
    box->n_in = n_in;
    box->limit_ms = limit_ms;
    for (unsigned i = 0; i < n_out; i++)
        box->out[i] = (uint8_t)bench_random(bench, i == 0 ? 128 : 256);
    bench_ask(bench);
}

static void expect_i2c(struct bench *bench, enum transfer_state state, const char *what)
{
    enum err err = bench_wait(bench);
    CHECK(err == ERR_OK && bench->box->state == state, "%s: %d, state %u", what, (int)err,
          bench->box->state);
}

/* What was written is in the chip, and what was read was there. at: the register of the transfer before, where nothing is written. */
static bool i2c_bytes_are_right(const struct bench *bench, unsigned bus, uint8_t at)
{
    const struct plant_i2c *c = &plant.i2c[bus - 1u];
    volatile struct mailbox *box = bench->box;
    bool same = true;
    if (box->n_out > 0)
        at = box->out[0];
    for (unsigned k = 1; k < box->n_out; k++)
        same = same && c->registers[at++] == box->out[k];
    for (unsigned k = 0; k < box->n_in; k++)
        same = same && box->in[k] == c->registers[at++];
    for (unsigned k = box->n_in; k < sizeof(box->in); k++)
        CHECK(box->in[k] == 0xEE, "a byte behind the answer was written");
    return same && c->at == at;
}

static void exchange_on(struct bench *bench, unsigned bus)
{
    struct plant_i2c *c = &plant.i2c[bus - 1u];
    for (unsigned n_out = 0; n_out < 6; n_out++) {
        for (unsigned n_in = 0; n_in < 8; n_in++) {
            uint8_t at = c->at;
            c->starts = c->stops = c->taken = c->given = 0;
            ask_i2c(bench, bus, PLANT_ADDRESS, n_out, n_in, 20);
            expect_i2c(bench, TRANSFER_DONE, "bytes");
            CHECK(i2c_bytes_are_right(bench, bus, at), "wrong bytes: %u out, %u in", n_out, n_in);
            bench_run(bench, MS);
            CHECK(c->taken == n_out && c->given == n_in, "%u taken, %u given", c->taken, c->given);
            CHECK(c->stops == 1 && c->starts == (n_out > 0 && n_in > 0 ? 2u : 1u), "%u starts",
                  c->starts);
            uint64_t least = UINT64_C(90000) * (n_out + n_in), took = c->ended_ns - c->began_ns;
            CHECK(took >= least, "%llu ns; at the least %llu", (unsigned long long)took,
                  (unsigned long long)least);
        }
    }
    for (unsigned n_out = 4; n_out < 12; n_out++) /* interrupts held off somewhere in the middle */
        for (unsigned n_in = 1; n_in < 6; n_in++) {
            bench->hold_ms = 3;
            ask_i2c(bench, bus, PLANT_ADDRESS, n_out, n_in, 20);
            expect_i2c(bench, TRANSFER_DONE, "interrupts held off");
            CHECK(i2c_bytes_are_right(bench, bus, 0), "wrong bytes after a hold");
        }
    ask_i2c(bench, bus, PLANT_ADDRESS, 100, 155, 100);
    expect_i2c(bench, TRANSFER_DONE, "a long one");
    CHECK(i2c_bytes_are_right(bench, bus, 0), "wrong bytes of a long one");
}

static void errors_on(struct bench *bench, unsigned bus)
{
    struct plant_i2c *c = &plant.i2c[bus - 1u];
    for (unsigned n = 0; n < 4; n++) {
        ask_i2c(bench, bus, PLANT_ADDRESS + 1u, n % 2u, n / 2u, 20);
        expect_i2c(bench, TRANSFER_NO_ANSWER, "no chip");
    }
    c->gives_none = true; /* it takes a byte, and does not answer when it is addressed again */
    ask_i2c(bench, bus, PLANT_ADDRESS, 1, 2, 20);
    expect_i2c(bench, TRANSFER_NO_ANSWER, "no chip to be read");
    c->gives_none = false;
    bench_run(bench, MS);
    c->stops = 0;
    volatile struct mailbox *box = bench_prepare(bench, IO_I2C);
    box->bus = bus;
    box->mode = PLANT_ADDRESS;
    box->n_out = 3;
    box->out[0] = PLANT_REFUSES;
    bench_ask(bench);
    expect_i2c(bench, TRANSFER_FAILED, "a byte refused");
    bench_run(bench, MS);
    CHECK(c->stops == 1, "no stop behind a byte that was refused");

    c->held = I2C_CLOCK_HELD; /* for good: no transfer ends, each fails */
    ask_i2c(bench, bus, PLANT_ADDRESS, 1, 1, 20);
    expect_i2c(bench, TRANSFER_FAILED, "clock held");
    c->held = 0;
    ask_i2c(bench, bus, PLANT_ADDRESS, 1, 20, 5);
    bench_run(bench, 1500000);
    c->held = I2C_CLOCK_HELD; /* in the middle */
    CHECK(bench_wait(bench) == ERR_TIMEOUT && bench->box->state == TRANSFER_FAILED, "not stopped");
    c->held = 0;
    plant_i2c_board_reset(); /* the chip was in a byte */
    ask_i2c(bench, bus, PLANT_ADDRESS, 2, 2, 20);
    expect_i2c(bench, TRANSFER_DONE, "after a clock that was held");

    for (unsigned clocks = 1; clocks <= 9; clocks++) {
        c->held = I2C_DATA_HELD;
        c->clocks = clocks;
        ask_i2c(bench, bus, PLANT_ADDRESS, 2, 2, 20);
        expect_i2c(bench, TRANSFER_DONE, "after a data line that was held");
    }
    c->held = I2C_DATA_HELD; /* shorted */
    c->clocks = 0;
    ask_i2c(bench, bus, PLANT_ADDRESS, 2, 2, 20);
    expect_i2c(bench, TRANSFER_FAILED, "data shorted");
    c->held = 0;
    ask_i2c(bench, bus, PLANT_ADDRESS, 20, 2, 20);
    bench_run(bench, 1500000);
    c->held = I2C_DATA_HELD; /* within a byte */
    expect_i2c(bench, TRANSFER_FAILED, "data held in a byte");
    c->held = 0;
    ask_i2c(bench, bus, PLANT_ADDRESS, 4, 20, 20);
    bench_run(bench, 1500000);
    i2c_tell_bus_error(bench->board, bus);
    expect_i2c(bench, TRANSFER_DONE, "a bus error that was none");
    CHECK(i2c_bytes_are_right(bench, bus, 0), "wrong bytes with a bus error that was none");
    i2c_lock_busy(bench->board, bus);
    ask_i2c(bench, bus, PLANT_ADDRESS, 2, 3, 20);
    expect_i2c(bench, TRANSFER_DONE, "after a BUSY that a glitch has set");
}

static uint64_t i2c_instructions(struct bench *bench, unsigned n_out, unsigned n_in, uint32_t *ms)
{
    ask_i2c(bench, 1, PLANT_ADDRESS, n_out, n_in, 0);
    uint64_t before = bench->board->instructions;
    expect_i2c(bench, TRANSFER_DONE, "measured");
    *ms = bench->box->took_ms;
    return bench->board->instructions - before;
}

void case_i2c(const char *image)
{
    struct bench bench;
    bench_start(&bench, image, 1);
    CHECK(open_i2c(&bench, 0) == ERR_RANGE && open_i2c(&bench, 3) == ERR_RANGE, "no such bus");
    ask_i2c(&bench, 1, PLANT_ADDRESS, 1, 1, 0);
    CHECK(bench_wait(&bench) == ERR_STATE, "a bus that is not open was used");
    plant.i2c[1].held = I2C_DATA_HELD; /* when it is opened */
    plant.i2c[1].clocks = 4;
    for (unsigned bus = 1; bus <= PLANT_I2C_BUSES; bus++) {
        CHECK(open_i2c(&bench, bus) == ERR_OK, "not opened");
        CHECK(plant.i2c[bus - 1u].held == 0, "the line is still held");
        exchange_on(&bench, bus);
        errors_on(&bench, bus);
    }
    uint32_t few_ms, ms;
    uint64_t few = i2c_instructions(&bench, 2, 4, &few_ms),
             out = i2c_instructions(&bench, 42, 4, &ms), before = bench.board->instructions;
    bench_run(&bench, 100u * MS);
    double idle = (double)(bench.board->instructions - before) / 100.0;
    double each_out = ((double)(out - few) - (double)(ms - few_ms) * idle) / 40.0;
    uint64_t in = i2c_instructions(&bench, 2, 44, &ms);
    double each_in = ((double)(in - few) - (double)(ms - few_ms) * idle) / 40.0;
    printf("I2C: %.0f instructions a byte out, %.0f a byte in\n", each_out, each_in);
    bench_stop(&bench);
}

void case_i2c_campaign(const char *image, uint32_t count, uint64_t seed)
{
    struct bench bench;
    unsigned wrong = 0, failed = 0, unanswered = 0, resets = 0, stopped = 0, glitches = 0;
    bench_start(&bench, image, seed);
    for (unsigned bus = 1; bus <= PLANT_I2C_BUSES; bus++)
        CHECK(open_i2c(&bench, bus) == ERR_OK, "not opened");
    plant.errors_per_million = 100;
    for (uint32_t i = 0; i < count; i++) {
        unsigned bus = 1u + bench_random(&bench, PLANT_I2C_BUSES);
        struct plant_i2c *c = &plant.i2c[bus - 1u];
        uint32_t errors = plant.errors;
        uint8_t at = c->at;
        bool glitch = bench_random(&bench, 100) == 0;
        ask_i2c(&bench, bus, PLANT_ADDRESS, bench_random(&bench, 5), bench_random(&bench, 8), 8);
        if (bench_random(&bench, 200) == 0) {
            bench_run(&bench, bench_random(&bench, 2500000));
            bench_reset(&bench);
            resets++;
            for (unsigned k = 1; k <= PLANT_I2C_BUSES; k++)
                CHECK(open_i2c(&bench, k) == ERR_OK, "not opened");
            CHECK(c->held == 0, "the line is still held after a reset");
            continue;
        }
        if (glitch) { /* one of the lines is low for a while, or BUSY is set */
            unsigned kind = bench_random(&bench, 4);
            bench_run(&bench, bench_random(&bench, 2500000));
            glitches++;
            if (kind == 2) {
                i2c_lock_busy(bench.board, bus);
            } else if (kind == 3) {
                i2c_tell_bus_error(bench.board, bus);
            } else {
                c->held = 1u << kind;
                bench_run(&bench, bench_random(&bench, 12000000));
                c->held = 0;
            }
        }
        if (bench_wait(&bench) == ERR_TIMEOUT) {
            CHECK(glitch, "transfer %u hung", i);
            plant_i2c_board_reset();
            stopped++;
            continue;
        }
        uint32_t state = bench.box->state;
        bool right = state == TRANSFER_DONE && i2c_bytes_are_right(&bench, bus, at);
        CHECK(right || glitch || plant.errors != errors,
              "transfer %u: state %u without a bit error", i, state);
        failed += state == TRANSFER_FAILED ? 1u : 0;
        unanswered += state == TRANSFER_NO_ANSWER ? 1u : 0;
        wrong += state == TRANSFER_DONE && !right ? 1u : 0;
    }
    printf(
        "I2C: %u transfers, seed %llu: %u bit errors, %u glitches of a line, %u wrong, %u failed, "
        "%u unanswered, %u stopped, %u resets, 0 hung, %.1f s of the board\n",
        count, (unsigned long long)seed, plant.errors, glitches, wrong, failed, unanswered, stopped,
        resets, (double)board_ns(bench.board) / 1e9);
    bench_stop(&bench);
}

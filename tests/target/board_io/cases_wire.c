/* 1-wire: presence, bytes both ways, searches, shorts, and many transfers with bit errors and resets.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdio.h>
#include <string.h>

#include "board_io.h"

#define SKIP 0xCCu

static enum err open_wire(struct bench *bench, unsigned bus)
{
    bench_prepare(bench, IO_WIRE_OPEN)->bus = bus;
    bench_ask(bench);
    return bench_wait(bench);
}

static void put_chips(struct bench *bench, unsigned bus, unsigned n)
{
    struct plant_wire *w = &plant.wires[bus - 1u];
    w->n = n;
    for (unsigned i = 0; i < n; i++)
        for (unsigned k = 0; k < 8; k++) /* the family is the same, and most of what follows */
            w->chips[i].rom[k] = (uint8_t)(k == 0  ? 0x28u
                                           : k < 3 ? bench_random(bench, 4)
                                                   : bench_random(bench, 256));
}

/* n_out bytes for a chip and n_in from it, behind a command for all chips. */
static void ask_wire(struct bench *bench, unsigned bus, unsigned n_out, unsigned n_in,
                     uint32_t limit_ms)
{
    volatile struct mailbox *box = bench_prepare(bench, IO_WIRE);
    box->bus = bus;
    box->n_out = n_out + 2u;
    box->n_in = n_in;
    box->limit_ms = limit_ms;
    box->out[0] = SKIP;
    box->out[1] = (uint8_t)n_out;
    for (unsigned i = 0; i < n_out; i++)
        box->out[2u + i] = (uint8_t)bench_random(bench, 256);
    bench_ask(bench);
}

static bool wire_bytes_are_right(const struct bench *bench, unsigned bus)
{
    const struct plant_on_wire *c = &plant.wires[bus - 1u].chips[0];
    volatile struct mailbox *box = bench->box;
    bool same = c->heard == box->out[1];
    uint32_t sum = 0;
    for (unsigned k = 0; k + 2u < box->n_out; k++) {
        same = same && c->bytes[k] == box->out[2u + k];
        sum += box->out[2u + k];
    }
    for (unsigned k = 0; k < box->n_in; k++)
        same = same && box->in[k] == plant_answer(sum, k);
    for (unsigned k = box->n_in; k < sizeof(box->in); k++)
        CHECK(box->in[k] == 0xEE, "a byte behind the answer was written");
    return same;
}

/* Starts a pass; the address and branch of the one before are in the mailbox's `in` and result. */
static void ask_search(struct bench *bench, unsigned bus, const uint8_t rom[8], uint32_t branch)
{
    volatile struct mailbox *box = bench_prepare(bench, IO_WIRE_SEARCH);
    box->bus = bus;
    box->value = branch;
    box->limit_ms = 40;
    for (unsigned k = 0; k < 8; k++)
        box->out[k] = rom[k];
    bench_ask(bench);
}

/* All addresses on a wire; returns how many there were. */
static unsigned search_all(struct bench *bench, unsigned bus)
{
    const struct plant_wire *w = &plant.wires[bus - 1u];
    unsigned found = 0, seen = 0;
    uint8_t rom[8] = {0};
    uint32_t branch = 0;
    do {
        ask_search(bench, bus, rom, branch);
        CHECK(bench_wait(bench) == ERR_OK && bench->box->state == TRANSFER_DONE, "state %u",
              bench->box->state);
        for (unsigned k = 0; k < 8; k++)
            rom[k] = bench->box->in[k];
        branch = bench->box->result;
        for (unsigned i = 0; i < w->n; i++)
            if (memcmp(w->chips[i].rom, rom, 8) == 0)
                seen |= 1u << i;
        found++;
        CHECK(found <= w->n, "the search goes on behind the last address");
    } while (branch != 0);
    CHECK(seen == (1u << w->n) - 1u, "not all addresses: %x", seen);
    return found;
}

static void expect_state(struct bench *bench, enum transfer_state state, const char *what)
{
    CHECK(bench_wait(bench) == ERR_OK && bench->box->state == state, "%s: state %u", what,
          bench->box->state);
}

static uint64_t wire_instructions(struct bench *bench, unsigned n)
{
    ask_wire(bench, 1, 1, n, 0);
    uint64_t before = bench->board->instructions;
    CHECK(bench_wait(bench) == ERR_OK, "not sent");
    return bench->board->instructions - before;
}

static uint64_t idle_instructions(struct bench *bench)
{
    uint64_t before = bench->board->instructions;
    bench_run(bench, 100u * MS);
    return (bench->board->instructions - before) / 100u;
}

static void exchange_on(struct bench *bench, unsigned bus)
{
    static const uint8_t nothing[8];
    plant.wires[bus - 1u].n = 0;
    ask_wire(bench, bus, 1, 1, 20);
    expect_state(bench, TRANSFER_NO_ANSWER, "no chip");
    ask_search(bench, bus, nothing, 0);
    expect_state(bench, TRANSFER_NO_ANSWER, "no chip to be found");
    for (unsigned n = 1; n <= PLANT_ON_A_WIRE; n++) {
        put_chips(bench, bus, n);
        CHECK(search_all(bench, bus) == n, "not all found");
    }
    put_chips(bench, bus, 1);
    for (unsigned n = 0; n < 12; n++) {
        ask_wire(bench, bus, n / 2u, n, 50);
        expect_state(bench, TRANSFER_DONE, "bytes");
        CHECK(wire_bytes_are_right(bench, bus), "wrong bytes");
    }
    for (unsigned n = 0; n < 8;
         n++) { /* interrupts held off, in the reset pulse or in the middle of a bit */
        bench->hold_ms = 3;
        ask_wire(bench, bus, n, 4, 50);
        expect_state(bench, TRANSFER_DONE, "interrupts held off");
        CHECK(wire_bytes_are_right(bench, bus), "wrong bytes after a hold");
    }
    /* a reset pulse, and nothing else */
    volatile struct mailbox *box = bench_prepare(bench, IO_WIRE);
    box->bus = bus;
    bench_ask(bench);
    expect_state(bench, TRANSFER_DONE, "a pulse alone");
}

static void shorts_on(struct bench *bench, unsigned bus)
{
    plant.wires[bus - 1u].shorted = true;
    ask_wire(bench, bus, 1, 1, 20);
    expect_state(bench, TRANSFER_FAILED, "a short");
    plant.wires[bus - 1u].shorted = false;
    ask_wire(bench, bus, 1, 40, 50);
    bench_run(bench, 10u * MS);
    plant.wires[bus - 1u].shorted = true; /* in the middle */
    expect_state(bench, TRANSFER_FAILED, "a short in a transfer");
    plant.wires[bus - 1u].shorted = false;
    static const uint8_t nothing[8];
    plant.wires[bus - 1u].pulled = true;
    ask_wire(bench, bus, 1, 1, 20);
    expect_state(bench, TRANSFER_FAILED, "a 1 that somebody pulls low");
    ask_search(bench, bus, nothing, 0);
    expect_state(bench, TRANSFER_FAILED, "a search command that somebody pulls low");
    plant.wires[bus - 1u].pulled = false;
    ask_wire(bench, bus, 1, 200, 8);
    CHECK(bench_wait(bench) == ERR_TIMEOUT && bench->box->state == TRANSFER_FAILED, "not stopped");
    ask_wire(bench, bus, 3, 3, 20);
    expect_state(bench, TRANSFER_DONE, "after a stop");
    CHECK(wire_bytes_are_right(bench, bus), "wrong bytes after a stop");
}

void case_wire(const char *image)
{
    struct bench bench;
    bench_start(&bench, image, 1);
    CHECK(open_wire(&bench, 0) == ERR_RANGE && open_wire(&bench, 3) == ERR_RANGE, "no such wire");
    ask_wire(&bench, 1, 1, 1, 0);
    CHECK(bench_wait(&bench) == ERR_STATE, "a wire that is not open was used");
    for (unsigned bus = 1; bus <= PLANT_WIRES; bus++) {
        CHECK(open_wire(&bench, bus) == ERR_OK, "not opened");
        exchange_on(&bench, bus);
        shorts_on(&bench, bus);
    }
    uint64_t few = wire_instructions(&bench, 2);
    uint32_t few_ms = bench.box->took_ms;
    uint64_t many = wire_instructions(&bench, 42);
    uint32_t ms = bench.box->took_ms - few_ms;
    double each = ((double)(many - few) - (double)ms * (double)idle_instructions(&bench)) / 40.0;
    printf("1-wire: %.0f instructions a byte, %.0f a bit; a byte takes %.2f ms\n", each, each / 8.0,
           (double)plant.wires[0].slot_ns * 8.0 / 1e6);
    bench_stop(&bench);
}

void case_wire_campaign(const char *image, uint32_t count, uint64_t seed)
{
    static const uint8_t nothing[8];
    struct bench bench;
    unsigned wrong = 0, unanswered = 0, failed = 0, resets = 0, searches = 0;
    bench_start(&bench, image, seed);
    for (unsigned bus = 1; bus <= PLANT_WIRES; bus++) {
        CHECK(open_wire(&bench, bus) == ERR_OK, "not opened");
        put_chips(&bench, bus, 1);
    }
    plant.errors_per_million = 100;
    for (uint32_t i = 0; i < count; i++) {
        unsigned bus = 1u + bench_random(&bench, PLANT_WIRES);
        uint32_t errors = plant.errors;
        bool searched = bench_random(&bench, 10) == 0;
        if (searched)
            ask_search(&bench, bus, nothing, 0);
        else
            ask_wire(&bench, bus, bench_random(&bench, 4), bench_random(&bench, 10), 40);
        searches += searched ? 1u : 0;
        if (bench_random(&bench, 200) == 0) {
            bench_run(&bench, bench_random(&bench, 12000000));
            bench_reset(&bench);
            resets++;
            for (unsigned k = 1; k <= PLANT_WIRES; k++)
                CHECK(open_wire(&bench, k) == ERR_OK, "not opened");
            continue;
        }
        CHECK(bench_wait(&bench) == ERR_OK, "transfer %u hung", i);
        uint32_t state = bench.box->state;
        bool disturbed = plant.errors != errors,
             right = state == TRANSFER_DONE && (searched || wire_bytes_are_right(&bench, bus));
        if (searched && state == TRANSFER_DONE)
            for (unsigned k = 0; k < 8; k++)
                right = right && bench.box->in[k] == plant.wires[bus - 1u].chips[0].rom[k];
        CHECK(right || disturbed, "transfer %u: state %u without a bit error", i, state);
        unanswered += state == TRANSFER_NO_ANSWER ? 1u : 0;
        failed += state == TRANSFER_FAILED ? 1u : 0;
        wrong += state == TRANSFER_DONE && !right ? 1u : 0;
    }
    printf("1-wire: %u transfers (%u searches), seed %llu: %u bit errors, %u wrong, %u failed, %u "
           "unanswered, %u resets, 0 hung, %.1f s of the board\n",
           count, searches, (unsigned long long)seed, plant.errors, wrong, failed, unanswered,
           resets, (double)board_ns(bench.board) / 1e9);
    bench_stop(&bench);
}

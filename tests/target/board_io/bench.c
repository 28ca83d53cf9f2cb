/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "board_io.h"

#define HANG_NS (1000u * MS)

bool bench_exact;

_Noreturn void fail(const char *format, ...)
{
    va_list list;
    va_start(list, format);
    (void)vfprintf(stderr, format, list);
    va_end(list);
    (void)fputc('\n', stderr);
    exit(1);
}

static void await_ready(struct bench *bench)
{
    uint64_t end = board_ns(bench->board) + HANG_NS;
    while (bench->box->ready != MAILBOX_READY && board_ns(bench->board) < end)
        bench_run(bench, MS / 10u);
    CHECK(bench->box->ready == MAILBOX_READY, "the image does not start");
    bench->asked = 0;
}

void bench_start(struct bench *bench, const char *image, uint64_t seed)
{
    static uint8_t bytes[1u << 20];
    FILE *f = fopen(image, "rb");
    size_t n = f == NULL ? 0 : fread(bytes, 1, sizeof(bytes), f);
    if (f != NULL)
        (void)fclose(f);
    CHECK(n > 0, "cannot read %s", image);
    const struct surroundings around = {.crystal_hz = 8000000,
                                        .slow_clock_hz = 32000,
                                        .supply_mv = 3300,
                                        .brown_out_mv = 2830,
                                        .baud = 115200,
                                        .seed = seed};
    char err[256] = "";
    struct world world = plant_world();
    plant_reset(seed);
    bench->random = random_state(seed + 1u);
    bench->hold_ms = 0;
    bench->board = board_new(&chip_stm32f405, &around, bytes, n, bench_exact, err, sizeof(err));
    CHECK(bench->board != NULL, "%s", err);
    board_set_world(bench->board, &world);
    bench->box = (volatile struct mailbox *)(void *)processor_memory(bench->board, MAILBOX_ADDRESS,
                                                                     sizeof(struct mailbox));
    board_power_on(bench->board);
    bench->box->ready = 0;
    await_ready(bench);
}

void bench_stop(struct bench *bench)
{
    board_free(bench->board);
}

void bench_reset(struct bench *bench)
{
    bench->box->ready = 0;
    board_ask_reset(bench->board, RESET_PIN);
    plant_i2c_board_reset();
    await_ready(bench);
}

void bench_run(struct bench *bench, uint64_t ns)
{
    board_run(bench->board, board_ns(bench->board) + ns);
    CHECK(bench->board->verdict[0] == '\0', "the board ended: %s", bench->board->verdict);
}

uint32_t bench_random(struct bench *bench, uint32_t n)
{
    return random_word(&bench->random) % n;
}

volatile struct mailbox *bench_prepare(struct bench *bench, enum io_command command)
{
    volatile struct mailbox *box = bench->box;
    box->command = command;
    box->bus = box->pin = box->mode = box->hz = box->value = 0;
    box->n_out = box->n_in = box->limit_ms = 0;
    return box;
}

void bench_ask(struct bench *bench)
{
    bench->box->hold_ms = bench->hold_ms;
    bench->hold_ms = 0;
    bench->box->request = ++bench->asked;
}

enum err bench_wait(struct bench *bench)
{
    uint64_t end = board_ns(bench->board) + HANG_NS;
    while (bench->box->done != bench->asked && board_ns(bench->board) < end)
        bench_run(bench, MS / 4u);
    CHECK(bench->box->done == bench->asked, "request %u of kind %u hangs", bench->asked,
          bench->box->command);
    return (enum err)bench->box->err;
}

enum err bench_do(struct bench *bench, enum io_command command, unsigned pin, uint32_t mode,
                  uint32_t value)
{
    volatile struct mailbox *box = bench_prepare(bench, command);
    box->pin = pin;
    box->mode = mode;
    box->value = value;
    bench_ask(bench);
    return bench_wait(bench);
}

/* The board in memory one turn of the main loop at a time, so that a sample may come in the middle of the background's work. */
#ifndef REFLUX_TESTS_TURN_BENCH_H
#define REFLUX_TESTS_TURN_BENCH_H

#include "plant_board.h"

/* Bytes for whom they are for, with the board standing still. */
static inline void hear(void)
{
    uint8_t byte;
    struct frame f;
    size_t n;
    while ((n = memory_port_take(HAL_UART_CONSOLE, board.said + board.n_said,
                                 SAID_MAX - 1 - board.n_said)) != 0) {
        board.n_said += n;
        board.said[board.n_said] = '\0';
    }
    while (memory_port_take(HAL_UART_LINK, &byte, 1))
        if (frame_decode(&board.decoder, byte, &f))
            plant_answers(&f);
}

static inline struct frame measured(void)
{
    struct frame f;
    struct link_sample sample;
    instruments_measure(&instruments, plant, board.tick_ms / 1000.0, &sample);
    sample.number = ++board.number;
    sample.time_ms = board.time_ms;
    pack_sample(&sample, &f);
    return f;
}

/* The plant goes on under the last command. */
static inline void advance(void)
{
    double tick_s = board.tick_ms / 1000.0;
    instruments_command(&instruments, &board.command);
    TEST_ASSERT_TRUE(instruments_drive(&instruments, plant, tick_s, plant_err, sizeof plant_err));
    board.time_ms += board.tick_ms;
    TEST_ASSERT_TRUE(
        kind->advance(plant, (double)board.time_ms / 1000.0, plant_err, sizeof plant_err));
}

/* A sample from a plant that waits for its answer: the main loop gets a turn for each of the tick's, and the sample is sent
 * again meanwhile. Whether it had to wait. */
static inline bool waits_for_its_answer(void)
{
    unsigned before = board.commands;
    struct frame f = measured();
    link_give(&f);
    memory_port_turn();
    hear();
    bool waited = board.commands == before;
    if (waited)
        link_give(&f);
    for (unsigned n = 0; board.commands == before; n++) {
        TEST_ASSERT_TRUE_MESSAGE(n < 100000, "a sample was not answered");
        memory_port_turn();
        hear();
    }
    TEST_ASSERT_EQUAL(before + 1, board.commands);
    advance();
    return waited;
}

#endif

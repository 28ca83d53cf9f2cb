/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "board.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "chip.h"
#include "faults.h"
#include "replay.h"

#define NS_PER_S UINT64_C(1000000000)

uint64_t board_ns(const struct board *b)
{
    unsigned __int128 spent = b->cycles - b->anchor_cycles;
    return b->anchor_ns + (uint64_t)(spent * NS_PER_S / b->core_hz);
}

uint64_t board_cycles_at(const struct board *b, uint64_t ns)
{
    if (ns <= b->anchor_ns)
        return b->anchor_cycles;
    if (ns == BOARD_NEVER)
        return BOARD_NEVER;
    unsigned __int128 later = ns - b->anchor_ns;
    return b->anchor_cycles + (uint64_t)((later * b->core_hz + NS_PER_S - 1) / NS_PER_S);
}

uint64_t board_internal_hz(const struct board *b)
{
    uint64_t hz = b->chip->internal_hz;
    return hz + (uint64_t)((int64_t)hz * b->around.oscillator_ppm / 1000000);
}

void board_set_core_hz(struct board *b, uint64_t hz)
{
    uint64_t now = board_ns(b);
    b->anchor_ns = now;
    b->anchor_cycles = b->cycles;
    b->core_hz = hz;
    b->clock_changed = true;
    processor_break(b);
}

/* ---- events ---- */

static void find_next(struct board *b)
{
    b->next_ns = BOARD_NEVER;
    for (size_t i = 0; i < b->n_events; i++)
        if (b->events[i]->at_ns < b->next_ns)
            b->next_ns = b->events[i]->at_ns;
}

void board_add_event(struct board *b, struct board_event *e)
{
    e->at_ns = BOARD_NEVER;
    if (b->n_events == BOARD_EVENTS)
        abort();
    b->events[b->n_events++] = e;
}

void board_schedule(struct board *b, struct board_event *e, uint64_t at_ns)
{
    bool was_next = e->at_ns == b->next_ns;
    e->at_ns = at_ns;
    if (at_ns <= b->next_ns)
        b->next_ns = at_ns;
    else if (was_next)
        find_next(b);
    processor_break(b);
}

void board_run_events(struct board *b)
{
    uint64_t now = board_ns(b);
    while (b->next_ns <= now) {
        struct board_event *first = b->events[0]; /* there is one, for next_ns is its time */
        for (size_t i = 1; i < b->n_events; i++)
            if (b->events[i]->at_ns < first->at_ns)
                first = b->events[i];
        first->at_ns = BOARD_NEVER;
        find_next(b);
        first->due(first->context);
    }
}

/* ---- life ---- */

struct board *board_new(const struct chip *chip, const struct surroundings *around,
                        const uint8_t *image, size_t image_bytes, bool exact, char *err,
                        size_t err_size)
{
    struct board *b = calloc(1, sizeof(*b));
    if (b == NULL) {
        (void)snprintf(err, err_size, "no memory");
        return NULL;
    }
    b->chip = chip;
    b->around = *around;
    b->random = random_state(around->seed);
    b->core_hz = chip->internal_hz;
    b->next_ns = BOARD_NEVER;
    if (!processor_start(b, image, image_bytes, exact, err, err_size)) {
        free(b);
        return NULL;
    }
    bus_start(b);
    b->faults = faults_new(b);
    return b;
}

void board_free(struct board *b)
{
    replay_free(b);
    faults_free(b->faults);
    bus_stop(b);
    processor_stop(b);
    free(b);
}

const char *board_reset_name(enum board_reset kind)
{
    static const char *const names[] = {"power", "brown-out", "pin", "software", "watchdog"};
    return names[kind];
}

/* What runs on from before a reset ends with it. */
static void end_events(struct board *b)
{
    b->reset_asked = false;
    b->stalled_until_ns = 0;
    for (size_t i = 0; i < b->n_events; i++)
        if (!b->events[i]->outlives_reset)
            b->events[i]->at_ns = BOARD_NEVER;
    find_next(b);
}

static void reset(struct board *b, enum board_reset kind)
{
    b->resets[kind]++;
    board_note(b, "reset %s", board_reset_name(kind));
    b->hang_main = b->hang_tick = b->hang_clock = false;
    bus_reset(b, kind); /* while it is still known what the flash was about */
    end_events(b);
    board_set_core_hz(b, board_internal_hz(b));
    bus_reset(b, kind);
    processor_reset(b);
}

void board_hold(struct board *b, enum board_reset kind)
{
    board_note(b, "held %s", board_reset_name(kind));
    b->held = true;
    for (unsigned line = 0; line < BOARD_LINES; line++)
        b->lines[line].to_head = b->lines[line].to_tail;
    bus_reset(b, kind);
    end_events(b);
    processor_reset(b);
    processor_break(b);
}

void board_release(struct board *b, enum board_reset kind, bool forgets)
{
    b->held = false;
    if (forgets)
        processor_scramble(b);
    reset(b, kind);
}

void board_power_on(struct board *b)
{
    processor_scramble(b);
    reset(b, RESET_POWER);
}

void board_ask_reset(struct board *b, enum board_reset kind)
{
    b->reset_asked = true;
    b->reset_kind = kind;
    processor_break(b);
}

void board_pause(struct board *b)
{
    b->paused = true;
    processor_break(b);
}

/* Until the time or the cycle, whichever is first. How many cycles a time is may change on the way. */
static void run(struct board *b, uint64_t until_ns, uint64_t cycle)
{
    b->paused = false;
    while (b->verdict[0] == '\0' && !b->paused) {
        uint64_t until = board_cycles_at(b, until_ns);
        until = cycle < until ? cycle : until;
        if (b->cycles >= until)
            return;
        if (b->reset_asked)
            reset(b, b->reset_kind);
        b->clock_changed = false;
        processor_run(b, until);
    }
}

void board_run(struct board *b, uint64_t until_ns)
{
    run(b, until_ns, BOARD_NEVER);
}

void board_run_to_cycle(struct board *b, uint64_t cycle)
{
    run(b, BOARD_NEVER, cycle);
}

void board_verdict(struct board *b, const char *format, ...)
{
    if (b->verdict[0] != '\0')
        return;
    va_list list;
    va_start(list, format);
    int n = vsnprintf(b->verdict, sizeof(b->verdict), format, list);
    va_end(list);
    if (n > 0 && (size_t)n < sizeof(b->verdict))
        (void)snprintf(b->verdict + n, sizeof(b->verdict) - (size_t)n, ", at %s0x%08x, %.6f s",
                       processor_pc_is_exact(b) ? "" : "or after ", processor_pc(b),
                       (double)board_ns(b) / 1e9);
    processor_break(b);
}

void board_note(struct board *b, const char *format, ...)
{
    if (b->diary == NULL)
        return;
    va_list list;
    va_start(list, format);
    (void)fprintf(b->diary, "%.9f ", (double)board_ns(b) / 1e9);
    (void)vfprintf(b->diary, format, list);
    (void)fputc('\n', b->diary);
    (void)fflush(b->diary);
    va_end(list);
}

uint64_t random_state(uint64_t seed)
{
    return seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
}

uint32_t random_word(uint64_t *state)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return (uint32_t)((*state * UINT64_C(0x2545F4914F6CDD1D)) >> 32);
}

uint32_t board_random(struct board *b)
{
    return random_word(&b->random);
}

/* ---- lines ---- */

size_t line_take(struct board *b, unsigned line, uint8_t *bytes, size_t size)
{
    struct line *l = &b->lines[line];
    size_t n = 0;
    while (n < size && l->from_head != l->from_tail)
        bytes[n++] = l->from_board[l->from_head++ % BOARD_LINE_ROOM];
    return n;
}

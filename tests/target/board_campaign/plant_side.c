/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "plant_side.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/text.h"
#include "instruments.h"
#include "link_server.h"
#include "plants/plant_library.h"

#define LINK    1
#define PLANT   "pilot"
#define EVERY   UINT64_C(100000000) /* ns of the board between a command and the next sample */
#define NEAR    1e-4
#define REASONS 160

/* As host_sim/scenarios/pilot.conf has them. */
static const struct limits {
    const char *name;
    double lo, hi, safe;
} limits[] = {{"Lr", 1.0, 9.0, 4.5}, {"Qrb", 0.4, 1.25, 0.0}};

struct plant_side {
    struct board *board;
    const struct plant_class *class;
    struct plant *plant;
    struct instruments instruments;
    struct transport transport;
    struct link_server link;
    struct frame_decoder decoder; /* of all that the board sends */
    uint32_t number, greetings;
    uint64_t time_ms, due_ns;
    unsigned ticks;
    char wrong[REASONS];
};

static void look(struct plant_side *p, const struct frame *f)
{
    struct link_command m;
    if (f->type != LINK_COMMAND || p->wrong[0] != '\0')
        return;
    if (unpack_command(f, &m) != ERR_OK) {
        (void)snprintf(p->wrong, sizeof(p->wrong), "a command that cannot be read");
        return;
    }
    for (unsigned i = 0; i < m.n_outputs; i++) {
        double value = (double)m.output[i].value;
        const struct limits *l = i < sizeof(limits) / sizeof(limits[0]) ? &limits[i] : NULL;
        if (m.output[i].drive &&
            (l == NULL || ((value < l->lo || value > l->hi) && fabs(value - l->safe) > NEAR)))
            (void)snprintf(p->wrong, sizeof(p->wrong), "%s commanded to %g at %.3f s",
                           l == NULL ? "an output that is not there" : l->name, value,
                           (double)board_ns(p->board) / 1e9);
    }
}

static long take(struct transport *t, void *buffer, size_t size)
{
    struct plant_side *p = t->context;
    struct frame f;
    size_t n = line_take(p->board, LINK, buffer, size);
    for (size_t i = 0; i < n; i++)
        if (frame_decode(&p->decoder, ((const uint8_t *)buffer)[i], &f))
            look(p, &f);
    return (long)n;
}

static long give(struct transport *t, const void *data, size_t n)
{
    struct plant_side *p = t->context;
    (void)line_give(p->board, LINK, data, n); /* what finds no room is lost, as on a wire */
    return (long)n;
}

static uint64_t now_ms(struct transport *t)
{
    return board_ns(((struct plant_side *)t->context)->board) / 1000000u;
}

static const struct transport_ops ops = {.read = take, .write = give, .now_ms = now_ms};

struct plant_side *plant_side_new(struct board *board)
{
    char err[SIM_ERROR_SIZE] = "";
    struct plant_side *p = calloc(1, sizeof(*p));
    if (p == NULL)
        return NULL;
    p->board = board;
    p->class = plant_open(PLANT, err, sizeof(err));
    p->plant = p->class == NULL ? NULL : plant_create(p->class, err, sizeof(err));
    p->transport =
        (struct transport){.ops = &ops, .context = p, .fd = -1, .spare_fd = -1, .where = "board"};
    frame_decoder_reset(&p->decoder);
    if (p->plant == NULL ||
        !instruments_init(&p->instruments, p->class, 1, 1.0, err, sizeof(err)) ||
        !link_server_init(&p->link, &p->transport, p->class,
                          (uint32_t)lround(p->class->tick_s * 1000.0), 1, err, sizeof(err))) {
        (void)fprintf(stderr, "board-campaign: %s\n", err);
        free(p);
        return NULL;
    }
    return p;
}

static void one_tick(struct plant_side *p)
{
    char err[SIM_ERROR_SIZE] = "";
    double tick_s = p->class->tick_s;
    instruments_command(&p->instruments, &p->link.command);
    p->link.answered = false;
    p->number++;
    p->ticks++;
    p->time_ms += (uint64_t)lround(tick_s * 1000.0);
    if (!instruments_drive(&p->instruments, p->plant, tick_s, err, sizeof(err)) ||
        !p->class->advance(p->plant, (double)p->time_ms / 1000.0, err, sizeof(err)))
        (void)snprintf(p->wrong, sizeof(p->wrong), "plant: %.100s", err);
    p->due_ns = board_ns(p->board) + EVERY;
}

void plant_side_turn(struct plant_side *p)
{
    p->transport.ready = true;
    if (!link_server_turn(&p->link)) {
        (void)snprintf(p->wrong, sizeof(p->wrong), "%.100s", p->link.error);
        p->link.error[0] = '\0';
    }
    if (p->link.state != LINK_SAMPLING)
        return;
    if (p->link.greetings != p->greetings) {
        p->greetings = p->link.greetings;
        instruments_safe(&p->instruments);
    }
    if (p->link.answered)
        one_tick(p);
    if (p->link.waiting && p->link.held) {
        (void)link_server_resend(&p->link);
    } else if (!p->link.waiting && board_ns(p->board) >= p->due_ns) {
        struct link_sample sample = {.number = p->number, .time_ms = p->time_ms};
        instruments_measure(&p->instruments, p->plant, p->class->tick_s, &sample);
        (void)link_server_sample(&p->link, &sample);
    }
}

unsigned plant_side_ticks(const struct plant_side *p)
{
    return p->ticks;
}

const char *plant_side_wrong(const struct plant_side *p)
{
    return p->wrong;
}

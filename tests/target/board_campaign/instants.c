/* A reset by the pin or a cut of the supply at a random instruction or moment, with the pilot column at the link: the set is there again,
 * the start says the right reason, and no output was commanded outside its limits.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "campaigns.h"
#include "faults.h"
#include "plant_side.h"
#include "versions.h"

enum state { STARTING, MANUAL, AUTO, COMMISSIONING, SAVING, STATES };

static const struct {
    const char *name;
    const char *lines[3];      /* that lead to it */
    unsigned instructions, ns; /* from its snapshot on: the span of the instants */
} states[STATES] = {
    [STARTING] = {"start-up", {NULL}, 12000000, 900000000},
    [MANUAL] = {"manual", {"out Lr 4.5", "out Qrb 0.8"}, 2000000, 300000000},
    [AUTO] = {"auto", {"out Qrb 0.8", "mode top auto", "mode bottom auto"}, 2000000, 300000000},
    [COMMISSIONING] = {"commissioning",
                       {"out Lr 4.5", "out Qrb 0.8", "commission begin"},
                       2000000,
                       300000000},
    [SAVING] = {"save", {"out Lr 4.5", "out Qrb 0.8"}, 2000000, 120000000},
};

#define STORED      0u /* version */
#define SAVED       1u
#define TICKS_FIRST 12u
#define RUNS_A_TICK 20u /* in a state that lasts, the snapshot moves on after so many runs */
#define STRIKE_NS   (30u * SECOND)
#define AFTER_NS    (1u * SECOND)
#define TICK_NS     (5u * SECOND) /* an erase may come between */

struct instant {
    const struct campaign *c;
    struct station *s;
    enum state state;
    unsigned number;
};

static bool find(char *result, const struct instant *i, const char *kind, const char *how,
                 const char *what)
{
    const struct station *s = i->s;
    size_t tail = s->n > 100u ? s->n - 100u : 0;
    (void)snprintf(result, RUN_TEXT, "%s %s, %.80s: %.100s; %.80s; %.100s", kind,
                   states[i->state].name, how, what, s->board->verdict, s->said + tail);
    for (char *at = result; *at != '\0'; at++)
        if (*at == '\n' || *at == '\t')
            *at = ' ';
    return false;
}

/* The supply goes, or the button is pressed; and it is over. */
static bool strike(struct instant *i, bool cut, char *how, size_t size)
{
    struct station *s = i->s;
    struct board *b = s->board;
    uint64_t random = campaign_random(i->c, i->number);
    char err[BOARD_VERDICT];
    bool by_time = below(&random, 2) == 0;
    double off_s = cut ? 0.001 * (double)(1u + below(&random, 3000))
                       : 1e-6 * (double)(1u + below(&random, 500000));
    uint32_t after =
        1u + below(&random, by_time ? states[i->state].ns : states[i->state].instructions);
    (void)snprintf(how, size, "%s of %g s after %u %s", cut ? "cut" : "reset", off_s, after,
                   by_time ? "ns" : "instructions");
    b->random = random_state(random);
    uint32_t pins = b->resets[RESET_PIN], powers = b->resets[RESET_POWER];
    if (!faults_add(b, by_time ? FAULT_AFTER_NS : FAULT_AFTER_INSTRUCTIONS, (double)after, err,
                    sizeof(err)) ||
        !faults_add(b, cut ? FAULT_POWER_CUT : FAULT_BUTTON, off_s, err, sizeof(err)))
        return false;
    if (i->state == STARTING) {
        station_forget(s);
        board_release(b, RESET_POWER, true);
        powers++;
    }
    if (i->state == SAVING)
        (void)line_give(b, 0, (const uint8_t *)"save\r", 5);
    uint64_t end = board_ns(b) + STRIKE_NS;
    while (b->resets[RESET_PIN] + b->resets[RESET_POWER] == pins + powers && board_ns(b) < end &&
           b->verdict[0] == '\0')
        station_run(s, MS);
    return b->resets[cut ? RESET_POWER : RESET_PIN] == (cut ? powers : pins) + 1u;
}

static void one_instant(void *context, char *result)
{
    struct instant *i = context;
    struct station *s = i->s;
    char how[100], why[RUN_TEXT];
    bool cut = i->number / STATES % 2u == 0;
    if (!strike(i, cut, how, sizeof(how))) {
        (void)find(result, i, "UNREACHED", how, "no reset");
        return;
    }
    /* A pin's reset before the firmware has cleared the flags of power-on finds both. */
    bool early = i->state == STARTING && s->n == 0;
    station_forget(s);
    if (!station_greet(s) || !station_loaded(s)) {
        (void)find(result, i, "LOST", how, "no start with the stored set");
        return;
    }
    int found = i->number / STATES % i->c->whole == 0 ? versions_whole(s, why, sizeof(why))
                                                      : versions_read(s, why, sizeof(why));
    if (found != (int)STORED && (found != (int)SAVED || i->state != SAVING)) {
        (void)find(result, i, "LOST", how, found < 0 ? why : "a set that was not stored");
        return;
    }
    const char *reason = cut ? "started by: power-on" : "started by: reset-pin";
    if (!station_ask(s, "version") ||
        (strstr(s->said, reason) == NULL && !(early && strstr(s->said, "by: power-on") != NULL))) {
        const char *told = strstr(s->said, "started by");
        (void)find(result, i, "REASON", how, told == NULL ? "not answered" : told);
        return;
    }
    unsigned ticks = plant_side_ticks(s->plant);
    station_run(s, AFTER_NS);
    if (s->board->verdict[0] != '\0' || plant_side_ticks(s->plant) == ticks)
        (void)find(result, i, "STOPPED", how, "no command any more");
    else if (plant_side_wrong(s->plant)[0] != '\0')
        (void)find(result, i, "OUTPUT", how, plant_side_wrong(s->plant));
    else
        (void)snprintf(result, RUN_TEXT, "%s %s, %s", found == (int)STORED ? "kept" : "saved",
                       states[i->state].name, how);
}

static bool refuse(const struct station *s, enum state state, const char *what)
{
    (void)fprintf(stderr, "board-campaign: %s: %s; the board: %s; its console: %.300s\n",
                  states[state].name, what, s->board->verdict, s->said);
    return false;
}

static bool ticks(struct station *s, unsigned n)
{
    unsigned to = plant_side_ticks(s->plant) + n;
    for (unsigned k = 0; k < n && plant_side_ticks(s->plant) < to; k++) {
        unsigned before = plant_side_ticks(s->plant);
        uint64_t end = board_ns(s->board) + TICK_NS;
        while (plant_side_ticks(s->plant) == before && board_ns(s->board) < end)
            station_run(s, MS);
    }
    return plant_side_ticks(s->plant) >= to;
}

static bool enter(struct station *s, const struct campaign *c, enum state state)
{
    char path[512], why[256];
    (void)snprintf(path, sizeof(path), "%s/%s", c->root, versions_use(false));
    board_power_on(s->board);
    station_run(s, NEW_CHIP_NS);
    if (!station_greet(s) || !ticks(s, TICKS_FIRST))
        return refuse(s, state, "no start");
    if (!station_configure(s, path, why, sizeof(why)) || !versions_set(s, STORED) ||
        !versions_learn(s) || !station_ask(s, "save"))
        return refuse(s, state, why);
    /* Once more from the beginning: the code is translated then, and the set is there. */
    board_hold(s->board, RESET_POWER);
    board_release(s->board, RESET_POWER, true);
    station_forget(s);
    if (!station_greet(s) || !station_loaded(s) || !ticks(s, TICKS_FIRST))
        return refuse(s, state, "no second start");
    for (unsigned k = 0; k < 3u && states[state].lines[k] != NULL; k++)
        if (!station_ask(s, states[state].lines[k]) || !ticks(s, 2))
            return refuse(s, state, states[state].lines[k]);
    if (!ticks(s, TICKS_FIRST))
        return refuse(s, state, "no commands");
    if (state == SAVING && !versions_set(s, SAVED))
        return refuse(s, state, "settings");
    if (state == STARTING)
        board_hold(s->board, RESET_POWER);
    return plant_side_wrong(s->plant)[0] == '\0' || refuse(s, state, plant_side_wrong(s->plant));
}

static bool lasts(enum state state)
{
    return state != STARTING && state != SAVING;
}

/* All runs of one state, from its snapshot. */
static bool of_state(const struct campaign *c, enum state state)
{
    unsigned first = c->from + (STATES + (unsigned)state - c->from % STATES) % STATES;
    if (!runs_are_left(c->runs, first, c->from + c->count, STATES))
        return true;
    struct instant i = {.c = c, .s = station_new(c->image, c->seed), .state = state};
    if (i.s == NULL || (i.s->plant = plant_side_new(i.s->board)) == NULL || !enter(i.s, c, state))
        return false;
    unsigned moved = 0;
    for (unsigned n = c->from; n < c->from + c->count; n++) {
        char key[64];
        (void)snprintf(key, sizeof(key), "%u", n);
        if (n % STATES != (unsigned)state || runs_are_done(c->runs, key))
            continue;
        for (; lasts(state) && moved < n / STATES / RUNS_A_TICK; moved++)
            if (!ticks(i.s, 1))
                return refuse(i.s, state, "no commands");
        i.number = n;
        runs_add(c->runs, key, one_instant, &i);
    }
    return true;
}

bool random_instants(const struct campaign *c)
{
    bool ok = true;
    for (unsigned state = 0; ok && state < STATES; state++) {
        if (state == COMMISSIONING && c->image->chip == &chip_stm32f100)
            continue; /* its image has no automatic start-up */
        ok = of_state(c, (enum state)state);
        runs_wait(c->runs);
    }
    return ok;
}

#include "supervise/arena.h"

#include <stddef.h>
#include <string.h>

#include "supervise/supervisor.h"

/* By kind: its group in struct config, whose first field is the name that makes it exist, and its state. */
static const struct {
    uint16_t offset, stride;
    uint16_t state;
    uint8_t most;
} kinds[] = {
#define KIND(member, type, state, most)                                                            \
    {                                                                                              \
        offsetof(struct config, member), sizeof(struct type), sizeof(struct state), most           \
    }
    [PLACED_MEASUREMENTS] = KIND(measurement, measurement_config, measurement_state, CHANNEL_MAX),
    [PLACED_OUTPUTS] = KIND(output, output_config, output_state, CHANNEL_MAX),
    [PLACED_LOOPS] = KIND(loop, loop_config, loop_state, CONFIG_LOOPS),
    [PLACED_INTERLOCKS] = KIND(interlock, interlock_config, interlock_state, CONFIG_INTERLOCKS),
    [PLACED_ALARMS] = KIND(alarm, alarm_config, alarm_state, CONFIG_ALARMS),
    [PLACED_FEEDFORWARDS] = KIND(feedforward, ff_config, feedforward, CONFIG_FEEDFORWARDS),
    [PLACED_DECOUPLER] = {.state = sizeof(struct decoupler), .most = 0},
};
_Static_assert(offsetof(struct measurement_config, name) == 0 &&
                   offsetof(struct output_config, name) == 0 &&
                   offsetof(struct loop_config, name) == 0 &&
                   offsetof(struct interlock_config, measurement) == 0 &&
                   offsetof(struct alarm_config, on) == 0 && offsetof(struct ff_config, from) == 0,
               "the first byte of each tells whether it is there");

/* Each kind begins where any state may. */
#define GRAINS(bytes) (((bytes) + 7u) / 8u * 8u)
_Static_assert(GRAINS(CHANNEL_MAX * sizeof(struct measurement_state)) +
                       GRAINS(CHANNEL_MAX * sizeof(struct output_state)) +
                       GRAINS(CONFIG_LOOPS * sizeof(struct loop_state)) +
                       GRAINS(CONFIG_INTERLOCKS * sizeof(struct interlock_state)) +
                       GRAINS(CONFIG_ALARMS * sizeof(struct alarm_state)) +
                       GRAINS(CONFIG_FEEDFORWARDS * sizeof(struct feedforward)) +
                       GRAINS(sizeof(struct decoupler)) <=
                   PLAN_ARENA_BYTES,
               "only dead times can fail to fit");

void arena_count(const struct plan *plan, uint8_t n[PLACED_KINDS])
{
    memset(n, 0, PLACED_KINDS);
    for (unsigned k = 0; k < PLACED_KINDS; k++) {
        const char *name = (const char *)&plan->config + kinds[k].offset;
        for (uint8_t i = 0; i < kinds[k].most; i++, name += kinds[k].stride)
            if (*name)
                n[k] = (uint8_t)(i + 1u);
    }
    for (unsigned i = 0; i < CONFIG_LOOPS; i++)
        if (plan->loop[i].used && plan->loop[i].decouple)
            n[PLACED_DECOUPLER] = 1;
}

static uint32_t bytes_of(unsigned kind, uint8_t n)
{
    return GRAINS((uint32_t)n * kinds[kind].state);
}

uint32_t arena_state_bytes(const uint8_t n[PLACED_KINDS])
{
    uint32_t sum = 0;
    for (unsigned k = 0; k < PLACED_KINDS; k++)
        sum += bytes_of(k, n[k]);
    return sum;
}

static void move(struct supervisor *s, const uint8_t n[PLACED_KINDS], unsigned k, bool down)
{
    uint8_t *arena = (uint8_t *)s->arena;
    uint32_t from = 0, to = 0;
    for (unsigned j = 0; j < k; j++) {
        from += bytes_of(j, s->placed[j]);
        to += bytes_of(j, n[j]);
    }
    uint8_t kept = s->placed[k] < n[k] ? s->placed[k] : n[k];
    if (to != from && down == (to < from))
        memmove(arena + to, arena + from, (size_t)kept * kinds[k].state);
}

void arena_place(struct supervisor *s, const uint8_t n[PLACED_KINDS])
{
    uint8_t *at = (uint8_t *)s->arena;
    void *place[PLACED_KINDS];
    /* What moves down goes first, the lowest before the others, then what moves up, the highest before the others: the
     * order of the kinds never changes, so nothing is overwritten that has still to move. */
    for (unsigned k = 0; k < PLACED_KINDS; k++)
        move(s, n, k, true);
    for (unsigned k = PLACED_KINDS; k-- > 0;)
        move(s, n, k, false);
    for (unsigned k = 0; k < PLACED_KINDS; k++) {
        uint32_t kept = (uint32_t)(s->placed[k] < n[k] ? s->placed[k] : n[k]) * kinds[k].state;
        memset(at + kept, 0, bytes_of(k, n[k]) - kept);
        place[k] = at;
        at += bytes_of(k, n[k]);
    }
    memcpy(s->placed, n, PLACED_KINDS);
    s->measurement = place[PLACED_MEASUREMENTS];
    s->output = place[PLACED_OUTPUTS];
    s->loop = place[PLACED_LOOPS];
    s->interlock = place[PLACED_INTERLOCKS];
    s->alarm = place[PLACED_ALARMS];
    s->feedforward = place[PLACED_FEEDFORWARDS];
    s->decoupler = place[PLACED_DECOUPLER];
}

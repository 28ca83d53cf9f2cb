#include "exchange/arena_sizes.h"

#include <stddef.h>
#include <string.h>

/* For each kind of state: its group in struct config and its state. The first field of the group is a name; the
 * state exists if the name is not empty. */
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
    [PLACED_MVS] = KIND(mv, mv_config, mv_state, CHANNEL_MAX),
    [PLACED_LOOPS] = KIND(loop, loop_config, loop_state, CONFIG_LOOPS),
    [PLACED_INTERLOCKS] = KIND(interlock, interlock_config, interlock_state, CONFIG_INTERLOCKS),
    [PLACED_ALARMS] = KIND(alarm, alarm_config, alarm_state, CONFIG_ALARMS),
};
_Static_assert(offsetof(struct measurement_config, name) == 0 &&
                   offsetof(struct mv_config, name) == 0 &&
                   offsetof(struct loop_config, name) == 0 &&
                   offsetof(struct interlock_config, measurement) == 0 &&
                   offsetof(struct alarm_config, on) == 0,
               "the first byte of each tells whether it is there");

void arena_count(const struct plan *plan, uint8_t n[PLACED_KINDS])
{
    memset(n, 0, PLACED_KINDS);
    for (unsigned k = 0; k < PLACED_KINDS; k++) {
        const char *name = (const char *)&plan->config + kinds[k].offset;
        for (uint8_t i = 0; i < kinds[k].most; i++, name += kinds[k].stride)
            if (*name)
                n[k] = (uint8_t)(i + 1u);
    }
}

uint32_t arena_kind_bytes(enum placed kind)
{
    return kinds[kind].state;
}

uint32_t arena_kind_grains(enum placed kind, uint8_t n)
{
    return ARENA_GRAINS((uint32_t)n * kinds[kind].state);
}

uint32_t arena_state_bytes(const uint8_t n[PLACED_KINDS])
{
    uint32_t sum = 0;
    for (unsigned k = 0; k < PLACED_KINDS; k++)
        sum += arena_kind_grains((enum placed)k, n[k]);
    return sum * ARENA_GRAIN;
}

uint32_t arena_history_grains(uint16_t ticks)
{
    return ticks ? ARENA_GRAINS(applied_history_bytes(ticks)) : 0;
}

#include "exchange/alarm_names.h"

#include <string.h>

static const char *const sides[] = {"hi_hi", "hi", "lo", "lo_lo", "dev"};

const char *measurement_fault_text(uint8_t fault)
{
    static const char *const words[MEASUREMENT_FAULTS] = {
        "fine", "missing", "flagged bad", "not a number", "out of range", "too fast", "frozen",
    };
    return fault < MEASUREMENT_FAULTS ? words[fault] : "?";
}

void alarm_name(const struct config *config, uint8_t i, char name[CHANNEL_NAME_SIZE])
{
    const struct alarm_config *a = &config->alarm[i];
    if (alarm_is_on_event(a)) { /* an alarm on an event has no side */
        memcpy(name, a->on, CHANNEL_NAME_SIZE);
        return;
    }
    const char *side = sides[a->side];
    size_t room = CHANNEL_NAME_SIZE - 2u - strlen(side), n = strlen(a->on);
    n = n < room ? n : room;
    memcpy(name, a->on, n);
    name[n] = '.';
    memcpy(name + n + 1, side, strlen(side) + 1);
}

uint8_t alarm_find(const struct config *config, const char *name)
{
    char own[CHANNEL_NAME_SIZE];
    for (uint8_t i = 0; i < CONFIG_ALARMS; i++) {
        if (!config->alarm[i].on[0])
            continue;
        alarm_name(config, i, own);
        if (strcmp(own, name) == 0)
            return i;
        if (strncmp(name, "alarm", 5) == 0 && name[5] == (char)('1' + i) && !name[6])
            return i;
    }
    return PLAN_NONE;
}
_Static_assert(CONFIG_ALARMS <= 9, "alarm_find knows one digit");

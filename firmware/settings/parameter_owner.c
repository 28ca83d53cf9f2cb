/* Parameters by the name of the loop or channel that they belong to. */
#include <string.h>

#include "exchange/plan.h"
#include "settings/parameters.h"

bool parameter_numbered_name(const struct config *config, const char *name, unsigned k,
                             struct text *full)
{
    static const char *const groups[PARAMETER_OWNERS] = {"loop", "meas", "mv"};
    char owner[CHANNEL_NAME_SIZE] = {0};
    size_t n = strcspn(name, ".");
    if (n >= sizeof owner)
        return false;
    memcpy(owner, name, n);
    uint8_t index = k == 0   ? config_find_loop(config, owner)
                    : k == 1 ? config_find_measurement(config, owner)
                             : config_find_mv(config, owner);
    text_str(full, groups[k]);
    text_u32(full, index + 1u);
    text_str(full, name + n);
    return index != PLAN_NONE;
}

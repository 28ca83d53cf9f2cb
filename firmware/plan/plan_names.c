/* Takes names from a list. */
#include <string.h>

#include "plan/plan_parts.h"

const char *plan_next_name(const char *list, char name[CHANNEL_NAME_SIZE])
{
    size_t n = 0;
    memset(name, 0, CHANNEL_NAME_SIZE);
    while (*list == ' ')
        list++;
    while (list[n] && list[n] != ' ')
        n++;
    memcpy(name, list, n < CHANNEL_NAME_SIZE ? n : CHANNEL_NAME_SIZE - 1u);
    return n ? list + n : NULL;
}

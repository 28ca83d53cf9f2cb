/* Records why a configuration is refused. */
#include <string.h>

#include "plan/plan_parts.h"

enum err plan_refuse(struct config_fault *fault, enum err code, const char *group, unsigned index,
                     const char *field, const char *subject, const char *wanted)
{
    memset(fault, 0, sizeof *fault);
    fault->code = code;
    fault->group = group;
    fault->index = (uint8_t)index;
    fault->field = field;
    fault->wanted = wanted;
    strncpy(fault->subject, subject, sizeof fault->subject - 1);
    return code;
}

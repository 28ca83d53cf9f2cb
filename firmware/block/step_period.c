#include "block/step_period.h"

enum err step_period_check(float ticks, struct block_fault *fault)
{
    if (!(ticks >= 0.999f && ticks <= 10000.0f))
        return block_refuse(fault, 0, "period", "must be 1 to 10000 base ticks");
    if (!step_period_is_whole(ticks))
        return block_refuse(fault, 0, "period", "must be a whole number of base ticks");
    return ERR_OK;
}

#include "supervise/test_signal.h"

num_t mv_without_signal(const struct mv_state *o, num_t at)
{
    if (o->interlocked)
        return at;
    num_t part = num_abs(o->excitation);
    return num_clamp(num_sub(o->commanded, o->excitation), num_sub(at, part), num_add(at, part));
}

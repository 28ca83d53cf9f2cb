#include "commission/interim_fit.h"

#include <string.h>

#include "base/assertion.h"

#define KNOWN     REAL_C(0.33) /* largest standard deviation of a known gain, over the gain */
#define TIMED     REAL_C(0.5)  /* the same of the time until the response is over */
#define FIT_UNITS 4u           /* evaluations in one piece */

void interim_fit_begin(struct interim_fit *l, const struct record *record,
                       const struct baseline *baseline)
{
    REFLUX_ASSERT(record->outputs <= CHANNEL_MAX);
    l->seen = *record;
    memcpy(l->baseline, baseline, record->outputs * sizeof *baseline);
    l->output = 0;
    l->running = false;
}

static void nothing_found(struct interim_fit *l)
{
    REFLUX_ASSERT(l->output < CHANNEL_MAX);
    l->found[l->output] = (struct identified){.flags = IDENTIFIED_NO_GAIN};
    l->output++;
}

bool interim_fit_run(struct interim_fit *l)
{
    struct fopdt_fit_result r;
    if (l->output >= l->seen.outputs)
        return false;
    if (!l->running) {
        struct fopdt_fit_options o = {.baseline = l->baseline[l->output]};
        l->running = fopdt_fit_begin(&l->fit, &l->seen, l->output, &o) == ERR_OK;
        if (!l->running)
            nothing_found(l);
    } else if (fopdt_fit_run(&l->fit, FIT_UNITS)) {
        l->running = false;
        if (fopdt_fit_result(&l->fit, &r) == ERR_OK)
            l->found[l->output++] = r.element;
        else
            nothing_found(l);
    }
    return l->output < l->seen.outputs;
}

bool interim_fit_is_timed(const struct identified *f, bool drifts)
{
    real_t over_s = (drifts ? REAL_C(0.0) : f->dead_time_s) + IDENTIFIED_OVER * f->time_constant_s;
    return IDENTIFIED_OVER * f->time_constant_sd_s < TIMED * over_s;
}

bool interim_fit_is_known(const struct identified *f)
{
    return !(f->flags & (IDENTIFIED_NO_GAIN | IDENTIFIED_INTEGRATING)) &&
           f->gain_sd < KNOWN * real_abs(f->gain);
}

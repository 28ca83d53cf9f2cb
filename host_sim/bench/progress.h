/* Progress of a run, on stderr: one updating line on a terminal, now and then a plain line elsewhere. */
#ifndef REFLUX_HOST_SIM_PROGRESS_H
#define REFLUX_HOST_SIM_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct progress {
    bool wanted, terminal;
    double duration_s;   /* negative: without end */
    double began, shown; /* own clock, s */
    uint64_t shown_samples;
};

void progress_begin(struct progress *p, bool wanted, double duration_s);
void progress_show(struct progress *p, double plant_time_s, uint64_t samples);
void progress_end(struct progress *p, double plant_time_s, uint64_t samples);

#endif

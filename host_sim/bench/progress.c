#include "bench/progress.h"

#include <stdio.h>
#include <unistd.h>

#include "bench/text.h"

#define TERMINAL_INTERVAL_S 0.2
#define PLAIN_INTERVAL_S    5.0

void progress_begin(struct progress *p, bool wanted, double duration_s)
{
    *p = (struct progress){.wanted = wanted,
                           .terminal = isatty(STDERR_FILENO) == 1,
                           .duration_s = duration_s,
                           .began = sim_clock_s()};
    p->shown = p->began;
}

static void print(struct progress *p, double now, double plant_time_s, uint64_t samples)
{
    double rate = (double)(samples - p->shown_samples) / (now - p->shown + 1e-9);
    (void)fprintf(stderr, "%splant time %.0f s", p->terminal ? "\r" : "", plant_time_s);
    if (p->duration_s > 0.0) {
        (void)fprintf(stderr, " of %.0f s (%.0f %%)", p->duration_s,
                      100.0 * plant_time_s / p->duration_s);
    }
    (void)fprintf(stderr, ", %.0f ticks/s%s", rate, p->terminal ? "   " : "\n");
    (void)fflush(stderr);
    p->shown = now;
    p->shown_samples = samples;
}

void progress_show(struct progress *p, double plant_time_s, uint64_t samples)
{
    if (!p->wanted) {
        return;
    }
    double now = sim_clock_s();
    if (now - p->shown >= (p->terminal ? TERMINAL_INTERVAL_S : PLAIN_INTERVAL_S)) {
        print(p, now, plant_time_s, samples);
    }
}

void progress_end(struct progress *p, double plant_time_s, uint64_t samples)
{
    if (!p->wanted) {
        return;
    }
    p->shown = p->began; /* the last line says the mean rate */
    p->shown_samples = 0;
    print(p, sim_clock_s(), plant_time_s, samples);
    if (p->terminal) {
        (void)fputc('\n', stderr);
    }
}

/* What a tick of a column costs, in microseconds of processor time: at rest, under control (both inputs move
 * a little every tick), and with both inputs jumping all over their range.
 *
 * plant_cost [PLANT]    pilot when none is named */
#include "plant.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

static double now_us(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e6 + (double)t.tv_nsec * 1e-3;
}

static double uniform(unsigned *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (*seed >> 8) / 16777216.0;
}

int main(int argc, char **argv)
{
    static const char *const title[3] = {"at rest", "under control", "jumping"};
    const struct plant_class *c = plant_find(argc > 1 ? argv[1] : "pilot");
    char err[256];
    unsigned seed = 1;

    if (!c) {
        fprintf(stderr, "%s is no plant written in C\n", argv[1]);
        return 1;
    }
    for (int mode = 0; mode < 3; mode++) {
        struct plant *p = c->create(err, sizeof err);
        int ticks = 4000;
        double start = now_us();
        for (int k = 1; p && k <= ticks; k++) {
            bool ok = true;
            for (size_t i = 0; i < 2 && mode; i++) {
                const struct plant_channel *mv = &c->channels[i];
                double u = mode == 1 ? mv->nominal * (0.99 + 0.02 * uniform(&seed))
                                     : mv->lo + (mv->hi - mv->lo) * uniform(&seed);
                ok = ok && c->set_input(p, i, u, err, sizeof err);
            }
            if (!ok || !c->advance(p, 30.0 * k, err, sizeof err)) {
                fprintf(stderr, "%s\n", err);
                return 1;
            }
        }
        printf("%-14s %6.1f us per 30 s tick\n", title[mode], (now_us() - start) / ticks);
        c->destroy(p);
    }
    return 0;
}

#include "bench/swings.h"

#include <math.h>

struct sim_swing *swings_of(struct swings *s, size_t channel, double middle)
{
    for (size_t k = 0; k < s->n; k++) {
        if (s->list[k].channel == channel) {
            return &s->list[k];
        }
    }
    if (s->n == SWINGS_MAX) {
        return NULL;
    }
    s->list[s->n] =
        (struct sim_swing){.channel = channel, .middle = middle, .period_s = SWING_PERIOD_S};
    s->n++;
    return &s->list[s->n - 1];
}

void swing_set_amplitude(struct sim_swing *s, double amplitude, double time_s)
{
    s->ends = amplitude == 0.0 && s->amplitude != 0.0;
    s->amplitude = amplitude;
    s->begun_s = time_s;
}

bool swings_moved(struct swings *s, size_t channel, double value)
{
    for (size_t k = 0; k < s->n; k++) {
        if (s->list[k].channel == channel) {
            s->list[k].middle = value;
            return s->list[k].amplitude != 0.0;
        }
    }
    return false;
}

size_t swings_add(struct swings *s, double time_s, struct plant_change *change, size_t n)
{
    const double turn = 6.283185307179586;
    for (size_t k = 0; k < s->n; k++) {
        struct sim_swing *w = &s->list[k];
        if (w->amplitude == 0.0 && !w->ends) {
            continue;
        }
        double phase = turn * fmod(time_s - w->begun_s, w->period_s) / w->period_s;
        change[n] = (struct plant_change){w->channel, w->middle + w->amplitude * sin(phase)};
        n++;
        w->ends = false;
    }
    return n;
}

#include "kinds/ff_tune/tune_signals.h"

#include "kinds/ff_tune/tune_signals_state.h"

void tune_signals_begin(struct tune_signals *s)
{
    s->samples = 0;
}

void tune_signals_sample(struct tune_signals *s)
{
    s->samples++;
}

void tune_signals_stop(struct tune_signals *s)
{
    s->asked = false;
}

void tune_signals_pause(struct tune_signals *s)
{
    s->paused = s->asked;
    s->asked = false;
}

bool tune_signals_failed(const struct tune_signals *s, const struct block_io *io)
{
    return s->asked && io->requests.excite_state != EXCITE_RUNS;
}

static num_t square_wave(const struct tune_signals *s, const struct tune_context *c, float size,
                         float period_s)
{
    uint32_t half = tune_samples_in(c, 0.5f * period_s);
    bool up = (s->samples / half & 1u) == 0;
    return num_from_float(up ? size : -size);
}

static float fraction_of(float size, const struct block_signal *s)
{
    return size / (s->hi - s->lo);
}

/* A signal may not become another one: a step without a signal lies in between. */
void tune_signals_ask(struct tune_signals *s, const struct tune_context *c, struct block_io *io,
                      bool on_setpoint, bool on_disturbance)
{
    uint8_t wanted = (uint8_t)((on_setpoint ? 1u : 0u) | (on_disturbance ? 2u : 0u)), n = 0;
    bool other = s->asked && s->wanted != wanted;
    s->asked = false;
    s->wanted = wanted;
    if (s->paused || other) {
        s->paused = false;
        return;
    }
    if (on_setpoint) {
        float size = fraction_of(c->s.step, &c->y_signal);
        io->requests.excite[n++] =
            (struct block_excitation){.what = EXCITE_SETPOINT,
                                      .which = 0,
                                      .value = square_wave(s, c, size, c->s.step_period_s),
                                      .amplitude = num_from_float(size),
                                      .lo = num_from_float(-1),
                                      .hi = num_from_float(2)};
    }
    if (on_disturbance) {
        float size = fraction_of(c->s.disturb, &c->d_signal);
        io->requests.excite[n++] =
            (struct block_excitation){.what = EXCITE_INPUT,
                                      .which = 1,
                                      .value = square_wave(s, c, size, c->s.disturb_period_s),
                                      .amplitude = num_from_float(size),
                                      .lo = num_from_float(-1),
                                      .hi = num_from_float(2)};
    }
    s->asked = n > 0;
}

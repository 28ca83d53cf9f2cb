#include "instruments.h"

#include <math.h>

#include "bench/text.h"

bool instruments_init(struct instruments *in, const struct plant_class *class, uint64_t seed,
                      double noise_factor, char *err, size_t err_size)
{
    *in = (struct instruments){.class = class};
    for (size_t i = 0; i < class->n_channels; i++) {
        const struct plant_channel *c = &class->channels[i];
        if ((c->kind == PLANT_MEASUREMENT && in->n_sensors == LINK_CHANNELS_MAX) ||
            (c->kind == PLANT_MV && in->n_actuators == LINK_CHANNELS_MAX)) {
            return sim_fail(err, err_size,
                            "plant %s: channel %s is one too many, the link carries at most %d "
                            "measurements and %d manipulated variables",
                            class->name, c->name, LINK_CHANNELS_MAX, LINK_CHANNELS_MAX);
        }
        if (c->kind == PLANT_MEASUREMENT) {
            struct sensor *s = &in->sensor[in->n_sensors];
            *s = (struct sensor){.channel = i,
                                 .lag_s = c->lag_s,
                                 .resolution = c->resolution,
                                 .hum_period_s = 60.0,
                                 .every = 1};
            noise_seed(&s->random, seed, in->n_sensors + 1);
            noise_seed(&s->chance, seed, in->n_sensors + 1 + LINK_CHANNELS_MAX);
            in->n_sensors++;
        } else if (c->kind == PLANT_MV) {
            in->actuator[in->n_actuators] = (struct actuator){.channel = i,
                                                              .lo = c->lo,
                                                              .hi = c->hi,
                                                              .slew = c->slew,
                                                              .lag_s = c->lag_s,
                                                              .readback = 1,
                                                              .gain = 1.0,
                                                              .command = c->nominal,
                                                              .target = c->nominal,
                                                              .position = c->nominal,
                                                              .output = c->nominal,
                                                              .applied = c->nominal};
            in->n_actuators++;
        }
    }
    instruments_noise(in, noise_factor);
    return true;
}

void instruments_begin(struct instruments *in, const struct plant *plant)
{
    for (size_t k = 0; k < in->n_actuators; k++) {
        struct actuator *a = &in->actuator[k];
        a->command = a->target = a->position = a->output = a->applied =
            in->class->value(plant, a->channel);
    }
}

/* Seconds in ticks; 0 where they are no whole number of them. */
static unsigned whole_ticks(double time_s, double tick_s, unsigned most)
{
    double ticks = round(time_s / tick_s);
    bool whole = ticks >= 1.0 && ticks <= (double)most && fabs(ticks * tick_s - time_s) < 1e-6;
    return whole ? (unsigned)ticks : 0;
}

bool instruments_analysers(struct instruments *in, double tick_s, char *err, size_t err_size)
{
    for (size_t i = 0; i < in->n_sensors; i++) {
        struct sensor *s = &in->sensor[i];
        const struct plant_channel *c = &in->class->channels[s->channel];
        if (c->every_s > 0.0) {
            s->every = whole_ticks(c->every_s, tick_s, ANALYSER_EVERY_MAX);
        }
        if (c->delay_s > 0.0) {
            s->delay = whole_ticks(c->delay_s, tick_s, ANALYSER_DELAY_MAX);
        }
        if (s->every == 0 || (c->delay_s > 0.0 && s->delay == 0)) {
            return sim_fail(err, err_size,
                            "plant %s: %s has a new value every %g s, sampled %g s before; both "
                            "must be whole ticks of %g s, at most %d and %d of them",
                            in->class->name, c->name, c->every_s, c->delay_s, tick_s,
                            ANALYSER_EVERY_MAX, ANALYSER_DELAY_MAX);
        }
    }
    return true;
}

void instruments_noise(struct instruments *in, double factor)
{
    for (size_t i = 0; i < in->n_sensors; i++) {
        struct sensor *s = &in->sensor[i];
        s->noise = factor * in->class->channels[s->channel].noise;
    }
}

static void set_sensor(struct sensor *s, enum instrument_option option, double value)
{
    switch (option) {
    case OPTION_BIAS:
        s->bias = value;
        break;
    case OPTION_NOISE:
        s->noise = value;
        break;
    case OPTION_RESOLUTION:
        s->resolution = value;
        break;
    case OPTION_QUALITY:
        s->quality = (int)value;
        break;
    case OPTION_LAG:
        s->lag_s = value;
        break;
    case OPTION_STUCK:
        s->stuck = true;
        s->stuck_at = value;
        break;
    case OPTION_FREE:
        s->stuck = s->frozen = s->dead = false;
        break;
    case OPTION_DRIFT:
        s->drift = value;
        s->drifted = value == 0.0 ? 0.0 : s->drifted;
        break;
    case OPTION_FROZEN:
        s->frozen = value != 0.0;
        break;
    case OPTION_DEAD:
        s->dead = value != 0.0;
        break;
    case OPTION_SPIKE:
        s->spike = value;
        break;
    case OPTION_HUM:
        s->hum = value;
        break;
    case OPTION_HUM_PERIOD:
        s->hum_period_s = value;
        break;
    case OPTION_SPIKE_RATE:
        s->spikes_per_h = value;
        break;
    case OPTION_DROPOUT:
        s->dropout = value;
        break;
    case OPTION_NAN:
        s->not_a_number = value != 0.0;
        break;
    case OPTION_EVERY:
        s->every = (unsigned)value;
        break;
    case OPTION_PHASE:
        s->phase = (unsigned)value;
        break;
    case OPTION_DELAY:
        s->delay = (unsigned)value;
        break;
    default:
        break;
    }
}

/* Value that the plant gets from an output: a valve with another trim does more, or less, from where it stood. */
static double felt(const struct actuator *a, double output)
{
    return a->pivot_felt + a->gain * (output - a->pivot);
}

static void set_actuator(struct actuator *a, enum instrument_option option, double value)
{
    switch (option) {
    case OPTION_HI:
        a->hi = value;
        break;
    case OPTION_LO:
        a->lo = value;
        break;
    case OPTION_SLEW:
        a->slew = value;
        break;
    case OPTION_LAG:
        a->lag_s = value;
        break;
    case OPTION_STUCK:
        a->stuck = true;
        a->position = value;
        a->output = value;
        break;
    case OPTION_FREE:
        a->stuck = false;
        break;
    case OPTION_STICTION:
        a->stiction = value;
        break;
    case OPTION_BACKLASH:
        a->backlash = value;
        break;
    case OPTION_READBACK:
        a->readback = (int)value;
        break;
    case OPTION_GAIN:
        a->pivot_felt = felt(a, a->output);
        a->pivot = a->output;
        a->gain = value;
        break;
    default:
        break;
    }
}

void instruments_set(struct instruments *in, size_t channel, enum instrument_option option,
                     double value)
{
    for (size_t i = 0; i < in->n_sensors; i++) {
        if (in->sensor[i].channel == channel) {
            set_sensor(&in->sensor[i], option, value);
        }
    }
    for (size_t i = 0; i < in->n_actuators; i++) {
        if (in->actuator[i].channel == channel) {
            set_actuator(&in->actuator[i], option, value);
        }
    }
}

/* First-order lag over dt while its input goes straight from u0 to u1: the exact end value. */
static double lag_step(double y, double u0, double u1, double dt, double tau)
{
    if (tau <= 0.0) {
        return u1;
    }
    double trail = (u1 - u0) / dt * tau; /* how far a ramp is followed behind */
    return u1 - trail + (y - u0 + trail) * exp(-dt / tau);
}

/* Sum of the spikes in this sample. */
static double spike(struct sensor *s, double dt_s)
{
    double hit = noise_uniform(&s->chance);
    double side = noise_uniform(&s->chance);
    if (hit >= s->spikes_per_h * dt_s / 3600.0) {
        return 0.0;
    }
    return side < 0.5 ? -s->spike : s->spike;
}

/* Value that an analyser shows in sample `n` of the run, in which its sensor reads x. */
static double analysis(struct sensor *s, double x, unsigned long n)
{
    const unsigned long room = ANALYSER_DELAY_MAX + 1;
    s->past[n % room] = x;
    if (n == 0) {
        s->analysis = x; /* that of before: the plant was at rest */
    }
    if (n >= s->delay && n % s->every == s->phase % s->every) {
        s->analysis = s->past[(n - s->delay) % room];
    }
    return s->analysis;
}

static double faulty_reading(const struct sensor *s, const struct plant_channel *c, double x,
                             bool begun)
{
    if (s->dead) {
        return c->lo;
    }
    if (s->stuck) {
        return s->stuck_at;
    }
    return s->frozen && begun ? s->shown : x;
}

static void read_sensor(struct sensor *s, const struct plant_channel *c, double truth, double dt_s,
                        bool begun, unsigned long n)
{
    if (!begun) {
        s->filtered = truth;
    } else if (dt_s > 0.0) {
        s->filtered = lag_step(s->filtered, s->truth, truth, dt_s, s->lag_s);
    }
    s->truth = truth;
    s->drifted += s->drift * dt_s / 3600.0;
    double x = s->filtered + s->bias + s->drifted + s->noise * noise_normal(&s->random);
    const double turn = 6.283185307179586;
    s->age_s += dt_s;
    x += s->hum * sin(turn * s->age_s / s->hum_period_s);
    x += spike(s, dt_s);
    if (s->resolution > 0.0) {
        x = floor(x / s->resolution + 0.5) * s->resolution;
    }
    x = analysis(s, x, n);
    x = faulty_reading(s, c, x, begun);
    s->shown = x;
    int quality = s->quality;
    if (!s->stuck && !(x >= c->lo && x <= c->hi)) {
        x = x < c->lo ? c->lo : c->hi;
        quality = quality < QUALITY_UNCERTAIN ? QUALITY_UNCERTAIN : quality;
    }
    if (noise_uniform(&s->chance) < s->dropout) {
        quality = QUALITY_MISSING;
    }
    s->reading = quality == QUALITY_MISSING ? 0.0f : s->not_a_number ? NAN : (float)x;
    s->sent_quality = (uint8_t)quality;
}

static struct link_reading readback(const struct actuator *a)
{
    if (a->readback == 0) {
        return (struct link_reading){.value = 0.0f, .quality = QUALITY_MISSING};
    }
    return (struct link_reading){.value = (float)(a->readback == 2 ? a->command : a->applied),
                                 .quality = QUALITY_GOOD};
}

void instruments_measure(struct instruments *in, const struct plant *plant, double dt_s,
                         struct link_sample *sample)
{
    sample->n_measurements = (uint8_t)in->n_sensors;
    sample->n_readback = (uint8_t)in->n_actuators;
    for (size_t i = 0; i < in->n_sensors; i++) {
        struct sensor *s = &in->sensor[i];
        read_sensor(s, &in->class->channels[s->channel], in->class->value(plant, s->channel), dt_s,
                    in->begun, in->taken);
        sample->measurement[i] =
            (struct link_reading){.value = s->reading, .quality = s->sent_quality};
    }
    for (size_t i = 0; i < in->n_actuators; i++) {
        sample->readback[i] = readback(&in->actuator[i]);
    }
    in->begun = true;
    in->taken++;
}

void instruments_command(struct instruments *in, const struct link_command *command)
{
    for (size_t i = 0; i < in->n_actuators && i < command->n_outputs; i++) {
        if (command->output[i].drive) {
            in->actuator[i].command = (double)command->output[i].value;
        }
    }
}

void instruments_safe(struct instruments *in)
{
    for (size_t i = 0; i < in->n_actuators; i++) {
        in->actuator[i].command = in->class->channels[in->actuator[i].channel].safe;
    }
}

/* One straight piece of the position's way; returns the integral of the output over it. */
static double move(struct actuator *a, double to, double dt)
{
    double from = a->position;
    double before = a->output;
    a->position = to;
    a->output = lag_step(before, from, to, dt, a->lag_s);
    double integral = 0.5 * (from + to) * dt;
    /* Lag: tau dy/dt = u - y, so the integral of y is that of u less tau times the change of y. */
    return a->lag_s > 0.0 ? integral - a->lag_s * (a->output - before) : integral;
}

/* Takes up the play and the stiction between the command and what the actuator is driven to. */
static double driven_to(struct actuator *a)
{
    double play = 0.5 * a->backlash;
    double to = fmin(fmax(a->target, a->command - play), a->command + play);
    /* Stick and slip: it stays, and then goes all the way at once. */
    if (fabs(to - a->target) > a->stiction) {
        a->target = to;
    }
    return a->target;
}

static void drive(struct actuator *a, double dt_s)
{
    if (a->stuck) {
        a->applied = a->output;
        return;
    }
    double target = driven_to(a);
    target = target > a->hi ? a->hi : target;
    target = target < a->lo ? a->lo : target;
    double way = target - a->position;
    double ramp_s = a->slew > 0.0 ? fabs(way) / a->slew : 0.0;
    if (ramp_s <= 0.0) {
        a->position = target;
        a->applied = move(a, target, dt_s) / dt_s;
    } else if (ramp_s >= dt_s) {
        a->applied = move(a, a->position + copysign(a->slew * dt_s, way), dt_s) / dt_s;
    } else {
        double integral = move(a, target, ramp_s);
        integral += move(a, target, dt_s - ramp_s);
        a->applied = integral / dt_s;
    }
}

bool instruments_drive(struct instruments *in, struct plant *plant, double dt_s, char *err,
                       size_t err_size)
{
    for (size_t i = 0; i < in->n_actuators; i++) {
        struct actuator *a = &in->actuator[i];
        const struct plant_channel *c = &in->class->channels[a->channel];
        drive(a, dt_s);
        /* The mean of values within the span can leave it by a rounding error. */
        a->applied = fmin(fmax(a->applied, c->lo), c->hi);
        double there = fmin(fmax(felt(a, a->applied), c->lo), c->hi);
        if (!in->class->set_input(plant, a->channel, there, err, err_size)) {
            return false;
        }
    }
    return true;
}

/* Sensors and actuators around a perfect plant, at the resolution of the sample interval.
 *
 * Sensor, in this order: first-order lag (the true value is taken as a straight line between two samples, so
 * steps at samples and ramps are followed exactly), bias, drift, normal noise, spikes, quantisation, stuck or
 * frozen or dead, and the span: what lies outside is clipped and marked uncertain. Then what is no reading at
 * all: not a number, quality, dropout. An analyser shows, from every n-th sample to the next, what came out of
 * quantisation some samples ago; it can be stuck, frozen or dead like any other.
 *
 * Actuator: stiction, backlash, limits, slew rate, first-order lag, stuck. Within an interval the position moves as it really would;
 * the plant gets the mean of the interval, so that the amount delivered is right, and the read-back of the next
 * sample is that same mean.
 *
 * Every sensor draws from streams of its own, the same numbers a sample whatever its options: changing one
 * sensor leaves the others as they were, and faults leave the noise as it was.
 */
#ifndef REFLUX_HOST_SIM_INSTRUMENTS_H
#define REFLUX_HOST_SIM_INSTRUMENTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "bench/noise.h"
#include "link/messages.h"
#include "plants/plant.h"

enum instrument_option {
    OPTION_BIAS,  /* sensor: added to the reading, units */
    OPTION_NOISE, /* sensor: standard deviation, units; from then on --noise does not scale it */
    OPTION_RESOLUTION, /* sensor: quantisation step, units, 0 = none */
    OPTION_QUALITY,    /* sensor: 0..3 as enum quality */
    OPTION_LAG,        /* sensor and actuator: time constant, s, 0 = none */
    OPTION_HI,         /* actuator: upper limit, units */
    OPTION_LO,         /* actuator: lower limit, units */
    OPTION_SLEW,       /* actuator: fastest change, units per second, 0 = no bound */
    OPTION_STUCK, /* stays at this value, whatever is commanded or measured; of a sensor also outside its span */
    OPTION_FREE,       /* 1 = no longer stuck, frozen or dead */
    OPTION_DRIFT,      /* sensor: units per hour from now on; 0 = repaired, what gathered is gone */
    OPTION_FROZEN,     /* sensor: 1 = stays at its present reading */
    OPTION_DEAD,       /* sensor: 1 = reads the lower end of its span and calls it good */
    OPTION_SPIKE,      /* sensor: height of spikes, units, either way */
    OPTION_HUM,        /* sensor: amplitude of a sine, units */
    OPTION_HUM_PERIOD, /* sensor: its period, s */
    OPTION_SPIKE_RATE, /* sensor: spikes an hour, one sample long, at random */
    OPTION_DROPOUT,    /* sensor: part of the samples in which it is missing, 0..1, at random */
    OPTION_NAN,        /* sensor: 1 = sends not-a-number and calls it good */
    OPTION_EVERY, /* sensor: an analyser that shows a new number in every n-th sample; 1 = in each */
    OPTION_PHASE, /* sensor: ... in those of the run whose number leaves this when divided by n */
    OPTION_DELAY, /* sensor: ... taken so many samples before */
    OPTION_STICTION, /* actuator: a smaller change of command does not move it, units */
    OPTION_BACKLASH, /* actuator: play between command and position, units */
    OPTION_GAIN, /* actuator: the plant feels its changes times this, from where it stands; not read back */
    OPTION_READBACK, /* actuator: 1 = true, 0 = none (its flowmeter has failed), 2 = the command */
    OPTION_COUNT
};

#define ANALYSER_EVERY_MAX 10000 /* samples */
#define ANALYSER_DELAY_MAX 100

struct sensor {
    size_t channel;
    double lag_s, bias, noise, resolution;
    double drift, drifted;      /* units per hour, units */
    double spike, spikes_per_h; /* units */
    double hum, hum_period_s;   /* units */
    double age_s;               /* since the run began */
    double dropout;             /* 0..1 */
    double stuck_at;
    bool stuck, frozen, dead, not_a_number;
    int quality;
    unsigned every, phase, delay; /* of an analyser, samples */
    double past[ANALYSER_DELAY_MAX +
                1];              /* what it took, by the number of the sample modulo the size */
    double analysis;             /* what it shows */
    struct noise random, chance; /* chance: spikes and dropouts */
    double filtered;             /* behind the lag */
    double truth;                /* at the last sample */
    double shown;                /* at the last sample, before the span cut it */
    float reading;               /* as sent */
    uint8_t sent_quality;
};

struct actuator {
    size_t channel;
    double lo, hi, slew, lag_s;
    bool stuck;
    double stiction, backlash;
    double gain, pivot,
        pivot_felt;  /* OPTION_GAIN: what the plant feels is pivot_felt + gain (output - pivot) */
    int readback;    /* OPTION_READBACK */
    double command;  /* last one driven */
    double target;   /* what it moves to: the command, the one before, or the end of the play */
    double position; /* behind limits and slew */
    double output;   /* behind the lag as well: what the plant feels */
    double applied;  /* mean of output over the last interval */
};

struct instruments {
    const struct plant_class *class;
    struct sensor sensor[LINK_CHANNELS_MAX];
    struct actuator actuator[LINK_CHANNELS_MAX];
    size_t n_sensors, n_actuators;
    bool begun;          /* a first sample was taken */
    unsigned long taken; /* samples before this one */
};

/* Fails when the plant has more channels than the link carries. */
bool instruments_init(struct instruments *in, const struct plant_class *class, uint64_t seed,
                      double noise_factor, char *err, size_t err_size);

/* Actuators stand where the plant's inputs are: a run that begins elsewhere than at the nominal state. */
void instruments_begin(struct instruments *in, const struct plant *plant);

/* Sensors that the plant says are analysers (every_s, delay_s) show a new value in every n-th sample of a run with this
 * tick, from its first on. False where its times are no whole ticks, or too many. */
bool instruments_analysers(struct instruments *in, double tick_s, char *err, size_t err_size);

/* Sets the noise of all sensors to factor times their own. */
void instruments_noise(struct instruments *in, double factor);

/* Sets one option of one channel, which must be of the right kind (events.c has checked). */
void instruments_set(struct instruments *in, size_t channel, enum instrument_option option,
                     double value);

/* Takes a sample dt_s after the one before: readings and read-backs into *sample. */
void instruments_measure(struct instruments *in, const struct plant *plant, double dt_s,
                         struct link_sample *sample);

/* A command has come; outputs that are not driven keep what they have. */
void instruments_command(struct instruments *in, const struct link_command *command);

/* Silence: all actuators head for their safe values. */
void instruments_safe(struct instruments *in);

/* Moves the actuators over the next dt_s and sets the plant's inputs to the means. */
bool instruments_drive(struct instruments *in, struct plant *plant, double dt_s, char *err,
                       size_t err_size);

#endif

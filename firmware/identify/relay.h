/* A relay experiment on one loop: the ultimate gain and period of a process, from the limit cycle that a relay with
 * hysteresis makes of it (K. J. Astrom and T. Hagglund, Automatica 20 (1984) 645).
 *
 *     start   the input goes to where the output rises, and waits until it has left the hysteresis
 *     cycle   from now on the input goes back whenever the output crosses to the other side of the hysteresis
 *     done    the latest periods agree in the lengths of their halves and in their peaks
 *
 * Until it comes back for the first time the output may go away from where it is asked, because the sign is wrong, or because a
 * load or a drift is stronger. After the patience, and as long again as it took to leave (in a cycle, four times), the input is
 * turned round once: what then comes to the other side, and away again once the input is turned back, has the wrong sign. An
 * inverse response has turned back by itself before.
 *
 * With the amplitude d of the relay, the amplitude a of the output and half of the hysteresis eps, the describing
 * function says (Astrom and Hagglund)
 *
 *     Ku = 4 d / (pi sqrt(a^2 - eps^2)),    Pu = the period
 *
 * which takes the output for a sine: 20 % too low where it is a triangle. So the first harmonics of output and input over
 * the same period are compared as well: their ratio is the sampled process's G at that frequency, whatever the shape, and
 * noise averages out of it:
 *
 *     Ku = -1/Re G, but no more than 1.25/|G|
 *
 * (the second where the hysteresis is most of the cycle: it is then far below the ultimate frequency, and -1/Re G has no
 * bound).
 *
 * A static load, or a drift, makes the halves unequal: the level about which the relay switches is moved by the mean that
 * the input had over the period (C. C. Hang, K. J. Astrom and W. K. Ho, Automatica 29 (1993) 563, on relays under static
 * load), after every period that asks for it.
 *
 * Everything in fractions of span and in samples. */
#ifndef REFLUX_IDENTIFY_RELAY_H
#define REFLUX_IDENTIFY_RELAY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "num/real.h"

#define RELAY_PERIODS 3   /* that agree, and over which the result is taken */
#define RELAY_POINTS  128 /* of a period's output that are kept: samples, or sums of several */

struct relay_config {
    real_t h_s;         /* sample interval, s, [1e-3, 1e5] */
    int8_t sign;        /* of the process's gain: 1 or -1 */
    real_t reference;   /* output at rest */
    real_t noise_sd;    /* of one sample, 0 and up */
    real_t drift;       /* of the output at rest, a sample; 0: none is known */
    real_t hysteresis;  /* half of its width, (0, 1]; three noise deviations or so */
    real_t amplitude;   /* [0, 1]; 0: to be found, up to half of the room */
    real_t first;       /* ... beginning with this, (0, most] */
    real_t most;        /* room of the input to either side, (0, 1]: amplitude and bias together */
    real_t wanted;      /* ... amplitude of the output wanted, (0, 1] */
    uint32_t patience;  /* ... samples without an answer after which it is doubled, from 1 */
    uint32_t half_most; /* samples, no half is longer before a period is known; above patience */
};

enum relay_phase { RELAY_START, RELAY_CYCLE, RELAY_DONE, RELAY_FAILED };

enum relay_failure {
    RELAY_FINE,
    RELAY_NO_ANSWER, /* the output does not leave the hysteresis */
    RELAY_STUCK,     /* it does not come back to the other side */
    RELAY_UNSETTLED, /* no two periods are the same */
    RELAY_WRONG_SIGN /* the output goes away from where it is asked, and back when the input is turned round */
};

struct relay_period {
    uint32_t samples, high; /* whole, and with the input up */
    real_t top, bottom;     /* peaks, from the reference */
    real_t mean;            /* of the output, from the reference */
    uint32_t block;         /* samples in a point */
    real_t y[RELAY_POINTS]; /* sums of the output, from the reference */
    /* y is whole, and neither amplitude nor bias changed. */
    bool whole;
};

struct relay {
    struct relay_config config;
    enum relay_phase phase;
    enum relay_failure failure;
    real_t level;     /* of the test signal from this sample to the next */
    real_t amplitude; /* of the relay */
    real_t bias;      /* level about which it switches */
    bool high;        /* output is asked upwards */
    uint8_t outside;  /* samples in a row out of the hysteresis, while it starts */
    uint8_t same;     /* periods in a row like the one before */
    uint16_t periods; /* since the start */
    uint32_t half;    /* samples in this half */
    uint32_t longest; /* half of the latest period; 0: none yet */
    uint32_t started; /* samples until the output has left the hysteresis */
    real_t share;     /* largest of a limit in this period */
    real_t last;      /* output */
    uint32_t against; /* samples in a row away from where it is asked, until its sign is seen */
    real_t farthest;  /* ... and from the reference */
    uint32_t age;     /* samples since the beginning */
    /* Samples until it came to the other side, the input turned round; 0: not yet. */
    uint32_t came_back;
    bool turned;                               /* the input is turned round, to see its sign */
    bool sign_seen;                            /* ... has been, or the output has come back */
    struct relay_period present;               /* under way */
    struct relay_period period[RELAY_PERIODS]; /* latest last */
};

struct relay_result {
    real_t gain; /* Ku by the first harmonics, input over output; with the sign of the process */
    real_t described; /* ... by the describing function */
    real_t period_s;
    real_t amplitude; /* d */
    real_t peak;      /* a: half of the way between the peaks */
    real_t bias;      /* that the load has asked for, and the mean of the input that is left */
    real_t spread; /* how far the gains of the first and the last two periods are apart, relative */
    uint16_t periods; /* it has taken */
};

/* ERR_RANGE, ERR_NOT_FINITE: of the config, *r then not to be used. */
MUST_CHECK enum err relay_begin(struct relay *r, const struct relay_config *config);

/* One sample of the output, validated. share: the largest share of its limit that any output of the plant is at, 0 where
 * nobody looks; an amplitude that is to be found keeps away from it. Sets r->level. Not to be called once DONE or FAILED
 * (ERR_STATE). ERR_NOT_FINITE: nothing has changed. */
MUST_CHECK enum err relay_step(struct relay *r, real_t y, real_t share);

/* A sample was lost on the way, before the one to come: nothing is decided. ERR_STATE as above, and before the first. */
MUST_CHECK enum err relay_missed(struct relay *r);

/* Once DONE; else ERR_EMPTY. ERR_RANGE: the numbers are no limit cycle's. */
MUST_CHECK enum err relay_look(const struct relay *r, struct relay_result *result);

#endif

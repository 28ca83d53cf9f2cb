/* Is a channel at rest? Slope and variance over a window against the channel's own noise; no timer.
 *
 * The window is STEADY_BLOCKS block means. The noise comes from successive differences, which a slow motion hardly
 * enters: sigma^2 = sum (y_k - y_k-1)^2 / 2n (von Neumann 1941). A line is fitted to the block means. The channel
 *   moves    while the line climbs by more than motion_limit noise standard deviations over the window and that is
 *            significant (3 of the slope's own), or
 *            while the block means stray from the line by more than the noise of a mean explains (variance_limit)
 *   is settled otherwise.
 * A drift slower than the first limit is not a motion; it is reported with its standard deviation so that it can be
 * removed.
 */
#ifndef REFLUX_IDENTIFY_STEADY_H
#define REFLUX_IDENTIFY_STEADY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/channel.h"
#include "base/error.h"
#include "num/real.h"

#define STEADY_BLOCKS 16

struct steady_config {
    uint32_t outputs; /* 1 to CHANNEL_MAX */
    uint32_t block;   /* samples in a block, from 1: the window is STEADY_BLOCKS blocks */
    real_t h_s;       /* s, [1e-3, 1e5] */
    /* Noise standard deviation taken at least, (0, 1e6]: resolution/sqrt(12) or so. */
    real_t noise_floor;
    real_t motion_limit;   /* noise standard deviations over the window, [0.1, 1e3]; 3 */
    real_t variance_limit; /* variance about the line in units of the noise's own, [1, 1e3]; 4 */
};

enum steady_state {
    STEADY_NOT_ENOUGH = 0, /* the window is not full yet */
    STEADY_MOVING = 1,     /* climbs */
    STEADY_RESTLESS = 2,   /* strays from its line: a bend, a disturbance, an oscillation */
    STEADY_SETTLED = 3
};

struct steady_result {
    enum steady_state state;
    real_t mean; /* of the window */
    real_t mean_sd;
    real_t level; /* of the line at the latest whole block's last sample */
    real_t slope_per_s, slope_sd_per_s;
    real_t noise_sd;       /* of one sample, not below the floor */
    real_t variance_ratio; /* about the line: 1 when there is nothing but white noise */
    real_t age_s;          /* from the middle of the window to the latest sample */
};

struct steady {
    struct steady_config config;
    uint32_t blocks;  /* whole ones seen; the ring holds the last STEADY_BLOCKS */
    uint32_t waiting; /* samples in the block that is open */
    bool started;
    struct {
        real_t reference; /* first sample: everything else is a deviation from it */
        real_t last, sum, square;
        real_t mean[STEADY_BLOCKS];
        real_t difference[STEADY_BLOCKS]; /* sums of squared successive differences */
    } output[CHANNEL_MAX];
};

/* ERR_RANGE, ERR_NOT_FINITE: *s unchanged. */
MUST_CHECK enum err steady_init(struct steady *s, const struct steady_config *config);

/* Forgets everything seen. */
void steady_reset(struct steady *s);

/* One sample of every output. ERR_NOT_FINITE, ERR_RANGE (more than 1e12 from the first): *s unchanged. */
MUST_CHECK enum err steady_step(struct steady *s, const real_t *y);

/* ERR_RANGE: no such output. With NOT_ENOUGH all numbers but noise_sd are 0. */
MUST_CHECK enum err steady_look(const struct steady *s, uint32_t output,
                                struct steady_result *result);

/* Distance of a measurement from rest: `away` from where it was then, or from the line of a drift that would have carried it by
 * `carried` since (at most by `most` either way), whichever is nearer. A drift that goes on is no response; one that turns
 * carries it back to where it was. All in one unit. */
real_t steady_away(real_t away, real_t carried, real_t most);
/* Distance of a measurement from where a drift that turns at any time may have carried it: by |carried| either way, at most by `most`.
 * 0 within. */
real_t steady_beyond(real_t away, real_t carried, real_t most);

#endif

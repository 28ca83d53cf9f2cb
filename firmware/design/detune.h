/* PI or PID settings for loops that disturb each other: docs/tuning.md.
 *
 * Every loop begins with SIMC (Skogestad 2003) on its own element, the others open. Then all are slowed by one factor F:
 *     tau_c = F max(theta, T/8)
 * until the loops together have the distance from instability that Luyben asks of multiloop systems: log modulus at most
 * db_per_loop n (Luyben 1986, there with Ziegler-Nichols settings and K/F, F Ti), found by bisection. theta includes
 * half a sample interval. A loop whose gain rises when the others close (0 < lambda < 1) begins with its equivalent
 * transfer function (He et al. 2009). */
#ifndef REFLUX_DESIGN_DETUNE_H
#define REFLUX_DESIGN_DETUNE_H

#include "design/nyquist.h"
#include "interact/measure.h"

struct detune_config {
    real_t db_per_loop;       /* 0.1 to 20 dB; Luyben: 2 */
    real_t factor_hi;         /* slowest that is tried: F up to this, 1 to 1e4 */
    real_t gain_hi;           /* largest controller gain allowed, 1e-6 to 1e6 */
    real_t derivative_filter; /* 1 to 100 */
};

struct detune {
    /* Results */
    struct loops loops; /* settings; what it was given otherwise */
    real_t factor;      /* F */
    real_t log_modulus_db, omega;
    uint8_t tried;

    /* Work */
    const struct interact_plant *plant;
    struct detune_config config;
    struct fopdt model[INTERACT_MAX]; /* what each loop is designed on */
    real_t lo, hi;
    uint8_t stage;
    union {
        struct nyquist nyquist;
        struct {
            struct measure_work work;
            struct measure measure;
        };
    };
};

/* 2 dB, 100, 100, 8. */
void detune_config_default(struct detune_config *config);

/* pairs; interval_s above 0; decoupler NULL, or loops are designed on G D. ERR_RANGE also for a pair of no gain. Then
 * detune_step until it is not ERR_BUSY, about 12 times as many as a nyquist; ERR_TIMEOUT from it: even factor_hi does not
 * bring the distance wanted, settings are those of factor_hi. */
MUST_CHECK enum err detune_begin(struct detune *d, const struct interact_plant *plant,
                                 const struct pairs *pairs, real_t interval_s,
                                 const struct matrix *decoupler, const struct detune_config *config,
                                 struct interact_refusal *why);
MUST_CHECK enum err detune_step(struct detune *d);

#endif

/* The firmware's own analysis and design, in double, for the host tools: flat arrays in, flat arrays out, so that any
 * language can call it. tools/reflux/libreflux.py is the Python side.
 *
 * Rules
 *  1. Matrices are row by row, p x m: element (output i, input j) is a[i * m + j]. p and m are 1 to 16.
 *  2. A plant is four such matrices: gains, dead times, time constants (s), standard deviations of the gains.
 *  3. Every function returns 0 or an error code of firmware/base/error.h; reflux_error_text() says it in words. Where a
 *     function has `reason`, it gets the field and what was wanted of it (REFLUX_WHY_BYTES, may be NULL).
 *  4. Nothing is kept between calls; long computations run to their end. */
#ifndef REFLUX_LIBREFLUX_H
#define REFLUX_LIBREFLUX_H

#include <stdint.h>

#define REFLUX_WHY_BYTES 200

struct reflux_plant {
    int32_t outputs, inputs;
    const double *gain, *dead_time_s, *time_constant_s, *gain_sd;
};

struct reflux_loops {
    int32_t n;
    const int32_t *output, *input;
    /* gain with the action's sign: positive for a positive process gain */
    const double *gain, *ti_s;
    double interval_s;
    const double *decoupler; /* n x n, or NULL */
};

const char *reflux_error_text(int32_t error);

/* lambda: p x m */
int32_t reflux_rga(const struct reflux_plant *plant, double *lambda);
/* modulus and real part, n_omega tables of p x m one after the other */
int32_t reflux_rga_at(const struct reflux_plant *plant, int32_t n_omega, const double *omega,
                      double *modulus, double *real_part);

/* numbers: condition, condition scaled, rank, exact rank, smallest singular value in standard deviations.
 * null_inputs: (m - rank) rows of m; null_outputs: (p - rank) rows of p; room for 16 rows each. */
int32_t reflux_gains(const struct reflux_plant *plant, double floor, double *singular,
                     double *numbers, double *null_inputs, double *null_outputs);

/* settings: smallest lambda, floor, confidence, draws, seed, outputs left out, inputs left out (bits).
 * n pairs, their outputs, inputs and relative gains. numbers: verdict, Niederlinski index, cost, probability.
 * By output: share and rival (16: left out, 255: none). */
int32_t reflux_pairing(const struct reflux_plant *plant, const double *settings, int32_t *n,
                       int32_t *output, int32_t *input, double *lambda, double *numbers,
                       double *share, int32_t *rival, char *reason);
void reflux_pairing_defaults(double *settings);

/* Square tables in the order of the pairs: relative gains, RNGA, RARTA. */
int32_t reflux_measure(const struct reflux_plant *plant, int32_t n, const int32_t *output,
                       const int32_t *input, double shortest_s, double *lambda, double *phi,
                       double *gamma);

/* effect, uncertain: p x m of 0 and 1. part: by output. block: by pair, blocks in order. mimo: by pair. worst: by block. */
int32_t reflux_structure(const struct reflux_plant *plant, int32_t n, const int32_t *output,
                         const int32_t *input, int32_t *effect, int32_t *uncertain, int32_t *part,
                         int32_t *block, int32_t *mimo, double *worst);

/* found cascades; of each inner, outer (outputs), and gain, dead time, time constant, misfit */
int32_t reflux_cascades(const struct reflux_plant *plant, int32_t *found, int32_t *which,
                        double *between);

/* settings: dB per loop, dB at most, gain margin, F at most, gain at most. numbers: F, log modulus dB, omega, tried.
 * gain: with the action's sign. ERR_TIMEOUT still fills in everything. */
int32_t reflux_detune(const struct reflux_plant *plant, int32_t n, const int32_t *output,
                      const int32_t *input, double interval_s, const double *decoupler,
                      const double *settings, double *gain, double *ti_s, double *numbers,
                      char *reason);
void reflux_detune_defaults(double *settings);

/* numbers: stable (1), log modulus dB, omega, frequencies used */
int32_t reflux_nyquist(const struct reflux_plant *plant, const struct reflux_loops *loops,
                       double gain_times, double *numbers);
/* The sampled open loop G(z) D C(z) at omega, at most pi/interval: n x n, re and im alternating. */
int32_t reflux_open_loop(const struct reflux_plant *plant, const struct reflux_loops *loops,
                         double omega, double *open);

/* settings: loop, load (1), size, duration, setpoint weight. rows: room for them; filled with time and the n outputs,
 * every fourth sample, *n_rows how many. numbers by loop: IAE, peak, settled, moved; then bounded, coarse, sample. */
int32_t reflux_trial(const struct reflux_plant *plant, const struct reflux_loops *loops,
                     const double *settings, int32_t room, double *rows, int32_t *n_rows,
                     double *numbers);

/* settings: largest element, largest lambda, significance, floor, largest left_sd. by loop: gain, its deviation. left: see
 * static_decoupler.h */
int32_t reflux_decoupler(const struct reflux_plant *plant, int32_t n, const int32_t *output,
                         const int32_t *input, const double *settings, double *d, double *gain,
                         double *gain_sd, double *left, char *reason);
void reflux_decoupler_defaults(double *settings);

#endif

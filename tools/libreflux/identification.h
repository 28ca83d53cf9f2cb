/* Part of libreflux.h: identification of difference models (firmware/identify/prbs.h, arx.h, arx_fit.h,
 * arx_select.h, decimate.h).
 * The rules of libreflux.h hold; outputs and inputs are 1 to 4.
 *
 * Orders of a model of one output are 3 + 2 (inputs) whole numbers: na, nc, 1 or 0 for a constant, then of every input the
 * first and the last power of z^-1, 0 and 0 where it has no part. Parameters stand in the order of firmware/identify/arx.h. */
#ifndef REFLUX_LIBREFLUX_IDENTIFICATION_H
#define REFLUX_LIBREFLUX_IDENTIFICATION_H

#include <stdint.h>

struct reflux_record {
    int32_t samples, outputs, inputs;
    const double *u, *y; /* samples x inputs, samples x outputs; u acts from its sample on */
};

#define REFLUX_TRIALS     300
#define REFLUX_PARAMETERS 41

/* settings: bits, independence (0 shifts, 1 registers), clock. u: samples x inputs. period, memory: samples. */
int32_t reflux_prbs(int32_t inputs, const int32_t *settings, const double *amplitude,
                    int32_t samples, double *u, int32_t *period, int32_t *memory, char *reason);

/* Keeps one in ratio of x [samples], filtered (firmware/identify/decimate.h); kept: room for (samples + ratio - 1)/ratio. */
int32_t reflux_decimate(int32_t ratio, double cutoff, int32_t samples, const double *x,
                        double *kept);

/* limits: na, nb, constant, criterion (0 BIC, 1 AICc). range: first sample and the one behind the last. n trials, each with its
 * orders and four numbers: parameters, sum of squares, criterion, whether it could be told from the record. room for
 * REFLUX_TRIALS. */
int32_t reflux_arx_select(const struct reflux_record *record, int32_t output, const int32_t *limits,
                          const int32_t *range, int32_t *n, int32_t *orders, double *numbers,
                          int32_t *best, int32_t *rows);

/* method: 0 least squares, 1 instrumental variables, 2 extended least squares. theta, sd: room for REFLUX_PARAMETERS.
 * numbers: parameters, variance, rows, passes, settled. */
int32_t reflux_arx_fit(const struct reflux_record *record, int32_t output, const int32_t *orders,
                       int32_t method, const int32_t *range, double *theta, double *sd,
                       double *numbers, char *reason);

/* numbers: rows, mean squares one sample ahead, simulated, and of y about its mean. */
int32_t reflux_arx_judge(const struct reflux_record *record, int32_t output, const int32_t *orders,
                         const double *theta, const int32_t *range, double *numbers);

#endif

/* The model of an output (identify/arx.h) by one of three methods, which differ in what noise may be:
 *
 *   ARX_LS   least squares: unbiased only where e is white, which noise of a measurement is not
 *   ARX_IV   instrumental variables, outputs that the model of the pass before gives without noise: unbiased with any noise
 *            that is independent of u (P. C. Young 1970; T. Soderstrom and P. Stoica, System Identification (1989), ch. 8)
 *   ARX_ELS  extended least squares: C is estimated with the rest, e from the pass before (Panuska 1968; Soderstrom and
 *            Stoica 7.4 and 9.5). Unbiased where 1/C - 1/2 is positive real. Each pass goes half the way, which also
 *            settles where all of it would not; what has not settled after 100 says so (settled) */
#ifndef REFLUX_IDENTIFY_ARX_FIT_H
#define REFLUX_IDENTIFY_ARX_FIT_H

#include "identify/arx.h"

/* In the order of words for it. */
enum arx_method { ARX_LS, ARX_IV, ARX_ELS };
#define ARX_METHOD_WORDS "ls|iv|els"

/* The model of an output from samples from .. to - 1 of the record; the first arx_before() of them begin the history.
 * data and orders are ones that the checks accept. ERR_EMPTY: fewer than two rows more than parameters. ERR_SINGULAR:
 * the record does not tell the parameters apart: input at rest, inputs that move together, orders too high for data without
 * noise. ERR_STATE: a pass of ARX_IV or ARX_ELS found an unstable model. On error *fit is undefined. */
MUST_CHECK enum err arx_fit(const struct arx_data *data, uint8_t output,
                            const struct arx_orders *orders, enum arx_method method, uint32_t from,
                            uint32_t to, struct arx_work *work, struct arx_fit *fit);

/* The same in pieces: data, work and fit live on until it is over. Within, but for err. */
struct arx_fitting {
    struct arx_collecting rows; /* of least squares; data, output, from, to and k of all */
    struct arx_history clean;   /* instruments */
    struct arx_orders with;     /* els: those of fit, and C */
    struct arx_fit *fit;
    real_t before[ARX_MOST], mean;
    uint8_t method, stage; /* enum arx_method */
    enum err err;          /* once it is over: as arx_fit */
};
void arx_fit_begin(struct arx_fitting *f, const struct arx_data *data, uint8_t output,
                   const struct arx_orders *orders, enum arx_method method, uint32_t from,
                   uint32_t to, struct arx_work *work, struct arx_fit *fit);
/* Up to `most` samples of a pass, or what comes at its end: some n^3 operations for n parameters. True while there is more. */
bool arx_fit_piece(struct arx_fitting *f, uint32_t most);

#endif

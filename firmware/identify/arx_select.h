/* Orders of the model of an output: all of a grid, then leading and trailing coefficients of each input dropped while that
 * lowers an information criterion. All of it from one triangle of the largest model, so all are judged on the same rows.
 *
 * With N rows, p parameters and the sum S of squared errors:
 *     BIC   N ln(S/N) + p ln N                          G. Schwarz, Ann. Statist. 6 (1978) 461
 *     AICc  N ln(S/N) + 2 p + 2 p (p + 1)/(N - p - 1)   C. M. Hurvich and C.-L. Tsai, Biometrika 76 (1989) 297
 * S is not taken to be less than rounding in the triangle may leave, N (columns) REAL_EPSILON^2 sum y^2. So of data without
 * noise the smallest of the
 * models that are exact wins. Criteria compare least squares; the other methods take the orders they find. */
#ifndef REFLUX_IDENTIFY_ARX_SELECT_H
#define REFLUX_IDENTIFY_ARX_SELECT_H

#include "identify/arx.h"

/* In the order of words for it. */
enum arx_criterion { ARX_BIC, ARX_AICC };
#define ARX_CRITERION_WORDS "bic|aicc"

#define ARX_TRIALS 300 /* more are never tried */

struct arx_trial {
    struct arx_orders orders;
    uint8_t parameters;
    enum err err; /* ERR_OK, or ERR_SINGULAR: not among those that are compared */
    real_t squares, criterion;
};

struct arx_search {
    struct arx_work work;
    struct triangle lower;
    real_t cells[(ARX_MOST + 1) * (ARX_MOST + 2) / 2];
    struct arx_fit fit;
    struct arx_trial trial[ARX_TRIALS];
    uint16_t trials, best; /* best: an index, ERR_OK */
    uint32_t rows;
    real_t of_y; /* sum of y squared */
};

/* Tries orders up to na and nb (of every input, from z^-1 on; constant: with one in each) on samples from .. to - 1.
 * na to DIFFERENCE_A_MOST, nb 1 to DIFFERENCE_B_MOST. data is one that arx_check accepts. search->best is what to take.
 * ERR_RANGE; ERR_EMPTY: too few samples for the largest; ERR_SINGULAR: none of them can be told from the record. */
MUST_CHECK enum err arx_select(const struct arx_data *data, uint8_t output, uint8_t na, uint8_t nb,
                               bool constant, enum arx_criterion criterion, uint32_t from,
                               uint32_t to, struct arx_search *search);

/* The same in pieces: data and search live on until it is over. Within, but for err. */
struct arx_searching {
    struct arx_collecting rows; /* its orders are the largest */
    struct arx_search *search;
    struct arx_orders from; /* what a round of dropping began with */
    /* The trial of the grid, or of a round, that is next. */
    uint16_t next;
    uint16_t best;
    uint8_t nb, criterion; /* enum arx_criterion */
    uint8_t stage, round;
    enum err err; /* once it is over: as arx_select */
};
void arx_select_begin(struct arx_searching *s, const struct arx_data *data, uint8_t output,
                      uint8_t na, uint8_t nb, bool constant, enum arx_criterion criterion,
                      uint32_t from, uint32_t to, struct arx_search *search);
/* Up to `most` samples, or one trial. True while there is more. */
bool arx_select_piece(struct arx_searching *s, uint32_t most);

#endif

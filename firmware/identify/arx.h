/* Difference models from a record: of every output on its own
 *
 *     A_ii(z^-1) y_i(k) = sum_j B_ij(z^-1) u_j(k) + C_i(z^-1) e(k) + constant
 *
 * so that A is diagonal (Kotyk and Machacek 1995, section 2). It is linear in what is sought:
 *
 *     y(k) = phi(k)'theta + e(k)    phi = (-y(k-1) .. -y(k-na), u_1(k-first) .. u_1(k-last), u_2 .., e(k-1) .. e(k-nc), 1)
 *
 * The same phi with rls_step (identify/rls.h) is the recursive form. u(k) acts from sample k on, as in lti/difference_model.h.
 * Values are best deviations from a level near their own; `constant` takes up what is left of it. */
#ifndef REFLUX_IDENTIFY_ARX_H
#define REFLUX_IDENTIFY_ARX_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "identify/triangle.h"
#include "lti/difference_model.h"

#define ARX_C_MOST 4
#define ARX_MOST   (DIFFERENCE_A_MOST + DIFFERENCE_MOST * DIFFERENCE_B_MOST + ARX_C_MOST + 1)

struct arx_data {
    uint32_t samples;        /* to 2^31 */
    uint8_t outputs, inputs; /* 1 to DIFFERENCE_MOST */
    const real_t *u;         /* [samples][inputs] */
    const real_t *y;         /* [samples][outputs], magnitudes to 1e12 */
};

/* Orders for one output. */
struct arx_orders {
    uint8_t na;                     /* 0 to DIFFERENCE_A_MOST */
    uint8_t first[DIFFERENCE_MOST]; /* of B_ij, powers of z^-1, 1 <= first <= last <= 8 ... */
    uint8_t last[DIFFERENCE_MOST];  /* ... or 0: the input has no part in it */
    uint8_t nc;                     /* 0 to ARX_C_MOST; of least squares and instruments: 0 */
    bool constant;
};

/* The past, newest first. */
struct arx_history {
    real_t y[DIFFERENCE_A_MOST];
    real_t u[DIFFERENCE_MOST][DIFFERENCE_B_MOST];
    real_t e[ARX_C_MOST];
};

struct arx_fit {
    struct arx_orders orders;
    real_t theta[ARX_MOST];
    real_t sd[ARX_MOST]; /* standard deviations of theta, where e is white */
    real_t variance;     /* of e, over rows - parameters */
    real_t squares;      /* sum of e squared */
    uint32_t rows;       /* that were used */
    uint8_t passes;      /* over the record, of methods that need more than one */
    bool settled;        /* the last pass changed theta by less than a thousandth of its sd */
};

/* 17 KiB in float: the caller's. */
struct arx_work {
    struct triangle triangle;
    real_t cells[3 * ARX_MOST * (ARX_MOST + 1) / 2];
    real_t square[ARX_MOST][ARX_MOST + 1];
};

/* Sizes of data and that all samples are finite, magnitudes to 1e12. ERR_RANGE, ERR_NOT_FINITE. */
MUST_CHECK enum err arx_check(const struct arx_data *data);

/* Orders for so many inputs. *field, *wanted as elsewhere; either may be NULL. */
MUST_CHECK enum err arx_orders_check(const struct arx_orders *orders, uint8_t inputs,
                                     const char **field, const char **wanted);

/* Parameters, and samples before a row can be made of the record. */
size_t arx_parameters(const struct arx_orders *orders, uint8_t inputs);
size_t arx_before(const struct arx_orders *orders, uint8_t inputs);

/* phi [arx_parameters()]. */
void arx_regressor(const struct arx_orders *orders, uint8_t inputs,
                   const struct arx_history *history, real_t *phi);
/* On by a sample: y and e of it, u [inputs] that acts from it on. */
void arx_push(struct arx_history *history, uint8_t inputs, real_t y, const real_t *u, real_t e);

/* phi'theta */
static inline real_t arx_sum(const real_t *phi, const real_t *theta, size_t n)
{
    real_t sum = REAL_C(0.0);
    for (size_t i = 0; i < n; i++)
        sum += phi[i] * theta[i];
    return sum;
}

/* Rows of a record in the columns of orders and y: the triangle from which models of lower orders follow. skip: samples at
 * the beginning of the range that only begin the history, arx_before() or more. nc is 0. */
struct arx_collecting {
    const struct arx_data *data;
    struct arx_orders orders;
    struct arx_history history;
    struct arx_work *work;
    uint32_t from, to, skip, k, rows;
    uint8_t output;
};
/* In pieces, for a processor that has other things to do; all of it lives on meanwhile. arx_collect_piece takes up to `most`
 * samples and is true while there are more. */
MUST_CHECK enum err arx_collect_begin(struct arx_collecting *c, const struct arx_data *data,
                                      uint8_t output, const struct arx_orders *orders,
                                      uint32_t from, uint32_t to, uint32_t skip,
                                      struct arx_work *work);
bool arx_collect_piece(struct arx_collecting *c, uint32_t most);
/* All of it at once. */
MUST_CHECK enum err arx_collect(const struct arx_data *data, uint8_t output,
                                const struct arx_orders *orders, uint32_t from, uint32_t to,
                                uint32_t skip, struct arx_work *work, uint32_t *rows);

/* theta and all else of *fit from a triangle of the columns of fit->orders and y, of fit->rows rows. */
MUST_CHECK enum err arx_take(const struct triangle *triangle, struct arx_fit *fit);

/* Quality of a model on samples from .. to - 1, the first arx_before() of which begin the history. */
struct arx_judgement {
    uint32_t rows;
    real_t step_squares;      /* mean square of the error one sample ahead */
    real_t simulated_squares; /* of y less the output of the model with u alone */
    real_t squares;           /* of y about its mean */
};
struct arx_judging {
    const struct arx_data *data;
    const struct arx_fit *fit;
    struct arx_history history, simulated;
    real_t mean, step, alone, about, rows;
    uint32_t from, to, k;
    uint8_t output;
};
/* In pieces; arx_judge_take once arx_judge_piece is false. */
MUST_CHECK enum err arx_judge_begin(struct arx_judging *j, const struct arx_data *data,
                                    uint8_t output, const struct arx_fit *fit, uint32_t from,
                                    uint32_t to);
bool arx_judge_piece(struct arx_judging *j, uint32_t most);
void arx_judge_take(const struct arx_judging *j, struct arx_judgement *judgement);
/* ERR_EMPTY: no row. Simulated errors beyond 1e12 end up as infinity. */
MUST_CHECK enum err arx_judge(const struct arx_data *data, uint8_t output,
                              const struct arx_fit *fit, uint32_t from, uint32_t to,
                              struct arx_judgement *judgement);

/* A model of the fits of all outputs. period_s is set as told. */
void arx_model(const struct arx_fit *fits, uint8_t outputs, uint8_t inputs, real_t period_s,
               struct difference_model *model);

#endif

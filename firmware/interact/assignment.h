/* Optimal assignment of rows to columns, and the first of equals. */
#ifndef REFLUX_INTERACT_ASSIGNMENT_H
#define REFLUX_INTERACT_ASSIGNMENT_H

#include <stdint.h>

#include "base/error.h"
#include "interact/double_symbols.h"
#include "interact/plant.h"

#define ASSIGNMENT_COST_MAX  1000000 /* of one element */
#define ASSIGNMENT_FORBIDDEN 100000000
#define ASSIGNMENT_COST_UNIT REAL_C(1e4) /* of |ln lambda| */

/* Whole numbers, so that equal is equal and the result the same on every machine. */
struct assignment {
    uint8_t rows, cols; /* 1 to INTERACT_MAX */
    /* 0 to ASSIGNMENT_COST_MAX, or ASSIGNMENT_FORBIDDEN */
    int32_t cost[INTERACT_MAX][INTERACT_MAX];
};

/* Least total cost of giving every row of its own a column (every column a row where there are fewer columns):
 * shortest augmenting paths, R. Jonker and A. Volgenant, Computing 38 (1987) 325, O(n^3), at most 1e5 instructions.
 * Among equals the one whose column of row 0 is first, then of row 1, and so on; a row without a column counts last.
 * partner[row] = column or INTERACT_NONE. ERR_EMPTY: every assignment needs a forbidden element. */
MUST_CHECK enum err assignment_solve(const struct assignment *a, uint8_t *partner, int32_t *total);

/* Costs of pairs by their relative gains: |ln lambda|, for 0.5 is as far from 1 as 2; forbidden below smallest_lambda, and where
 * bit i of apart[j] is set for output j and input i. Row k is channels->output[k], column l channels->input[l], of as many each. */
void assignment_by_relative_gains(const struct matrix *lambda, const struct pairs *channels,
                                  const uint16_t *apart, real_t smallest_lambda,
                                  struct assignment *a);

#endif

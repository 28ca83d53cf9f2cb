/* The curved part of a response, of an output that answers up and down differently: beside the linear formulas what a lag with
 * terms of second order adds to its response. With m the linear response to the input u these are m^2, the lag of m^2 and that of u^2: a gain
 * and a time that depend on the output, and on the input. Their amounts are linear, so they are taken out of y and of all
 * columns as the line is. The gain then is the slope at the operating point. */
#ifndef REFLUX_IDENTIFY_SHAPE_CURVE_H
#define REFLUX_IDENTIFY_SHAPE_CURVE_H

#include "identify/shape_fit_state.h"

/* Finds which of the terms the record asks for, bit k for term k: only where it has levels both ways and shows the end of the response, and each only where it explains
 * more of what the best formula leaves than an information criterion asks of one parameter. basis: indices
 * of the `count` orthogonal columns of f->formula, right after shape_search_slopes() at its best place. One evaluation. */
uint8_t shape_curve_terms(struct shape_fit *f, const uint8_t *basis, uint32_t count);

/* Places these terms by f->one, and takes them out of y in place of those before. One evaluation. */
void shape_curve_place(struct shape_fit *f, uint8_t terms);

/* Takes what is placed out of a column without the line. */
void shape_curve_take_out(const struct shape_fit *f, real_t *column);

static inline bool shape_curve_is_on(const struct shape_fit *f)
{
    return f->curve_terms != 0;
}

#endif

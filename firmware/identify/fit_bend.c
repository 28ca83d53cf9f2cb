#include "identify/fit_bend.h"

#include <stddef.h>

#include "identify/common.h"

#define LENGTH_MIN REAL_C(1e-3) /* of what the line leaves: less is rounding */
#define NONE       REAL_C(1e30)

/* The second line, or the step: 0 before point at. */
static void begins_at(const struct fit_line *l, uint32_t at, bool step, real_t *column)
{
    for (uint32_t i = 0; i < l->points; i++) {
        real_t since = (real_t)i + REAL_C(0.5) - (real_t)at;
        real_t risen = step ? ONE : since / (real_t)l->points;
        column[i] = since > ZERO ? risen : ZERO;
    }
    for (uint32_t k = 0; k < FIT_LINE_ROWS; k++)
        column[l->points + k] = ZERO;
}

static bool scale_to_one(const struct fit_line *l, real_t *column, real_t *length)
{
    *length = real_sqrt(fit_line_dot(l, column, column));
    if (!(*length > LENGTH_MIN))
        return false;
    for (uint32_t i = 0; i < l->points + FIT_LINE_ROWS; i++)
        column[i] /= *length;
    return true;
}

/* part = column . basis; taken off. */
static real_t remove_one(const struct fit_line *l, const real_t *basis, real_t *column)
{
    real_t part = fit_line_dot(l, basis, column);
    for (uint32_t i = 0; i < l->points + FIT_LINE_ROWS; i++)
        column[i] -= part * basis[i];
    return part;
}

void fit_bend_place(struct fit_bend *b, const struct fit_line *l, uint32_t at)
{
    b->point = at;
    b->used = 0;
    b->shared = ZERO;
    for (uint8_t k = 0; k < 2 && b->used == k; k++) {
        begins_at(l, at, k == 1, b->basis[k]);
        fit_line_remove(l, b->basis[k], &b->offset[k], &b->slope[k]);
        if (k == 1)
            b->shared = remove_one(l, b->basis[0], b->basis[1]);
        if (scale_to_one(l, b->basis[k], &b->length[k]))
            b->used++;
    }
    b->on = b->used > 0;
}

void fit_bend_remove(const struct fit_bend *b, const struct fit_line *l, real_t *column,
                     real_t *part)
{
    for (uint8_t k = 0; k < 2; k++) {
        real_t of = b->on && k < b->used ? remove_one(l, b->basis[k], column) : ZERO;
        if (part)
            part[k] = of;
    }
}

void fit_bend_take_out(const struct fit_bend *b, const struct fit_line *l, real_t *column)
{
    fit_line_remove(l, column, NULL, NULL);
    fit_bend_remove(b, l, column, NULL);
}

void fit_bend_explain(const struct fit_bend *b, const real_t *part, real_t *slope_change,
                      real_t *step, real_t *offset, real_t *slope)
{
    *slope_change = *step = *offset = *slope = ZERO;
    if (!b->on)
        return;
    if (b->used > 1)
        *step = part[1] / b->length[1];
    *slope_change = (part[0] - b->shared * *step) / b->length[0];
    *offset = -*slope_change * b->offset[0];
    *slope = -*slope_change * b->slope[0];
    if (b->used > 1) {
        *offset -= *step * b->offset[1];
        *slope -= *step * b->slope[1];
    }
}

real_t fit_bend_squares(const struct fit_line *l, uint32_t at, const real_t *y, const real_t *model,
                        real_t *scratch)
{
    real_t length;
    begins_at(l, at, false, scratch);
    fit_line_remove(l, scratch, NULL, NULL);
    if (!scale_to_one(l, scratch, &length))
        return NONE;
    real_t of_y = fit_line_dot(l, scratch, y), of_model = fit_line_dot(l, scratch, model);
    real_t squares = fit_line_dot(l, y, y) - of_y * of_y;
    real_t strength = fit_line_dot(l, model, model) - of_model * of_model;
    real_t both = fit_line_dot(l, y, model) - of_y * of_model;
    return strength > ZERO ? squares - both * both / strength : squares;
}

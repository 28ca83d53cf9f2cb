#include "identify/disturbance_ratio.h"

#include "identify/common.h"
#include "num/real_trig.h"

#define TINY REAL_C(1e-30) /* of a square */

static bool is_zero(struct cplx a)
{
    return !(cplx_square(a) > TINY);
}

void loop_response_of_pi(struct loop_response *l, real_t gain, real_t ti_s, real_t b, bool late,
                         real_t h_s, real_t omega_h)
{
    real_t sine, cosine;
    struct cplx q = cplx(ZERO, ZERO);
    real_sincos(omega_h / TWO, &sine, &cosine);
    /* 1/(1 - z^-1) = 1/2 - i/2 cot(omega_h/2), and 1 less with z^-1 above: no difference of two that are alike */
    if (ti_s > ZERO)
        q = cplx_scale(cplx(late ? -ONE / TWO : ONE / TWO, -cosine / (TWO * sine)), h_s / ti_s);
    l->controller = cplx_scale(cplx(ONE + q.re, q.im), gain);
    l->reference = cplx_scale(cplx(b + q.re, q.im), gain);
    l->feedforward = cplx(ZERO, ZERO);
}

/* a/b with what both lack. */
static void divide(const struct high_order_point *a, const struct high_order_point *b,
                   struct high_order_point *c)
{
    real_t size = cplx_abs(b->value);
    c->value = cplx_div(a->value, b->value);
    real_t of_b = b->sd * cplx_abs(c->value);
    c->sd = real_sqrt(a->sd * a->sd + of_b * of_b) / size;
}

static void times(struct high_order_point *p, struct cplx factor)
{
    p->value = cplx_mul(p->value, factor);
    p->sd *= cplx_abs(factor);
}

enum err ratio_from_process(const struct high_order_point *process,
                            const struct high_order_point *sensitivity,
                            const struct loop_response *loop, struct high_order_point *ratio)
{
    if (is_zero(process->value))
        return ERR_SINGULAR;
    /* Sd (1/Gp + C): of Gp only the first part depends. */
    struct high_order_point open;
    divide(sensitivity, process, &open);
    struct cplx whole = cplx_add(cplx_div(cplx(ONE, ZERO), process->value), loop->controller);
    real_t of_process = cplx_abs(open.value) * process->sd / cplx_abs(process->value);
    real_t of_sensitivity = sensitivity->sd * cplx_abs(whole);
    ratio->value = cplx_sub(cplx_mul(sensitivity->value, whole), loop->feedforward);
    ratio->sd = real_sqrt(of_process * of_process + of_sensitivity * of_sensitivity);
    return ERR_OK;
}

enum err ratio_from_tracking(const struct high_order_point *tracking,
                             const struct high_order_point *sensitivity,
                             const struct loop_response *loop, struct high_order_point *ratio)
{
    if (is_zero(tracking->value))
        return ERR_SINGULAR;
    divide(sensitivity, tracking, ratio);
    times(ratio, loop->reference);
    ratio->value = cplx_sub(ratio->value, loop->feedforward);
    return ERR_OK;
}

enum err ratio_from_input(const struct high_order_point *tracking,
                          const struct high_order_point *input_by_disturbance,
                          const struct loop_response *loop, struct high_order_point *ratio)
{
    if (is_zero(tracking->value) || is_zero(loop->controller))
        return ERR_SINGULAR;
    divide(input_by_disturbance, tracking, ratio);
    times(ratio, cplx_scale(cplx_div(loop->reference, loop->controller), -ONE));
    ratio->value = cplx_sub(ratio->value, loop->feedforward);
    return ERR_OK;
}

enum err process_from_tracking(const struct high_order_point *tracking,
                               const struct loop_response *loop, struct high_order_point *process)
{
    struct cplx rest = cplx_sub(loop->reference, cplx_mul(tracking->value, loop->controller));
    if (is_zero(rest))
        return ERR_SINGULAR;
    process->value = cplx_div(tracking->value, rest);
    /* dGp/dT = Cr/(Cr - T C)^2 */
    process->sd = tracking->sd * cplx_abs(loop->reference) / cplx_square(rest);
    return ERR_OK;
}

enum err sensitivity_from_ratio(const struct high_order_point *process,
                                const struct high_order_point *ratio,
                                const struct loop_response *loop,
                                struct high_order_point *sensitivity)
{
    struct cplx open = cplx_mul(process->value, loop->controller);
    open.re += ONE;
    if (is_zero(open))
        return ERR_SINGULAR;
    struct cplx closed = cplx_div(process->value, open);
    /* d(Gp/(1 + Gp C))/dGp = 1/(1 + Gp C)^2 */
    real_t of_process = process->sd / cplx_square(open) * cplx_abs(ratio->value);
    real_t of_ratio = ratio->sd * cplx_abs(closed);
    sensitivity->value = cplx_mul(closed, ratio->value);
    sensitivity->sd = real_sqrt(of_process * of_process + of_ratio * of_ratio);
    return ERR_OK;
}

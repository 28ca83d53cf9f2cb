#include "identify/shape_response.h"

#include <stddef.h>

#include "base/assertion.h"
#include "identify/common.h"
#include "num/real_trig.h"

#define FASTEST REAL_C(1e3) /* rate of a lag that no sample shows */

struct complex_pair {
    real_t re, im;
};

static struct complex_pair complex_product(struct complex_pair a, struct complex_pair b)
{
    return (struct complex_pair){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

static struct complex_pair complex_quotient(struct complex_pair a, struct complex_pair b)
{
    real_t size = b.re * b.re + b.im * b.im;
    return (struct complex_pair){(a.re * b.re + a.im * b.im) / size,
                                 (a.im * b.re - a.re * b.im) / size};
}

static void real_mode(struct shape_mode *m, real_t lag, real_t step, real_t change)
{
    *m = (struct shape_mode){
        .rate = lag > ONE / FASTEST ? ONE / lag : FASTEST, .step_re = step, .change_re = change};
}

void shape_modes_find(real_t lag, real_t square, struct shape_modes *m)
{
    if (!(square > REAL_C(1e-6) * lag * lag)) {
        m->count = 1;
        real_mode(&m->mode[0], lag, ONE, ZERO);
        m->mode[0].change_re = -m->mode[0].rate;
        return;
    }
    real_t apart = ONE - REAL_C(4.0) * square / (lag * lag);
    if (apart >= ZERO) {
        real_t root = real_sqrt(apart);
        root = root > SHAPE_APART ? root : SHAPE_APART;
        real_t slow = REAL_C(0.5) * lag * (ONE + root), difference = lag * root;
        real_t fast = slow - difference;
        /* A small lag is found from the product: the difference would have no digits. */
        if (root > REAL_C(0.5))
            fast = square / slow;
        m->count = 2;
        real_mode(&m->mode[0], slow, slow / difference, -ONE / difference);
        real_mode(&m->mode[1], fast, -fast / difference, ONE / difference);
        return;
    }
    real_t root = real_sqrt(-apart);
    root = root > SHAPE_APART ? root : SHAPE_APART;
    real_t rate = REAL_C(0.5) * lag / square, turn = rate * root;
    m->count = 1;
    m->mode[0] = (struct shape_mode){.rate = rate,
                                     .turn = turn,
                                     .step_re = ONE,
                                     .step_im = -ONE / root,
                                     .change_im = ONE / (square * turn)};
}

/* *decay = exp(-(rate - i turn) x); returns 1 less that, without cancellation. */
static struct complex_pair one_less_mode(const struct shape_mode *m, real_t x,
                                         struct complex_pair *decay)
{
    real_t decayed = m->rate * x > REAL_C(80.0) ? ZERO : real_exp(-m->rate * x);
    struct complex_pair less = {one_less_exp(m->rate * x), ZERO};
    *decay = (struct complex_pair){decayed, ZERO};
    if (m->turn > ZERO) {
        real_t sine, cosine;
        real_sincos(REAL_C(0.5) * m->turn * x, &sine, &cosine);
        less.re += TWO * decayed * sine * sine;
        less.im = -TWO * decayed * sine * cosine;
        *decay = (struct complex_pair){decayed * (ONE - TWO * sine * sine), -less.im};
    }
    return less;
}

/* Weight of a mode in a column. */
static struct complex_pair weight_in_column(const struct shape_mode *m,
                                            const struct shape_column *c)
{
    struct complex_pair w = {c->gain * m->step_re + c->gain_zero * m->change_re,
                             c->gain * m->step_im + c->gain_zero * m->change_im};
    if (c->by_dead) /* a later begin leaves more: exp(rate late) */
        w = complex_product(w, (struct complex_pair){m->rate, -m->turn});
    return w;
}

/* First sample that an edge reaches, and the point it belongs to; beyond all points after the last edge. */
static uint32_t sample_reached(const struct excitation *u, uint32_t j, uint32_t whole)
{
    return u->edge[j].sample + whole + 1u;
}

static uint32_t point_reached(const struct excitation *u, uint32_t j, uint32_t whole,
                              uint32_t block)
{
    return j < u->edges ? sample_reached(u, j, whole) / block : UINT32_MAX;
}

/* A mode under way over the points: what all edges are multiplied by, and the sums of the exponentials of all edges so far over
 * the samples of one block. */
struct mode_course {
    const struct shape_mode *mode;
    struct complex_pair begun, one, all, step; /* late begin; a sample, a block; its decay */
    struct complex_pair sum, waiting;          /* in the block before, of edges in it */
};

static void begin_course(struct mode_course *c, const struct shape_mode *m, real_t dead,
                         uint32_t block)
{
    struct complex_pair single;
    c->mode = m;
    (void)one_less_mode(m, ONE - (dead - (real_t)(uint32_t)dead), &c->begun);
    c->one = one_less_mode(m, ONE, &single);
    c->all = complex_quotient(one_less_mode(m, (real_t)block, &c->step), c->one);
    c->sum = c->waiting = (struct complex_pair){ZERO, ZERO};
}

/* An edge of height change that reaches `rest` samples of a block: adds to the sum of this block, *here, and keeps the next. */
static void add_edge(struct mode_course *c, real_t change, uint32_t rest, struct complex_pair *here)
{
    struct complex_pair later, height = {change * c->begun.re, change * c->begun.im};
    struct complex_pair part = one_less_mode(c->mode, (real_t)rest, &later);
    part = complex_product(height, complex_quotient(part, c->one));
    here->re += part.re;
    here->im += part.im;
    later = complex_product(complex_product(height, later), c->all);
    c->waiting.re += later.re;
    c->waiting.im += later.im;
}

/* Adds one mode to all columns. */
static void add_mode(const struct excitation *u, const struct shape_mode *m, real_t dead,
                     uint32_t block, uint32_t points, const struct shape_column *columns,
                     uint32_t count)
{
    struct complex_pair weight[SHAPE_COLUMNS_MAX];
    struct mode_course c;
    real_t n = (real_t)block;
    uint32_t whole = (uint32_t)dead, j = 0, due = point_reached(u, 0, whole, block);
    for (uint32_t k = 0; k < count; k++) {
        weight[k] = weight_in_column(m, &columns[k]);
        weight[k].re /= n;
        weight[k].im /= n;
    }
    begin_course(&c, m, dead, block);
    for (uint32_t i = due; i < points; i++) {
        if (m->turn > ZERO) {
            c.sum = complex_product(c.sum, c.step);
            c.sum.im += c.waiting.im;
        } else {
            c.sum.re *= c.step.re;
        }
        if (real_abs(c.sum.re) + real_abs(c.sum.im) < REAL_C(1e-30)) /* no subnormal numbers */
            c.sum = (struct complex_pair){ZERO, ZERO};
        c.sum.re += c.waiting.re;
        c.waiting = (struct complex_pair){ZERO, ZERO};
        struct complex_pair here = c.sum;
        for (; due == i; due = point_reached(u, ++j, whole, block))
            add_edge(&c, u->edge[j].change, block - sample_reached(u, j, whole) % block, &here);
        for (uint32_t k = 0; k < count; k++)
            columns[k].value[i] -= weight[k].re * here.re - weight[k].im * here.im;
    }
}

/* The part of the step response that stays: gain times the input's level, as it arrives. */
static void begin_with_level(const struct excitation *u, uint32_t whole, uint32_t block,
                             uint32_t points, const struct shape_column *c)
{
    real_t level = ZERO, n = (real_t)block, gain = c->by_dead ? ZERO : c->gain;
    uint32_t j = 0, due = point_reached(u, 0, whole, block);
    for (uint32_t i = 0; i < points; i++) {
        real_t mean = level;
        for (; due == i; due = point_reached(u, ++j, whole, block)) {
            uint32_t rest = block - sample_reached(u, j, whole) % block;
            mean += u->edge[j].change * (real_t)rest / n;
            level += u->edge[j].change;
        }
        c->value[i] = gain * mean;
    }
}

void shape_response(const struct excitation *u, const struct shape_modes *m, real_t dead,
                    uint32_t block, uint32_t points, const struct shape_column *columns,
                    uint32_t count)
{
    REFLUX_ASSERT(u->edges <= EXCITATION_EDGES_MAX && block >= 1 && count <= SHAPE_COLUMNS_MAX &&
                  m->count >= 1 && m->count <= 2);
    for (uint32_t k = 0; k < count; k++)
        begin_with_level(u, (uint32_t)dead, block, points, &columns[k]);
    for (uint32_t k = 0; k < m->count; k++)
        add_mode(u, &m->mode[k], dead, block, points, columns, count);
}

real_t shape_response_to_come(const struct shape_modes *m, real_t time, real_t zero)
{
    const struct shape_column column = {NULL, ONE, zero, false};
    real_t sum = ZERO;
    for (uint32_t k = 0; k < m->count; k++) {
        struct complex_pair decay, weight = weight_in_column(&m->mode[k], &column);
        (void)one_less_mode(&m->mode[k], time, &decay);
        sum += weight.re * decay.re - weight.im * decay.im;
    }
    return sum;
}

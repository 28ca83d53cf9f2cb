#include "design/nyquist.h"

#include <stddef.h>
#include <string.h>

#include "base/assertion.h"

#define STEP_COSINE      REAL_C(0.921) /* 0.4 rad */
#define STEP_LOG         REAL_C(0.336) /* ln 1.4 */
#define FEW              4
#define STEP_COSINE_MANY REAL_C(0.362) /* 1.2 rad */
#define STEP_LOG_MANY    REAL_C(1.2)
#define RATIO_FIRST      REAL_C(1.1)
#define RATIO_FINE       REAL_C(1.002) /* finer than that no peak is looked at */
#define STEP_PEAK        REAL_C(0.08)  /* of a sensitivity */
#define STEP_PEAK_MANY   REAL_C(0.16)
#define RATIO_MOST       REAL_C(1.3)
#define RATIO_LEAST      REAL_C(1.00001)
#define STEP_DEAD_TIME   REAL_C(1.0)  /* rad that a dead time may turn in a step, */
#define NOTED            REAL_C(0.1)  /* in elements of the open loop of at least this size */
#define NEGLIGIBLE       REAL_C(0.05) /* G C this small turns no curve any more */
#define LOWER_TRIES      6
#define DB_OF_NEPER      REAL_C(8.685889638065037)
#define PI               REAL_C(3.141592653589793)

enum { STAGE_BEGIN, STAGE_FOLLOW, STAGE_DONE };

/* An element of two lags or with a zero: its slowest time, and the frequency from which on it no longer rises. */
static void take_corners(struct nyquist *n, size_t k, size_t l, real_t *slowest)
{
    REFLUX_ASSERT(k < n->loops->pairs.n && l < n->loops->pairs.n);
    size_t i = n->loops->pairs.output[k], j = n->loops->pairs.input[l];
    const struct interact_shape *shape = &n->plant->shape[i][j];
    if (interact_one_lag(shape))
        return;
    bool square = shape->square_s2 > REAL_C(0.0);
    real_t time = square ? real_sqrt(shape->square_s2) : n->plant->element[i][j].time_constant_s;
    real_t zero = real_abs(shape->zero_s), above = REAL_C(2.0) / time;
    n->shaped = true;
    n->last_corner = above > n->last_corner ? above : n->last_corner;
    *slowest = time > *slowest ? time : *slowest;
    *slowest = zero > *slowest ? zero : *slowest;
}

enum err nyquist_begin(struct nyquist *n, const struct interact_plant *plant,
                       const struct loops *loops, real_t gain_times, real_t limit_db)
{
    enum err err = interact_check(plant, NULL);
    if (!err)
        err = loops_check(plant, loops, NULL);
    if (err)
        return err;
    if (!(gain_times >= REAL_C(0.01) && gain_times <= REAL_C(100.0)) || !(limit_db > REAL_C(0.0)))
        return ERR_RANGE;
    memset(n, 0, sizeof *n);
    n->plant = plant;
    n->loops = loops;
    n->gain_times = gain_times;
    n->limit_db = limit_db;
    /* Well below everything that happens: the slowest residence or integral time. */
    real_t slowest = loops->interval_s;
    for (size_t k = 0; k < loops->pairs.n; k++) {
        if (loops->tuning[k].ti_s > slowest)
            slowest = loops->tuning[k].ti_s;
        for (size_t l = 0; l < loops->pairs.n; l++) {
            const struct fopdt *e = &plant->element[loops->pairs.output[k]][loops->pairs.input[l]];
            if (e->dead_time_s + e->time_constant_s > slowest)
                slowest = e->dead_time_s + e->time_constant_s;
            take_corners(n, k, l, &slowest);
        }
    }
    loops_sample(plant, loops, NYQUIST_DELAY, REAL_C(0.0), &n->sampled);
    n->w_end = PI / n->sampled.step_s;
    n->corner = REAL_C(1.0) / slowest;
    n->w = REAL_C(0.02) * n->corner;
    n->ratio = RATIO_FIRST;
    n->log_modulus_db = REAL_C(-1000.0);
    return ERR_OK;
}

enum err nyquist_begin_peaks(struct nyquist *n, const struct interact_plant *plant,
                             const struct loops *loops)
{
    enum err err = nyquist_begin(n, plant, loops, REAL_C(1.0), INFINITY);
    if (err)
        return err;
    n->with_peaks = true;
    peaks_begin(&n->peaks, loops->pairs.n);
    return ERR_OK;
}

/* Bound on the spectral radius of the open loop: the smaller of its largest row and column sums. */
static real_t open_bound(const struct clu *open, size_t n)
{
    real_t row = REAL_C(0.0), col = REAL_C(0.0);
    for (size_t i = 0; i < n; i++) {
        real_t r = REAL_C(0.0), c = REAL_C(0.0);
        for (size_t j = 0; j < n; j++) {
            r += cplx_abs(open->value[i][j]);
            c += cplx_abs(open->value[j][i]);
        }
        row = r > row ? r : row;
        col = c > col ? c : col;
    }
    return row < col ? row : col;
}

/* Longest dead time among the elements that still matter. A step in which it turns once is not seen in F. */
static real_t dead_time(const struct nyquist *n)
{
    const struct pairs *pairs = &n->loops->pairs;
    real_t longest = REAL_C(0.0);
    for (size_t k = 0; k < pairs->n; k++)
        for (size_t l = 0; l < pairs->n; l++) {
            real_t dead = n->plant->element[pairs->output[k]][pairs->input[l]].dead_time_s;
            if (dead > longest && cplx_square(n->lu.value[k][l]) >= NOTED * NOTED)
                longest = dead;
        }
    return longest;
}

struct point {
    struct cplx direction; /* of F */
    real_t size_log;       /* of |F| */
    real_t db;             /* log modulus */
    real_t bound;          /* of the open loop */
    real_t dead_s;         /* longest that matters */
    struct peaks_point sensitivity;
};

static enum err evaluate_point(struct nyquist *n, real_t w, struct point *p)
{
    loops_open(n->loops, &n->sampled, w, n->lu.value);
    size_t size = n->loops->pairs.n;
    for (size_t i = 0; i < size; i++)
        for (size_t j = 0; j < size; j++)
            n->lu.value[i][j] = cplx_scale(n->lu.value[i][j], n->gain_times);
    p->bound = open_bound(&n->lu, size);
    p->dead_s = dead_time(n);
    for (size_t i = 0; i < size; i++)
        n->lu.value[i][i].re += REAL_C(1.0);
    enum err err = clu_factor_own(&n->lu, n->loops->pairs.n);
    if (err)
        return err;
    if (n->with_peaks)
        peaks_values(&n->lu, &p->sensitivity);
    struct cplx det;
    real_t det_log;
    clu_determinant(&n->lu, &det, &det_log);
    /* W/(1 + W) = 1 - 1/det */
    real_t inverse = real_exp(det_log < REAL_C(-30.0) ? REAL_C(30.0) : -det_log);
    struct cplx t = cplx(REAL_C(1.0) - inverse * det.re, inverse * det.im);
    real_t square = cplx_square(t);
    p->db = square > REAL_C(1e-30) ? REAL_C(0.5) * DB_OF_NEPER * real_log(square) : REAL_C(-300.0);
    /* times ((z - 1)/(z - b))^n, b = 1 - a h: the same as (s/(s + a))^n where that matters */
    real_t h = n->sampled.step_s;
    real_t ah = n->corner * h < REAL_C(0.5) ? n->corner * h : REAL_C(0.5);
    struct cplx z_less_1 = loops_z_less_1(w * h);
    struct cplx shift = cplx_div(z_less_1, cplx(z_less_1.re + ah, z_less_1.im));
    real_t size_of_shift = cplx_abs(shift);
    shift = cplx_scale(shift, REAL_C(1.0) / size_of_shift);
    for (size_t k = 0; k < size; k++)
        det = cplx_mul(det, shift);
    p->direction = cplx_scale(det, REAL_C(1.0) / cplx_abs(det));
    p->size_log = det_log + (real_t)size * real_log(size_of_shift);
    return ERR_OK;
}

static void keep_point(struct nyquist *n, const struct point *p, real_t w)
{
    n->w = w;
    n->last = p->direction;
    n->last_log = p->size_log;
    if (n->with_peaks)
        peaks_keep(&n->peaks, &p->sensitivity, w);
    if (p->db > n->log_modulus_db) {
        n->log_modulus_db = p->db;
        n->omega = w;
    }
}

static enum err end_curve(struct nyquist *n, bool stable, enum err err)
{
    n->stable = stable;
    n->stage = STAGE_DONE;
    return err;
}

/* The first point: low enough that the curve still lies near F(0), which is real. */
static enum err first_point(struct nyquist *n)
{
    struct point p;
    if (evaluate_point(n, n->w, &p))
        return end_curve(n, false, ERR_OK); /* K or its loops are singular: no steady state */
    if (p.direction.re < STEP_COSINE && n->tries < LOWER_TRIES) {
        n->tries++;
        n->w = n->w * REAL_C(0.1);
        return ERR_BUSY;
    }
    if (p.direction.re < REAL_C(0.5))
        return end_curve(n, false, ERR_OK); /* F(0) < 0: the Niederlinski index is */
    keep_point(n, &p, n->w);
    n->stage = STAGE_FOLLOW;
    return ERR_BUSY;
}

/* Longest step from w, rad/s, that sees the resonances of underdamped elements: half of what is left to the next one, or
 * half of its width. */
static real_t step_to_resonance(const struct nyquist *n, real_t w)
{
    const struct pairs *pairs = &n->loops->pairs;
    real_t step = INFINITY;
    for (size_t k = 0; k < pairs->n; k++)
        for (size_t l = 0; l < pairs->n; l++) {
            size_t i = pairs->output[k], j = pairs->input[l];
            real_t square = n->plant->shape[i][j].square_s2;
            real_t sum = n->plant->element[i][j].time_constant_s;
            if (sum * sum >= REAL_C(2.0) * square)
                continue;
            real_t width = REAL_C(0.5) * sum / square;
            real_t left = real_abs(w - REAL_C(1.0) / real_sqrt(square));
            left = REAL_C(0.5) * (left > width ? left : width);
            step = left < step ? left : step;
        }
    return step;
}

static enum err follow_curve(struct nyquist *n)
{
    struct point p;
    real_t w = n->w * n->ratio < n->w_end ? n->w * n->ratio : n->w_end;
    /* A loop near instability shows in its own sensitivity, so that the determinant of many may turn by more. */
    bool many = n->with_peaks && n->loops->pairs.n > FEW;
    real_t peak = many ? STEP_PEAK_MANY : STEP_PEAK;
    real_t cosine = many ? STEP_COSINE_MANY : STEP_COSINE,
           size_log = many ? STEP_LOG_MANY : STEP_LOG;
    if (evaluate_point(n, w, &p) || cplx_mul(p.direction, cplx_conj(n->last)).re < cosine ||
        real_abs(p.size_log - n->last_log) > size_log ||
        (n->with_peaks && n->ratio > RATIO_FINE &&
         peaks_change(&n->peaks, &p.sensitivity) > peak)) {
        n->ratio = real_sqrt(n->ratio);
        /* a curve that cannot be followed runs through 0: the edge of stability */
        return n->ratio < RATIO_LEAST ? end_curve(n, false, ERR_OK) : ERR_BUSY;
    }
    /* The negative real axis, downwards with a left turn. */
    bool above = n->last.im >= REAL_C(0.0), now_above = p.direction.im >= REAL_C(0.0);
    if (above != now_above && n->last.re + p.direction.re < REAL_C(0.0))
        n->turns = (int16_t)(n->turns + (above ? 1 : -1));
    keep_point(n, &p, w);
    if (n->log_modulus_db > n->limit_db)
        return end_curve(n, false, ERR_OK);
    if (p.bound < NEGLIGIBLE && w >= n->last_corner) /* whatever is left turns about 1 */
        return end_curve(n, n->turns == 0, ERR_OK);
    if (w >= n->w_end) /* F(-1), real */
        return end_curve(n, n->turns == 0 && p.direction.re > REAL_C(0.0), ERR_OK);
    n->ratio = n->ratio * real_sqrt(n->ratio);
    if (n->ratio > RATIO_MOST)
        n->ratio = RATIO_MOST;
    if ((n->ratio - REAL_C(1.0)) * w * p.dead_s > STEP_DEAD_TIME)
        n->ratio = REAL_C(1.0) + STEP_DEAD_TIME / (w * p.dead_s);
    if (n->shaped) {
        real_t step = step_to_resonance(n, w);
        if ((n->ratio - REAL_C(1.0)) * w > step)
            n->ratio = REAL_C(1.0) + step / w;
    }
    return ERR_BUSY;
}

enum err nyquist_step(struct nyquist *n)
{
    if (n->stage == STAGE_DONE)
        return ERR_STATE;
    if (n->points >= NYQUIST_POINTS)
        return end_curve(n, false, ERR_TIMEOUT);
    n->points++;
    return n->stage == STAGE_BEGIN ? first_point(n) : follow_curve(n);
}

#include "design/robust_pass.h"

#include "base/assertion.h"

#define SPACING      REAL_C(0.16) /* of frequencies, in their logarithm */
#define POINTS_LEAST 16
#define POINTS_MOST  64
#define SINGLES      5
#define TRADES       4
#define PI           REAL_C(3.141592653589793)

/* Steps of gain and integral time: of one loop, and of two. Each raises the sum over loops of 1.75 ln gain - ln Ti. */
static const int8_t singles[SINGLES][2] = {{0, -1}, {1, 0}, {-1, -2}, {2, 1}, {1, 1}};
static const int8_t trades[TRADES][4] = {
    {2, 0, -1, 0}, {0, -2, 0, 1}, {0, -2, -1, 0}, {2, 0, 0, 1}};

uint8_t robust_moves(uint8_t loops)
{
    unsigned pairs = loops <= ROBUST_PAIRED_LOOPS ? loops * (loops - 1u) : 0u;
    return (uint8_t)(SINGLES * loops + TRADES * pairs);
}

struct robust_move robust_move(uint8_t loops, uint8_t number)
{
    if (number < SINGLES * loops) {
        const int8_t *d = singles[number % SINGLES];
        return (struct robust_move){
            {(uint8_t)(number / SINGLES), INTERACT_NONE}, {d[0], 0}, {d[1], 0}};
    }
    REFLUX_ASSERT(loops > 1 && loops <= ROBUST_PAIRED_LOOPS);
    unsigned trade = number - (unsigned)SINGLES * loops, pair = trade / TRADES;
    unsigned first = pair / (loops - 1u), other = pair % (loops - 1u);
    const int8_t *d = trades[trade % TRADES];
    return (struct robust_move){{(uint8_t)first, (uint8_t)(other < first ? other : other + 1u)},
                                {d[0], d[2]},
                                {d[1], d[3]}};
}

/* e^(steps * step); only what robust_move() has. */
static real_t step_factor(const real_t factor[5], int8_t steps)
{
    REFLUX_ASSERT(steps >= -2 && steps <= 2);
    return factor[steps + 2];
}

static void set_factors(real_t factor[5], real_t step)
{
    for (int steps = -2; steps <= 2; steps++)
        factor[steps + 2] = steps == 0 ? REAL_C(1.0) : real_exp(step * (real_t)steps);
}

/* Whether the settings after a move stay within their limits. */
static bool move_allowed(const struct loops *loops, const struct robust_move *move,
                         const real_t factor[5], const struct robust_limits *limits)
{
    for (int m = 0; m < 2 && move->loop[m] != INTERACT_NONE; m++) {
        uint8_t k = move->loop[m];
        REFLUX_ASSERT(k < loops->pairs.n);
        real_t gain = loops->tuning[k].gain * step_factor(factor, move->gain[m]);
        real_t ti = loops->tuning[k].ti_s * step_factor(factor, move->ti[m]);
        if (!real_within(gain, limits->gain_least, limits->gain_most[k]) ||
            !real_within(ti, limits->ti_least_s, limits->ti_most_s))
            return false;
    }
    return true;
}

bool robust_make_move(struct loops *loops, const struct robust_move *move, real_t step,
                      const struct robust_limits *limits)
{
    real_t factor[5];
    set_factors(factor, step);
    if (!move_allowed(loops, move, factor, limits))
        return false;
    for (int m = 0; m < 2 && move->loop[m] != INTERACT_NONE; m++) {
        struct tuning *t = &loops->tuning[move->loop[m]];
        t->gain *= step_factor(factor, move->gain[m]);
        t->ti_s *= step_factor(factor, move->ti[m]);
    }
    return true;
}

void robust_pass_begin(struct robust_pass *pass, const struct loops *loops,
                       const struct robust_limits *limits, real_t step, const struct tuning *before,
                       const uint8_t *place)
{
    pass->loops = loops;
    pass->before = before;
    pass->place = place;
    pass->away = REAL_C(0.0);
    pass->limits = limits;
    pass->present = REAL_C(0.0);
    pass->moves = robust_moves(loops->pairs.n);
    REFLUX_ASSERT(pass->moves <= ROBUST_MOVES);
    set_factors(pass->factor, step);
    for (uint8_t m = 0; m < pass->moves; m++) {
        struct robust_move move = robust_move(loops->pairs.n, m);
        pass->excess[m] = move_allowed(loops, &move, pass->factor, limits) ? REAL_C(0.0) : INFINITY;
    }
}

void robust_pass_plant(struct robust_pass *pass, const struct interact_plant *plant,
                       real_t omega_lo, real_t omega_hi)
{
    loops_sample(plant, pass->loops, ROBUST_DELAY, REAL_C(0.0), &pass->sampled);
    real_t end = PI / pass->sampled.step_s;
    omega_hi = omega_hi < end ? omega_hi : end;
    omega_lo = omega_lo < REAL_C(0.5) * omega_hi ? omega_lo : REAL_C(0.5) * omega_hi;
    real_t span = real_log(omega_hi / omega_lo), points = span / SPACING;
    points = points < (real_t)POINTS_MOST ? points : (real_t)POINTS_MOST;
    points = points > (real_t)POINTS_LEAST ? points : (real_t)POINTS_LEAST;
    pass->points = (uint8_t)points;
    pass->ratio = real_exp(span / (real_t)(pass->points - 1));
    pass->omega = omega_lo;
    pass->point = 0;
    pass->opened = false;
}

static real_t greater_of(real_t a, real_t b)
{
    return a > b ? a : b;
}

/* |S|^2 and |1 - S|^2 over the squares of their limits, the larger one. */
static real_t excess_of(const struct robust_pass *pass, struct cplx s)
{
    struct cplx t = cplx(REAL_C(1.0) - s.re, -s.im);
    return greater_of(cplx_square(s) / (pass->limits->s_most * pass->limits->s_most),
                      cplx_square(t) / (pass->limits->t_most * pass->limits->t_most));
}

/* r: the controller of loop k after the move over that before, less 1. With a = h/(z - 1) it is 1 + a/Ti. */
static struct cplx controller_change(const struct robust_pass *pass, const struct robust_move *move,
                                     int m, struct cplx a)
{
    real_t ti = pass->loops->tuning[move->loop[m]].ti_s;
    struct cplx before = cplx(ti + a.re, a.im);
    struct cplx after = cplx_scale(a, REAL_C(1.0) / step_factor(pass->factor, move->ti[m]));
    after = cplx_scale(cplx(ti + after.re, after.im), step_factor(pass->factor, move->gain[m]));
    return cplx_div(cplx_sub(after, before), before);
}

/* T_ik */
static struct cplx other_of(const struct robust_pass *pass, size_t i, size_t k)
{
    struct cplx s = pass->s[i][k];
    return cplx((i == k ? REAL_C(1.0) : REAL_C(0.0)) - s.re, -s.im);
}

/* Largest excess after the move of one loop; infinite where det(I + G C) turns too far. */
static real_t after_single(const struct robust_pass *pass, const struct robust_move *move,
                           struct cplx a)
{
    size_t n = pass->loops->pairs.n, k = move->loop[0];
    struct cplx r = controller_change(pass, move, 0, a);
    struct cplx det = cplx_mul(r, other_of(pass, k, k));
    det.re += REAL_C(1.0);
    if (!(det.re > REAL_C(0.0)))
        return INFINITY;
    struct cplx part = cplx_div(r, det);
    real_t worst = REAL_C(0.0);
    for (size_t i = 0; i < n; i++) {
        struct cplx change = cplx_mul(part, cplx_mul(other_of(pass, i, k), pass->s[k][i]));
        worst = greater_of(worst, excess_of(pass, cplx_sub(pass->s[i][i], change)));
    }
    return worst;
}

/* The same for two loops: (I + V U) of 2 x 2, inverted. */
static real_t after_pair(const struct robust_pass *pass, const struct robust_move *move,
                         struct cplx a)
{
    size_t n = pass->loops->pairs.n, k = move->loop[0], l = move->loop[1];
    struct cplx rk = controller_change(pass, move, 0, a), rl = controller_change(pass, move, 1, a);
    struct cplx kk = cplx_mul(rk, other_of(pass, k, k)), ll = cplx_mul(rl, other_of(pass, l, l));
    struct cplx kl = cplx_mul(rl, other_of(pass, k, l)), lk = cplx_mul(rk, other_of(pass, l, k));
    kk.re += REAL_C(1.0);
    ll.re += REAL_C(1.0);
    struct cplx det = cplx_sub(cplx_mul(kk, ll), cplx_mul(kl, lk));
    if (!(det.re > REAL_C(0.0)))
        return INFINITY;
    struct cplx inverse = cplx_div(cplx(REAL_C(1.0), REAL_C(0.0)), det);
    real_t worst = REAL_C(0.0);
    for (size_t i = 0; i < n; i++) {
        struct cplx sk = pass->s[k][i], sl = pass->s[l][i];
        struct cplx xk = cplx_sub(cplx_mul(ll, sk), cplx_mul(kl, sl));
        struct cplx xl = cplx_sub(cplx_mul(kk, sl), cplx_mul(lk, sk));
        struct cplx change = cplx_add(cplx_mul(cplx_mul(other_of(pass, i, k), rk), xk),
                                      cplx_mul(cplx_mul(other_of(pass, i, l), rl), xl));
        change = cplx_mul(change, inverse);
        worst = greater_of(worst, excess_of(pass, cplx_sub(pass->s[i][i], change)));
    }
    return worst;
}

/* The controllers before over those of now, less 1, weighted with T. */
static void note_way(struct robust_pass *pass, struct cplx a)
{
    size_t n = pass->loops->pairs.n;
    real_t r[INTERACT_MAX];
    for (size_t k = 0; k < n; k++) {
        const struct tuning *t = &pass->loops->tuning[k], *before = &pass->before[pass->place[k]];
        struct cplx own = cplx(t->ti_s + a.re, a.im);
        struct cplx old = cplx_scale(cplx(before->ti_s + a.re, a.im),
                                     before->gain * t->ti_s / (t->gain * before->ti_s));
        r[k] = cplx_abs(cplx_div(cplx_sub(old, own), own));
    }
    for (size_t i = 0; i < n; i++) {
        real_t sum = REAL_C(0.0);
        for (size_t j = 0; j < n; j++)
            sum += cplx_abs(other_of(pass, i, j)) * r[j];
        pass->away = greater_of(pass->away, sum);
    }
}

static void try_moves(struct robust_pass *pass)
{
    struct cplx z_less_1 = loops_z_less_1(pass->omega * pass->sampled.step_s);
    struct cplx a = cplx_div(cplx(pass->sampled.step_s, REAL_C(0.0)), z_less_1);
    if (pass->before)
        note_way(pass, a);
    for (size_t k = 0; k < pass->loops->pairs.n; k++)
        pass->present = greater_of(pass->present, excess_of(pass, pass->s[k][k]));
    for (uint8_t m = 0; m < pass->moves; m++) {
        if (!(pass->excess[m] <= REAL_C(1.0)))
            continue; /* no longer of interest */
        struct robust_move move = robust_move(pass->loops->pairs.n, m);
        bool single = move.loop[1] == INTERACT_NONE;
        real_t after = single ? after_single(pass, &move, a) : after_pair(pass, &move, a);
        pass->excess[m] = greater_of(pass->excess[m], after);
    }
}

enum err robust_pass_step(struct robust_pass *pass)
{
    REFLUX_ASSERT(pass->loops->pairs.n <= INTERACT_MAX);
    if (pass->point >= pass->points)
        return ERR_OK;
    if (!pass->opened) {
        loops_open(pass->loops, &pass->sampled, pass->omega, pass->s);
        for (size_t k = 0; k < pass->loops->pairs.n; k++)
            pass->s[k][k].re += REAL_C(1.0);
        pass->opened = true;
        return ERR_BUSY;
    }
    if (cmatrix_invert_own(pass->s, pass->loops->pairs.n) == ERR_OK)
        try_moves(pass);
    else
        pass->present = INFINITY; /* on the edge of stability, or numbers too large */
    pass->opened = false;
    pass->omega *= pass->ratio;
    pass->point++;
    return pass->point < pass->points ? ERR_BUSY : ERR_OK;
}

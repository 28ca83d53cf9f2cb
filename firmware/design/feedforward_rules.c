#include "design/feedforward_rules.h"

#include "num/real_trig.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)
#define TWO  REAL_C(2.0)
#define PI   REAL_C(3.14159265358979)

/* Dead times that are tried at first, and cuts of the golden section between the neighbours of the best. */
#define TRIED 25u
#define CUTS  30u
/* Weights by the time constant that they find; so often. */
#define ROUNDS 4u

static bool nearly(real_t difference, real_t of, real_t same)
{
    return real_abs(difference) <= same * of;
}

struct feedforward_case feedforward_case_of(const struct fopdt *process,
                                            const struct fopdt *disturbance, real_t same)
{
    real_t late = process->dead_time_s - disturbance->dead_time_s;
    real_t slow = process->time_constant_s - disturbance->time_constant_s;
    real_t larger = slow > ZERO ? process->time_constant_s : disturbance->time_constant_s;
    real_t whole = process->dead_time_s + process->time_constant_s;
    struct feedforward_case which = {.late = nearly(late, whole, same) ? LATE_NEITHER
                                             : late > ZERO             ? LATE_PROCESS
                                                                       : LATE_DISTURBANCE,
                                     .slow = nearly(slow, larger, same) ? SLOW_NEITHER
                                             : slow > ZERO              ? SLOW_PROCESS
                                                                        : SLOW_DISTURBANCE};
    return which;
}

const char *feedforward_case_name(struct feedforward_case which)
{
    static const char *const names[3][3] = {
        {"I a", "I b", "I c"}, {"II a", "II b", "II c"}, {"III a", "III b", "III c"}};
    return names[which.late][which.slow];
}

static enum err check_paths(const struct fopdt *process, const struct fopdt *disturbance)
{
    enum err err = fopdt_validate(process, NULL, NULL);
    if (!err)
        err = fopdt_validate(disturbance, NULL, NULL);
    if (!err && !(process->gain < ZERO || process->gain > ZERO))
        err = ERR_RANGE;
    return err;
}

enum err feedforward_shinskey(const struct fopdt *process, const struct fopdt *disturbance,
                              real_t same, struct feedforward_rule *rule)
{
    enum err err = check_paths(process, disturbance);
    if (err)
        return err;
    struct feedforward_case which = feedforward_case_of(process, disturbance, same);
    real_t tm = process->time_constant_s, tq = disturbance->time_constant_s;
    real_t dm = process->dead_time_s, dq = disturbance->dead_time_s;
    real_t ahead = dm - dq, lead = tm, lag = tq;
    if (which.late == LATE_PROCESS && which.slow == SLOW_PROCESS) {
        lead = REAL_C(0.8) * tm + REAL_C(0.4) * ahead;
        lag = tq - REAL_C(0.2) * tm - REAL_C(0.6) * ahead;
    } else if (which.late == LATE_PROCESS && which.slow == SLOW_NEITHER) {
        lead = REAL_C(1.1) * ahead;
        lag = lead / REAL_C(10.0);
    } else if (which.late == LATE_DISTURBANCE && which.slow == SLOW_NEITHER) {
        lead = ahead / TWO;
        lag = -ahead / TWO;
    } else if (which.late == LATE_DISTURBANCE && which.slow == SLOW_DISTURBANCE) {
        lead = tm + REAL_C(1.4) * ahead;
        lag = tq + REAL_C(0.4) * ahead;
    } else if (which.late != LATE_NEITHER) { /* II c and III a */
        lead = tm + dm;
        lag = tq + dq;
    }
    *rule = (struct feedforward_rule){.gain = -disturbance->gain / process->gain,
                                      .lead_s = lead,
                                      .lag_s = lag > ZERO ? lag : ZERO};
    return ERR_OK;
}

enum err feedforward_exact(const struct fopdt *process, const struct fopdt *disturbance,
                           struct feedforward_rule *rule)
{
    enum err err = check_paths(process, disturbance);
    if (err)
        return err;
    real_t wait = disturbance->dead_time_s - process->dead_time_s;
    *rule = (struct feedforward_rule){.gain = -disturbance->gain / process->gain,
                                      .lead_s = process->time_constant_s,
                                      .lag_s = disturbance->time_constant_s,
                                      .dead_s = wait > ZERO ? wait : ZERO};
    return ERR_OK;
}

/* ---- responses ---- */

/* e^(i angle) */
static struct cplx turned(real_t angle)
{
    struct cplx z;
    real_sincos(angle, &z.im, &z.re);
    return z;
}

struct cplx feedforward_rule_response(const struct feedforward_rule *rule, real_t omega)
{
    struct cplx shape = cplx_div(cplx(ONE, omega * rule->lead_s), cplx(ONE, omega * rule->lag_s));
    return cplx_scale(cplx_mul(shape, turned(-omega * rule->dead_s)), rule->gain);
}

struct cplx fopdt_response(const struct fopdt *m, real_t omega)
{
    struct cplx lagged = cplx_div(cplx(m->gain, ZERO), cplx(ONE, omega * m->time_constant_s));
    return cplx_mul(lagged, turned(-omega * m->dead_time_s));
}

/* ---- a model of a response ---- */

/* Mean square of |model/response - 1|. */
static real_t relative_square(size_t n, const real_t *omega, const struct cplx *response,
                              const struct fopdt *m)
{
    real_t sum = ZERO;
    for (size_t i = 0; i < n; i++)
        sum += cplx_square(cplx_sub(fopdt_response(m, omega[i]), response[i])) /
               cplx_square(response[i]);
    return sum / (real_t)n;
}

/* Gain and time constant for the dead time in *m; one that is not above 0 is the least there is. */
static real_t fit_with_dead_time(size_t n, const real_t *omega, const struct cplx *response,
                                 struct fopdt *m)
{
    m->time_constant_s = ZERO;
    for (unsigned round = 0; round < ROUNDS; round++) {
        real_t one = ZERO, cross = ZERO, square = ZERO, right = ZERO, t = m->time_constant_s;
        for (size_t i = 0; i < n; i++) {
            real_t w = omega[i];
            struct cplx g = cplx_mul(response[i], turned(w * m->dead_time_s));
            real_t weight = ONE / (cplx_square(g) * (ONE + w * w * t * t));
            one += weight;
            cross += weight * w * g.im;
            square += weight * w * w * cplx_square(g);
            right += weight * g.re;
        }
        /* one K + cross T = right,  cross K + square T = 0 */
        real_t det = one * square - cross * cross;
        if (!(det > ZERO))
            return REAL_C(1e30);
        m->gain = right * square / det;
        m->time_constant_s = -cross * right / det;
        if (!(m->time_constant_s > ZERO)) {
            m->time_constant_s = ZERO;
            m->gain = right / one;
        }
    }
    return relative_square(n, omega, response, m);
}

static real_t error_at(size_t n, const real_t *omega, const struct cplx *response, real_t dead,
                       struct fopdt *m)
{
    m->dead_time_s = dead;
    return fit_with_dead_time(n, omega, response, m);
}

static enum err check_response(size_t n, const real_t *omega, const struct cplx *response)
{
    if (n < 3)
        return ERR_RANGE;
    for (size_t i = 0; i < n; i++) {
        real_t square = cplx_square(response[i]);
        if (!real_is_finite(omega[i]) || !real_is_finite(square))
            return ERR_NOT_FINITE;
        if (!(omega[i] > ZERO) || !(square > ZERO))
            return ERR_RANGE;
    }
    return ERR_OK;
}

enum err fopdt_from_response(size_t n, const real_t *omega, const struct cplx *response,
                             real_t dead_most, struct fopdt *model, real_t *error)
{
    struct fopdt tried;
    enum err err = check_response(n, omega, response);
    if (!err && !(dead_most >= ZERO && real_is_finite(dead_most)))
        err = ERR_RANGE;
    if (err)
        return err;
    real_t step = dead_most / (real_t)(TRIED - 1u), least = REAL_C(1e30), at = ZERO;
    for (unsigned k = 0; k < TRIED; k++) {
        real_t found = error_at(n, omega, response, step * (real_t)k, &tried);
        if (found < least) {
            least = found;
            at = step * (real_t)k;
        }
    }
    real_t lo = at - step > ZERO ? at - step : ZERO;
    real_t hi = at + step < dead_most ? at + step : dead_most;
    for (unsigned k = 0; k < CUTS && hi > lo; k++) {
        real_t a = hi - REAL_C(0.618034) * (hi - lo), b = lo + REAL_C(0.618034) * (hi - lo);
        if (error_at(n, omega, response, a, &tried) < error_at(n, omega, response, b, &tried))
            hi = b;
        else
            lo = a;
    }
    *model = (struct fopdt){.gain = ZERO};
    real_t square = error_at(n, omega, response, (lo + hi) / TWO, model);
    *error = real_sqrt(square);
    return real_is_finite(square) && square < REAL_C(1e29) ? ERR_OK : ERR_RANGE;
}

/* ---- how far off ---- */

/* -pi to pi. A first guess (to 0.005) and two turns of Newton on the angle that is left. */
static real_t phase_of(struct cplx z)
{
    real_t size = cplx_abs(z), x = real_abs(z.re), y = real_abs(z.im);
    bool steep = y > x;
    real_t ratio = steep ? x / y : y / x;
    real_t angle = ratio / (ONE + REAL_C(0.28) * ratio * ratio);
    if (steep)
        angle = PI / TWO - angle;
    if (z.re < ZERO)
        angle = PI - angle;
    if (z.im < ZERO)
        angle = -angle;
    for (unsigned turn = 0; turn < 2; turn++) {
        struct cplx left = cplx_mul(z, turned(-angle));
        real_t sine = left.im / size;
        angle += sine + sine * sine * sine / REAL_C(6.0);
    }
    return angle;
}

struct feedforward_miss feedforward_miss_of(struct cplx element, struct cplx ideal)
{
    struct cplx ratio = cplx_div(element, ideal);
    real_t tenth = REAL_C(10.0) / real_log(REAL_C(10.0));
    return (struct feedforward_miss){.db = tenth * real_log(cplx_square(ratio)),
                                     .degrees = phase_of(ratio) * REAL_C(180.0) / PI};
}

void feedforward_misses(size_t n, const struct feedforward_miss *miss,
                        struct feedforward_miss *largest, struct feedforward_miss *together)
{
    *largest = *together = (struct feedforward_miss){ZERO, ZERO};
    for (size_t i = 0; i < n; i++) {
        real_t db = real_abs(miss[i].db), degrees = real_abs(miss[i].degrees);
        largest->db = db > largest->db ? db : largest->db;
        largest->degrees = degrees > largest->degrees ? degrees : largest->degrees;
        together->db += db * db;
        together->degrees += degrees * degrees;
    }
    together->db = real_sqrt(together->db);
    together->degrees = real_sqrt(together->degrees);
}

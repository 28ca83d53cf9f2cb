#include "design/feedforward_rules.h"

#include "base/assertion.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)
#define TWO  REAL_C(2.0)
#define PI   REAL_C(3.14159265358979)

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
    REFLUX_ASSERT(which.late < 3 && which.slow < 3);
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

struct cplx feedforward_rule_response(const struct feedforward_rule *rule, real_t omega)
{
    struct cplx shape = cplx_div(cplx(ONE, omega * rule->lead_s), cplx(ONE, omega * rule->lag_s));
    return cplx_scale(cplx_mul(shape, cplx_turned(-omega * rule->dead_s)), rule->gain);
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
        struct cplx left = cplx_mul(z, cplx_turned(-angle));
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

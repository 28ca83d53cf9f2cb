#include "kinds/gmv/gmv_monitors.h"

#include "base/assertion.h"
#include "kinds/gmv/gmv_monitors_state.h"
#include "num/real.h"

/* Least request of the law beyond a limit, and least control error, that count as pushing the wrong way; fractions of span. */
#define PUSHED   0.0004f
#define FAR_AWAY 0.01f
/* Time for an estimate of the wrong sign to turn back, as a multiple of the regressors' length. */
#define WRONG_REACHES 4u

void gmv_monitors_begin(struct gmv_monitors *m)
{
    for (unsigned i = 0; i < GMV_LOOPS; i++) {
        gmv_burst_begin(&m->burst[i]);
        gmv_cycle_begin(&m->cycle[i]);
        gmv_record_begin(&m->record[i]);
        m->jammed_steps[i] = 0;
    }
}

/* Returns the steps after which an answer to a setpoint is over. */
static uint32_t settled_steps(const struct gmv_supervise_config *c)
{
    return 2u * c->reach + 32u;
}

void gmv_monitors_keep_record(struct gmv_monitors *m, const struct gmv_supervise_config *c,
                              const struct gmv_observation *seen)
{
    for (unsigned i = 0; i < c->loops; i++)
        if ((seen->acting & seen->good & (1u << i)))
            gmv_record_pi(&m->record[i], seen->setpoint[i], seen->control_error[i], seen->move[i],
                          settled_steps(c));
}

bool gmv_monitors_setpoints_rest(const struct gmv_monitors *m, const struct gmv_supervise_config *c,
                                 uint8_t acting)
{
    for (unsigned i = 0; i < c->loops; i++)
        if ((acting & (1u << i)) && gmv_record_rests(&m->record[i]) < c->reach)
            return false;
    return true;
}

/* ---- gains ---- */

bool gmv_gain_allowed(const struct gmv_supervise_config *c, unsigned i, float gain)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return (c->negative[i] ? -gain : gain) >= c->gain_least;
}

bool gmv_monitors_gains(const struct gmv_supervise_config *c, const struct gmv_result *result,
                        uint8_t acting)
{
    for (unsigned i = 0; i < c->loops; i++)
        if ((acting & (1u << i)) && !gmv_gain_allowed(c, i, result->gain[i]))
            return false;
    return true;
}

/* Returns the g_ii,0 nearest to the wrong sign, or farthest beyond it, signed. */
static float worst_gain(const struct gmv_supervise_config *c, const struct gmv_result *result)
{
    unsigned worst = 0;
    for (unsigned i = 1; i < c->loops; i++)
        if ((c->negative[i] ? -result->gain[i] : result->gain[i]) <
            (c->negative[worst] ? -result->gain[worst] : result->gain[worst]))
            worst = i;
    return result->gain[worst];
}

/* Returns the loop whose estimated g_ii,0 has been wrong for too long, or `loops`. The g_ii,0 in use never follow such an estimate. */
static unsigned loop_of_wrong_sign(struct gmv_monitors *m, const struct gmv_supervise_config *c,
                                   const struct gmv_result *result, uint8_t acting)
{
    unsigned wrong = c->loops;
    for (unsigned i = 0; i < c->loops; i++) {
        bool right = gmv_gain_allowed(c, i, result->estimated[i]);
        m->wrong_steps[i] = right || !(acting & (1u << i)) ? 0 : m->wrong_steps[i] + 1u;
        if (m->wrong_steps[i] > WRONG_REACHES * c->reach)
            wrong = i;
    }
    return wrong;
}

/* ---- moves and errors ---- */

/* Returns the moves of an MV that swings, r.m.s.; 0: none does. */
static float swing(struct gmv_monitors *m, const struct gmv_supervise_config *c,
                   const struct gmv_observation *seen)
{
    float most = 0;
    uint32_t settled = 4u * c->reach + 32u;
    for (unsigned i = 0; i < c->loops; i++)
        if ((seen->acting & (1u << i)) &&
            gmv_burst_step(&m->burst[i], seen->setpoint[i], seen->move[i], c->burst, settled))
            most = gmv_burst_size(&m->burst[i]);
    return most;
}

/* Returns the control error of a PV that keeps swinging at rest, r.m.s.; 0: none does. */
static float cycling(struct gmv_monitors *m, const struct gmv_supervise_config *c,
                     const struct gmv_observation *seen, const struct gmv_result *result)
{
    float most = 0;
    for (unsigned i = 0; i < c->loops; i++)
        if ((seen->acting & result->complete & (1u << i)) &&
            gmv_cycle_step(&m->cycle[i], seen->setpoint[i], seen->control_error[i],
                           result->error[i], c->reach + 4u))
            most = gmv_cycle_size(&m->cycle[i]);
    return most;
}

/* Finds an MV that the law pushes against a limit although its own loop has a large error and needs it the other way: for a
 * while that may be best for both loops, not for long. Returns the control error, fraction of span; 0: none. */
static float jammed_away(struct gmv_monitors *m, const struct gmv_supervise_config *c,
                         const struct gmv_observation *seen)
{
    float most = 0;
    for (unsigned i = 0; i < c->loops; i++) {
        float away = real_abs(seen->control_error[i]);
        float needed = c->negative[i] ? -seen->control_error[i] : seen->control_error[i];
        bool jammed = (seen->acting & (1u << i)) && real_abs(seen->move[i]) < GMV_STANDS_STILL &&
                      real_abs(seen->shortfall[i]) > PUSHED && away > FAR_AWAY &&
                      needed * seen->shortfall[i] < 0;
        m->jammed_steps[i] = jammed ? m->jammed_steps[i] + 1u : 0;
        if (m->jammed_steps[i] > 4u * c->reach + 32u)
            most = away;
    }
    return most;
}

/* Returns by which factor the law does worse than the PI's record; 0: it does not. */
static float worse_than_pi(struct gmv_monitors *m, const struct gmv_supervise_config *c,
                           const struct gmv_observation *seen)
{
    float most = 0;
    for (unsigned i = 0; i < c->loops; i++) {
        if (!(seen->acting & seen->good & (1u << i)))
            continue;
        float times = gmv_record_law(&m->record[i], seen->setpoint[i], seen->control_error[i],
                                     seen->move[i], settled_steps(c));
        most = times > most ? times : most;
    }
    return most;
}

enum gmv_alarm gmv_monitors_step(struct gmv_monitors *m, const struct gmv_supervise_config *c,
                                 const struct gmv_observation *seen,
                                 const struct gmv_result *result, float *value)
{
    if (!gmv_monitors_gains(c, result, seen->acting)) {
        *value = worst_gain(c, result);
        return GMV_ALARM_SIGN;
    }
    unsigned wrong = loop_of_wrong_sign(m, c, result, seen->acting);
    if (wrong < c->loops) {
        *value = result->estimated[wrong];
        return GMV_ALARM_SIGN;
    }
    *value = swing(m, c, seen);
    if (*value > 0)
        return GMV_ALARM_BURST;
    *value = cycling(m, c, seen, result);
    if (*value > 0)
        return GMV_ALARM_BURST;
    *value = worse_than_pi(m, c, seen);
    if (*value > 0)
        return GMV_ALARM_RECORD;
    *value = jammed_away(m, c, seen);
    return *value > 0 ? GMV_ALARM_WORSE : GMV_NO_ALARM;
}

#include "kinds/gmv/gmv_trial.h"

#include <string.h>

#include "base/assertion.h"
#include "kinds/gmv/gmv_predictor.h"
#include "kinds/gmv/gmv_trial_state.h"
#include "num/real.h"

#define PIECE_STEPS 4u
/* The upset is gone at this part of it, because float ends soon below. */
#define GONE 1e-25f
/* The loop is unstable when the upset has grown by this factor; its decay is then reported as GROWS. */
#define BEYOND 1e9f
#define GROWS  1.5f
/* The second loop's setpoint steps behind the first one's, then the load comes. */
#define SECOND_AT (GMV_TRIAL_STEPS / 4u)
#define LOAD_AT   (GMV_TRIAL_STEPS / 2u)
#define UPSET(i)  ((i) ? -0.7f : 1.0f)

/* ---- copy of the parameters ---- */

static void copy_plant(struct gmv_trial_loop *l, const struct gmv *g, unsigned i)
{
    const struct gmv_shape *shape = gmv_shape(g);
    int noise = gmv_place_of_noise(shape, i);
    l->horizon = (uint8_t)gmv_horizon(shape, i);
    for (unsigned a = 0; a < shape->na; a++)
        l->f[a] = num_to_float(gmv_used(g, i, a));
    for (unsigned j = 0; j < shape->loops; j++) {
        int place = gmv_place_of_u(shape, i, j);
        l->uses[j] = place >= 0;
        l->plant_behind[j] = place >= 0 ? (uint8_t)gmv_behind(shape, i, j) : 0;
        for (unsigned b = 0; b < shape->nb && place >= 0; b++)
            l->g[j][b] = num_to_float(gmv_used(g, i, (unsigned)place + b));
    }
    for (unsigned n = 0; n < shape->nc; n++)
        l->c[n] = num_to_float(gmv_used(g, i, (unsigned)noise + n));
}

static void copy_law(struct gmv_trial *t, struct gmv_trial_loop *l, const struct gmv *g, unsigned i)
{
    struct gmv_predictor p;
    gmv_predict(g, i, &p);
    t->ng = (uint8_t)p.ng;
    for (unsigned a = 0; a < p.nf; a++)
        l->law_f[a] = num_to_float(p.f[a]);
    for (unsigned j = 0; j < t->loops; j++) {
        l->behind[j] = (uint8_t)p.behind[j];
        for (unsigned b = 0; b < p.ng; b++)
            l->law_g[j][b] = num_to_float(p.g[j][b]);
    }
}

static void begin_run(struct gmv_trial *t)
{
    memset(t->y, 0, sizeof t->y);
    memset(t->u, 0, sizeof t->u);
    memset(t->target, 0, sizeof t->target);
    memset(t->predicted, 0, sizeof t->predicted);
    t->step = 0;
    t->largest = t->first = t->start = 0;
    t->first_window = 0;
    for (unsigned i = 0; i < GMV_LOOPS; i++) {
        t->setpoint[i] = t->setpoint_before[i] = t->error[i] = 0;
        if (t->run != GMV_TRIAL_PI) /* its load is the law's */
            t->load[i] = 0;
    }
}

void gmv_trial_take(struct gmv_trial *t, const struct gmv *g, uint8_t acting, float margin,
                    const struct gmv_trial_pi *pi)
{
    const struct gmv_shape *shape = gmv_shape(g);
    memset(t, 0, sizeof *t);
    t->loops = shape->loops;
    t->na = shape->na;
    t->nb = shape->nb;
    t->nc = shape->nc;
    t->incremental = shape->form == GMV_INCREMENTAL;
    t->scalar = shape->weight == GMV_WEIGHT_SCALAR;
    t->implicit = shape->way == GMV_IMPLICIT;
    t->takes_error = shape->bias == GMV_BIAS_ERROR;
    t->determinant = num_to_float(gmv_determinant(g));
    t->gain[0] = 1;
    t->gain[1] = 1 / margin;
    t->gain[2] = margin;
    for (unsigned i = 0; i < shape->loops; i++) {
        struct gmv_trial_loop *l = &t->loop[i];
        struct gmv_filter filter = gmv_filter(g, i);
        l->acts = acting & (1u << i);
        l->weighs_setpoint = filter.weighs_setpoint;
        l->delay = shape->delay[i][i];
        l->law_p = num_to_float(filter.p);
        l->law_p_scale = num_to_float(filter.p_scale);
        l->p = t->implicit ? l->law_p : 0;
        l->p_scale = t->implicit ? l->law_p_scale : 1;
        l->lambda = num_to_float(gmv_lambda(g, i));
        l->pi = pi[i];
        copy_plant(l, g, i);
        copy_law(t, l, g, i);
    }
    begin_run(t);
}

/* ---- a step ---- */

static float steps_before(const float *signal, unsigned now, unsigned steps)
{
    return signal[(now - steps) % GMV_TRIAL_KEPT];
}

/* Returns the signal in its form: the value, or its change over k steps. */
static float taken(const struct gmv_trial *t, const float *signal, unsigned now, unsigned steps,
                   unsigned k)
{
    float value = steps_before(signal, now, steps);
    return t->incremental ? value - steps_before(signal, now, steps + k) : value;
}

/* Returns P y of this step. */
static float auxiliary_output(const struct gmv_trial_loop *l, const float *y, unsigned now)
{
    return l->law_p_scale * (steps_before(y, now, 0) - l->law_p * steps_before(y, now, 1));
}

/* Returns R w: the setpoint, or P of it. */
static float trial_setpoint(const struct gmv_trial *t, unsigned i)
{
    const struct gmv_trial_loop *l = &t->loop[i];
    float w = t->setpoint[i];
    return l->weighs_setpoint ? l->law_p_scale * (w - l->law_p * t->setpoint_before[i]) : w;
}

/* Returns P y of this step, or its change, less the prediction made a horizon ago. */
static float prediction_error(const struct gmv_trial *t, unsigned i, unsigned now)
{
    const struct gmv_trial_loop *l = &t->loop[i];
    unsigned before = now - l->delay;
    return auxiliary_output(l, t->y[i], now) - auxiliary_output(l, t->y[i], before) -
           steps_before(t->predicted[i], before, 0);
}

static bool steps_setpoints(const struct gmv_trial *t)
{
    return t->run == GMV_TRIAL_LAW || t->run == GMV_TRIAL_PI;
}

static bool has_noise(const struct gmv_trial *t)
{
    return t->run >= GMV_TRIAL_LAW_NOISE;
}

static bool is_of_pi(const struct gmv_trial *t)
{
    return t->run == GMV_TRIAL_PI || t->run == GMV_TRIAL_PI_NOISE;
}

/* Returns the PV itself; t->y is the reading. */
static float true_pv(const struct gmv_trial *t, unsigned i, unsigned now, unsigned steps)
{
    float noise = has_noise(t) && now - steps == GMV_TRIAL_KEPT ? UPSET(i) : 0;
    return steps_before(t->y[i], now, steps) - noise;
}

/* Returns MV plus load. */
static float trial_moved(const struct gmv_trial *t, unsigned j, unsigned now, unsigned steps)
{
    float load = now - steps >= GMV_TRIAL_KEPT + LOAD_AT ? t->load[j] : 0;
    return steps_before(t->u[j], now, steps) + load;
}

/* Limits the PI's signals, because its errors must stay numbers where the model is unstable under it. */
static float trial_bounded(const struct gmv_trial *t, float x)
{
    if (!is_of_pi(t))
        return x;
    return x > BEYOND ? BEYOND : x < -BEYOND ? -BEYOND : x;
}

/* Computes y_i of this step by the regression with the gains of this run, on values in either form: a constant load is all that
 * the incremental form has besides, and it is no part of the loop. */
static void move_plant(struct gmv_trial *t, unsigned i, unsigned now)
{
    const struct gmv_trial_loop *l = &t->loop[i];
    unsigned h = l->horizon;
    float sum = 0, gain = t->run < GMV_TRIAL_GAINS ? t->gain[t->run] : 1;
    for (unsigned a = 0; a < t->na; a++)
        sum += l->f[a] * true_pv(t, i, now, h + a);
    for (unsigned j = 0; j < t->loops; j++)
        for (unsigned b = 0; b < t->nb && l->uses[j]; b++)
            sum += gain * l->g[j][b] * trial_moved(t, j, now, h + l->plant_behind[j] + b);
    for (unsigned n = 0; n < t->nc; n++)
        sum += l->c[n] * steps_before(t->target[i], now, n + 1);
    t->target[i][now % GMV_TRIAL_KEPT] = sum;
    t->y[i][now % GMV_TRIAL_KEPT] =
        trial_bounded(t, sum / l->p_scale + l->p * true_pv(t, i, now, 1));
    if (now == GMV_TRIAL_KEPT && !steps_setpoints(t)) /* the upset, or a sample of noise */
        t->y[i][now % GMV_TRIAL_KEPT] += UPSET(i);
}

/* Returns the prediction of loop i's law without the moves of this step. */
static float known_prediction(const struct gmv_trial *t, unsigned i, unsigned now)
{
    const struct gmv_trial_loop *l = &t->loop[i];
    unsigned k = l->delay;
    float sum = 0;
    for (unsigned a = 0; a < t->na; a++)
        sum += l->law_f[a] * taken(t, t->y[i], now, a, k);
    for (unsigned j = 0; j < t->loops; j++)
        for (unsigned b = 0; b < t->ng && l->uses[j]; b++) {
            unsigned steps = l->behind[j] + b;
            float u = steps_before(t->u[j], now, steps ? steps : 1u);
            if (t->incremental)
                u -= steps_before(t->u[j], now, steps + k);
            sum += l->law_g[j][b] * u;
        }
    for (unsigned n = 0; n < t->nc && t->implicit; n++)
        sum += l->c[n] * steps_before(t->predicted[i], now, n + 1);
    return sum;
}

static float safely_divided(float a, float b)
{
    return real_abs(b) < 1e-6f ? 0 : a / b;
}

/* Solves the equations of the loops that act, as gmv_solve does without limits. */
static void solve_trial(const struct gmv_trial *t, float m[GMV_LOOPS][GMV_LOOPS], const float *rhs,
                        float *move)
{
    bool both = t->loop[0].acts && t->loop[1].acts;
    float a = 0, b = 0;
    for (unsigned i = 0; i < GMV_LOOPS; i++)
        move[i] = t->loop[i].acts ? safely_divided(rhs[i], m[i][i]) : 0;
    if (!both)
        return;
    a = real_abs(m[0][0]) > real_abs(m[0][1]) ? real_abs(m[0][0]) : real_abs(m[0][1]);
    b = real_abs(m[1][0]) > real_abs(m[1][1]) ? real_abs(m[1][0]) : real_abs(m[1][1]);
    float det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    if (!(real_abs(det) >= t->determinant * a * b) || det == 0)
        return;
    move[0] = (rhs[0] * m[1][1] - rhs[1] * m[0][1]) / det;
    move[1] = (rhs[1] * m[0][0] - rhs[0] * m[1][0]) / det;
}

static void move_inputs(struct gmv_trial *t, unsigned now)
{
    float m[GMV_LOOPS][GMV_LOOPS] = {{0}}, rhs[GMV_LOOPS] = {0}, move[GMV_LOOPS],
          known[GMV_LOOPS] = {0};
    for (unsigned i = 0; i < t->loops; i++) {
        const struct gmv_trial_loop *l = &t->loop[i];
        float u = steps_before(t->u[i], now, 1);
        known[i] = known_prediction(t, i, now);
        rhs[i] = trial_setpoint(t, i) - known[i];
        if (t->incremental) {
            rhs[i] -= auxiliary_output(l, t->y[i], now);
            u -= steps_before(t->u[i], now, l->delay);
        }
        if (t->takes_error)
            rhs[i] += prediction_error(t, i, now);
        if (t->scalar)
            rhs[i] -= l->lambda * u;
        for (unsigned j = 0; j < t->loops; j++)
            m[i][j] = l->behind[j] == 0 && l->uses[j] ? l->law_g[j][0] : 0;
        m[i][i] += l->lambda;
    }
    solve_trial(t, m, rhs, move);
    for (unsigned i = 0; i < t->loops; i++) {
        const struct gmv_trial_loop *l = &t->loop[i];
        float prediction = known[i];
        for (unsigned j = 0; j < t->loops; j++)
            prediction += (m[i][j] - (i == j ? l->lambda : 0)) * move[j];
        t->predicted[i][now % GMV_TRIAL_KEPT] = prediction;
    }
    for (unsigned i = 0; i < t->loops; i++)
        t->u[i][now % GMV_TRIAL_KEPT] = steps_before(t->u[i], now, 1) + move[i];
}

static void move_inputs_by_pi(struct gmv_trial *t, unsigned now)
{
    for (unsigned i = 0; i < t->loops; i++) {
        const struct gmv_trial_pi *pi = &t->loop[i].pi;
        float error = t->setpoint[i] - steps_before(t->y[i], now, 0);
        float move = pi->gain * (error - t->error[i]) + pi->integral * t->error[i];
        t->error[i] = error;
        t->u[i][now % GMV_TRIAL_KEPT] =
            trial_bounded(t, steps_before(t->u[i], now, 1) + (t->loop[i].acts ? move : 0));
    }
}

/* Steps the setpoints; then a load takes the MVs back to their first values. The bias of the law does not adapt here. */
static void move_setpoints(struct gmv_trial *t, unsigned now)
{
    unsigned step = now - GMV_TRIAL_KEPT;
    for (unsigned i = 0; i < t->loops; i++) {
        t->setpoint_before[i] = t->setpoint[i];
        if (step == i * SECOND_AT)
            t->setpoint[i] = 1;
        if (step == LOAD_AT && t->run == GMV_TRIAL_LAW && t->incremental)
            t->load[i] = -steps_before(t->u[i], now, 1);
    }
}

static void sum_answer(struct gmv_trial *t, unsigned now)
{
    for (unsigned i = 0; i < t->loops; i++) {
        struct gmv_trial_sums *s = &t->sums[is_of_pi(t)][i];
        float pv = true_pv(t, i, now, 0);
        float move = steps_before(t->u[i], now, 0) - steps_before(t->u[i], now, 1);
        if (has_noise(t)) {
            s->noise += pv * pv;
            s->moves += move * move;
        } else if (now < GMV_TRIAL_KEPT + LOAD_AT) {
            s->setpoint += real_abs(t->setpoint[i] - pv);
        } else {
            s->load += real_abs(t->setpoint[i] - pv);
        }
    }
}

/* Returns the size of the upset: PVs, and moves of MVs by their effect on them. A sum, because NaN must show in it. */
static float size_of_upset(const struct gmv_trial *t, unsigned now)
{
    float sum = 0;
    for (unsigned i = 0; i < t->loops; i++) {
        float move = steps_before(t->u[i], now, 0) - steps_before(t->u[i], now, 1);
        if (t->loop[i].acts)
            sum +=
                real_abs(steps_before(t->y[i], now, 0)) + real_abs(t->loop[i].law_g[i][0] * move);
    }
    return sum;
}

/* ---- runs ---- */

/* Compares the window that ends here with the first one that counts. True: the run is over. */
static bool judge_window(struct gmv_trial *t, unsigned window)
{
    REFLUX_ASSERT(t->run < GMV_TRIAL_GAINS);
    float now = t->largest;
    t->largest = 0;
    if (window == 0) {
        t->first = t->start = now;
        return false;
    }
    if (!(now < BEYOND * t->start)) { /* also NaN */
        t->decay[t->run] = GROWS;
        return true;
    }
    bool gone = now <= GONE * t->start;
    if (gone && window > 1) /* the decay of the windows before stands */
        return true;
    if (gone)
        now = GONE * t->start;
    t->decay[t->run] =
        real_pow(now / t->first, 1.0f / (float)((window - t->first_window) * GMV_TRIAL_WINDOW));
    if (window == 1) { /* fast modes are over */
        t->first = now;
        t->first_window = 1;
    }
    return gone || window + 1u == GMV_TRIAL_STEPS / GMV_TRIAL_WINDOW;
}

static void one_step(struct gmv_trial *t)
{
    unsigned now = GMV_TRIAL_KEPT + t->step;
    bool over;
    for (unsigned i = 0; i < t->loops; i++)
        if (t->loop[i].acts)
            move_plant(t, i, now);
    if (steps_setpoints(t))
        move_setpoints(t, now);
    if (is_of_pi(t))
        move_inputs_by_pi(t, now);
    else
        move_inputs(t, now);
    t->step++;
    if (t->run >= GMV_TRIAL_GAINS) {
        sum_answer(t, now);
        over = t->step == GMV_TRIAL_STEPS;
    } else {
        float size = size_of_upset(t, now);
        if (!(size <= t->largest))
            t->largest = size;
        over = t->step % GMV_TRIAL_WINDOW == 0 && judge_window(t, t->step / GMV_TRIAL_WINDOW - 1u);
    }
    if (!over)
        return;
    t->run++;
    if (t->run == GMV_TRIAL_GAINS && !(gmv_trial_worst(t) <= 1)) /* no further runs: it grows */
        t->run = GMV_TRIAL_RUNS;
    begin_run(t);
}

bool gmv_trial_piece(struct gmv_trial *t)
{
    for (unsigned n = 0; n < PIECE_STEPS && t->run < GMV_TRIAL_RUNS; n++)
        one_step(t);
    return t->run < GMV_TRIAL_RUNS;
}

void gmv_trial_again(struct gmv_trial *t, float times)
{
    for (unsigned i = 0; i < t->loops; i++)
        t->loop[i].lambda *= times;
    memset(t->decay, 0, sizeof t->decay);
    memset(t->sums, 0, sizeof t->sums);
    t->run = 0;
    begin_run(t);
}

bool gmv_trial_acts(const struct gmv_trial *t, unsigned i)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return t->loop[i].acts;
}

float gmv_trial_decay(const struct gmv_trial *t, unsigned run)
{
    REFLUX_ASSERT(run < GMV_TRIAL_GAINS);
    return t->decay[run];
}

float gmv_trial_worst(const struct gmv_trial *t)
{
    float worst = t->decay[0];
    for (unsigned run = 1; run < GMV_TRIAL_GAINS; run++)
        worst = t->decay[run] > worst ? t->decay[run] : worst;
    return worst;
}

/* Returns x, at most `most`; NaN gives `most`. */
static float not_above(float x, float most)
{
    return x < most ? x : most;
}

static float part_of_pi(float a, float b)
{
    return not_above(a / b, 1000);
}

/* A positional law is not tried on loads, because the adaptation of its bias is not simulated. */
float gmv_trial_ratio(const struct gmv_trial *t, const float *answer)
{
    float worst = 0;
    for (unsigned i = 0; i < t->loops; i++) {
        const struct gmv_trial_sums *law = &t->sums[0][i], *pi = &t->sums[1][i];
        bool is_known = answer[i] > 0 && answer[i] < pi->setpoint;
        float setpoint = part_of_pi(law->setpoint, is_known ? answer[i] : pi->setpoint);
        float load = t->incremental && pi->load > 0 ? part_of_pi(law->load, pi->load) : 0;
        if (!t->loop[i].acts)
            continue;
        worst = setpoint > worst ? setpoint : worst;
        worst = load > worst ? load : worst;
    }
    return worst;
}

void gmv_trial_noise(const struct gmv_trial *t, unsigned i, float *error_more, float *moves)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    const struct gmv_trial_sums *law = &t->sums[0][i], *pi = &t->sums[1][i];
    float sample = UPSET(i) * UPSET(i);
    *error_more = not_above((law->noise - pi->noise) / sample, 1e6f);
    *moves = not_above(law->moves / sample, 1e6f);
}

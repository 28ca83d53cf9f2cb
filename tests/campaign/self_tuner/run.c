/* A week of a case: the block with its supervision, and its PI on a plant of its own with the same noise. */
#include <math.h>
#include <stdlib.h>

#include "self_tuner.h"

#define DAY_S        86400.0
#define ERROR_TIMES  4.0 /* the limits of docs/methods/self-tuning.md */
#define MOVE_TIMES   9.0
#define ERROR_LEAST  0.005
#define WINDOWS_MOST 1200u
#define LAST_S       (DAY_S / 4) /* setpoints move as at first */

struct side { /* the block's plant, or the PI's */
    struct linear_plant plant;
    double u[GMV_LOOPS], iae[GMV_LOOPS], measured_iae[GMV_LOOPS];
    float move[WINDOWS_MOST][GMV_LOOPS], error[WINDOWS_MOST][GMV_LOOPS]; /* mean squares */
};

struct week {
    const struct tuner_case *c;
    struct side block, pi;
    struct pid controller[GMV_LOOPS];
    struct random_source noise, events;
    double w[GMV_LOOPS], load[GMV_LOOPS], next_move_s[GMV_LOOPS], next_load_s, length_s, time_s;
    double marked[2][GMV_LOOPS]; /* IAE of block and PI at the last mark */
    unsigned window, steps;
    bool rests[WINDOWS_MOST][GMV_LOOPS], law[WINDOWS_MOST], given_up;
    double moved_at_s[GMV_LOOPS];
};

static struct gmv_block_bench bench;
static struct week week;

/* ---- settings ---- */

static bool put_setting(const char *text)
{
    const char *value = strchr(text, '=');
    for (unsigned k = 0; value && k < gmv_kind.parameters; k++) {
        const struct block_parameter *p = &gmv_kind.parameter[k];
        if (strlen(p->name) != (size_t)(value - text) ||
            strncmp(p->name, text, (size_t)(value - text)) != 0)
            continue;
        for (unsigned i = 0; i < (unsigned)p->rows * p->cols; i++)
            block_put_value(&bench.settings, p, i, strtof(value + 1, NULL));
        return true;
    }
    return false;
}

static bool begin(const struct tuner_case *c, const char *const *set, unsigned sets, double days)
{
    unsigned loops = c->plant.loops;
    memset(&week, 0, sizeof week);
    week.c = c;
    week.length_s = days * DAY_S;
    week.noise.state = c->seed;
    week.events.state = c->seed ^ 0x5555u;
    plant_begin(&week.block.plant, &c->plant);
    plant_begin(&week.pi.plant, &c->plant);
    block_put_defaults(&bench.settings, &gmv_kind);
    for (unsigned i = 0; i < loops; i++) {
        bench.settings.tune_gain[i] = c->pi_gain[i];
        bench.settings.tune_ti_s[i] = c->pi_ti_s[i];
        for (unsigned j = 0; j < loops; j++)
            bench.settings.delay[i][j] = (uint16_t)c->delay[i][j];
        week.w[i] = REST;
        week.next_move_s[i] = 600 + i * c->move_s / 2;
    }
    week.next_load_s = DAY_S;
    bench.settings.check_time_s = (float)fmax(1800, 10 * c->step_s);
    bench.settings.form = c->positional ? GMV_POSITIONAL : GMV_INCREMENTAL;
    for (unsigned k = 0; k < sets; k++)
        if (!put_setting(set[k]))
            return false;
    if (!gmv_block_begin(&bench, (float)c->step_s, loops, 0, (float)REST))
        return false;
    for (unsigned i = 0; i < loops; i++) {
        week.controller[i] = gmv_bench_block(&bench)->shadow.pi[i]; /* the same */
        pid_follow(&week.controller[i], num_from_float((float)REST), num_from_float((float)REST),
                   num_from_float((float)REST));
    }
    return true;
}

/* ---- a step ---- */

/* The first day and the last quarter of one have moves one after the other; between them there is one in six hours, or none. */
static void prepare(void)
{
    const struct tuner_case *c = week.c;
    for (unsigned i = 0; i < c->plant.loops; i++) {
        if (week.time_s < week.next_move_s[i])
            continue;
        bool busy = week.time_s < DAY_S || week.time_s >= week.length_s - LAST_S;
        double far = c->size * random_uniform(&week.events, 0.5, 1);
        week.w[i] = REST + (week.w[i] > REST || (week.w[i] == REST && i) ? -far : far);
        week.next_move_s[i] = week.time_s + (busy                       ? c->move_s
                                             : c->schedule == WEEK_REST ? week.length_s
                                                                        : DAY_S / 4);
        if (!busy && c->schedule == WEEK_REST)
            week.w[i] = REST;
        if (week.time_s < week.length_s - LAST_S && week.next_move_s[i] > week.length_s - LAST_S)
            week.next_move_s[i] = week.length_s - LAST_S + i * c->move_s / 2;
        week.moved_at_s[i] = week.time_s;
    }
    if (c->schedule == WEEK_LOADS && week.time_s >= week.next_load_s) {
        unsigned j = (unsigned)random_next(&week.events) & (c->plant.loops - 1u);
        week.load[j] = random_uniform(&week.events, -0.08, 0.08);
        week.next_load_s += random_uniform(&week.events, 0.1, 0.5) * DAY_S;
    }
}

static void sum_up(struct side *s, unsigned i, double measured, double u)
{
    float *move = &s->move[week.window][i], *error = &s->error[week.window][i];
    double away = week.w[i] - measured;
    s->iae[i] += fabs(week.w[i] - plant_pv(&s->plant, i));
    s->measured_iae[i] += fabs(away);
    *move += (float)((u - s->u[i]) * (u - s->u[i]) / WINDOW);
    *error += (float)(away * away / WINDOW);
    s->u[i] = u;
}

static void plants_go_on(void)
{
    for (unsigned t = 0; t < (unsigned)week.c->step_s; t++) {
        plant_second(&week.block.plant, week.block.u, week.load);
        plant_second(&week.pi.plant, week.pi.u, week.load);
    }
    week.time_s += week.c->step_s;
}

static void step_of_pi(unsigned i, double measured)
{
    num_t u = pid_step(&week.controller[i], num_from_float((float)week.w[i]),
                       num_from_float((float)measured));
    u = num_clamp(u, num_zero(), num_one());
    pid_back_calculate(&week.controller[i], u, 0);
    sum_up(&week.pi, i, measured, (double)num_to_float(u) - REST);
}

static void step(void)
{
    unsigned loops = week.c->plant.loops;
    double y[GMV_LOOPS];
    prepare();
    for (unsigned i = 0; i < loops; i++) {
        double noise = week.c->plant.noise[i] * random_normal(&week.noise);
        y[i] = plant_pv(&week.block.plant, i) + noise;
        step_of_pi(i, plant_pv(&week.pi.plant, i) + noise);
        gmv_block_signals(&bench, i, week.w[i], y[i]);
    }
    if (week.given_up) { /* the loops' own controllers, the same PI */
        struct gmv_block *s = (struct gmv_block *)(void *)bench.state;
        for (unsigned i = 0; i < loops; i++) {
            num_t u = num_clamp(pid_step(&s->shadow.pi[i], bench.setpoint[i], bench.in[i]),
                                num_zero(), num_one());
            pid_back_calculate(&s->shadow.pi[i], u, 0);
            bench.out[i] = u;
        }
    } else if (!gmv_block_step(&bench)) {
        week.given_up = true;
    }
    for (unsigned i = 0; i < loops; i++)
        sum_up(&week.block, i, y[i], (double)num_to_float(bench.out[i]) - REST);
    plants_go_on();
}

static void close_window(void)
{
    for (unsigned i = 0; i < week.c->plant.loops; i++)
        week.rests[week.window][i] =
            week.time_s - week.moved_at_s[i] > WINDOW * week.c->step_s + week.c->move_s / 2;
    week.window++;
    week.steps = 0;
}

/* ---- judging ---- */

/* The worse loop. */
static double ratio_since_mark(bool mark)
{
    double worst = 0;
    for (unsigned i = 0; i < week.c->plant.loops; i++) {
        double ratio = (week.block.iae[i] - week.marked[0][i]) /
                       fmax(week.pi.iae[i] - week.marked[1][i], 1e-9);
        worst = fmax(worst, ratio);
        if (mark) {
            week.marked[0][i] = week.block.iae[i];
            week.marked[1][i] = week.pi.iae[i];
        }
    }
    return worst;
}

static void judge_windows(struct tuner_result *r)
{
    for (unsigned i = 0; i < week.c->plant.loops; i++) {
        double move = 0, error = 0;
        unsigned rests = 0, beyond = 0, beyond_moves = 0;
        for (unsigned k = 0; k < week.window; k++)
            if (week.rests[k][i]) {
                rests++;
                move += (double)week.pi.move[k][i];
                error += (double)week.pi.error[k][i];
            }
        for (unsigned k = 0; k < week.window && rests; k++) {
            double own_error = (double)week.block.error[k][i];
            double of_pi = fmax(error / rests, (double)week.pi.error[k][i]);
            bool moves = week.rests[k][i] && week.law[k] &&
                         (double)week.block.move[k][i] >
                             MOVE_TIMES * fmax(move / rests, (double)week.pi.move[k][i]);
            bool errs = own_error > ERROR_TIMES * of_pi && own_error > ERROR_LEAST * ERROR_LEAST;
            beyond = moves && errs ? beyond + 1u : 0;
            beyond_moves = moves && own_error >= of_pi && own_error > 1e-6 ? beyond_moves + 1u : 0;
            if (beyond > r->beyond_most)
                r->beyond_most = beyond;
            if (beyond_moves > r->beyond_moves_most)
                r->beyond_moves_most = beyond_moves;
        }
    }
}

static void note_supervision(struct tuner_result *r, bool *acted)
{
    const struct gmv_block *s = gmv_bench_block(&bench);
    bool acts = !week.given_up && s->watch.status.state == GMV_SELF_TUNING;
    week.law[week.window] = week.law[week.window] || acts;
    r->lawful += acts;
    if (acts && !*acted) {
        r->adoptions++;
        if (r->adoptions == 1) {
            r->adopted_s = week.time_s;
        }
    }
    if (acts && week.time_s <= DAY_S)
        r->g0_begun = (double)gmv_own_gain(gmv_of_const(s), 0);
    if (acts && week.time_s <= week.length_s - LAST_S)
        r->g0_rest = (double)gmv_own_gain(gmv_of_const(s), 0);
    if (*acted && !acts) {
        r->returns++;
        for (unsigned k = 0; k < 8; k++)
            r->by[k] += (unsigned)s->watch.status.alarms >> k & 1u;
    }
    *acted = acts;
    if (week.given_up && r->ended_s == 0)
        r->ended_s = week.time_s;
}

bool run_case(const struct tuner_case *c, const char *const *set, unsigned sets, double days,
              struct tuner_result *r)
{
    bool acted = false, begun = false, first = false, last = false;
    double whole = 0, measured = 0;
    memset(r, 0, sizeof *r);
    r->first_ratio = r->last_ratio = 1;
    if (!begin(c, set, sets, days))
        return false;
    unsigned long steps = 0;
    while (week.time_s < week.length_s && week.window + 1u < WINDOWS_MOST) {
        step();
        steps++;
        note_supervision(r, &acted);
        if (++week.steps == WINDOW)
            close_window();
        if (!begun && week.time_s >= DAY_S - LAST_S) {
            (void)ratio_since_mark(true);
            begun = true;
        }
        if (!first && week.time_s >= DAY_S) {
            r->first_ratio = ratio_since_mark(true);
            first = true;
        }
        if (!last && week.time_s >= week.length_s - LAST_S) {
            (void)ratio_since_mark(true);
            last = true;
        }
    }
    r->last_ratio = ratio_since_mark(false);
    r->lawful /= (double)steps;
    for (unsigned i = 0; i < c->plant.loops; i++) {
        whole = fmax(whole, week.block.iae[i] / week.pi.iae[i]);
        measured = fmax(measured, week.block.measured_iae[i] / week.pi.measured_iae[i]);
    }
    r->ratio = whole;
    r->measured_ratio = measured;
    judge_windows(r);
    return true;
}

/* Between ticks: the responses from the model, Gd/Gp from them, the band, models and rule, and the search. */
#include "kinds/ff_tune/feedforward_tune_block.h"

#define ONE REAL_C(1.0)

/* Of the grid where no band is set: rad per sample, and of the high-pass. */
#define GRID_LO    REAL_C(0.02)
#define GRID_HI    REAL_C(0.8)
#define ABOVE_BIAS REAL_C(4.0)
/* Where the sensitivity stays below 0 dB: the band is where it is above half of its largest. */
#define BELOW_PEAK REAL_C(0.5)

void tune_make_grid(struct tune *t)
{
    real_t lo = t->s.band_lo, hi = t->s.band_hi;
    if (!(lo > 0)) {
        real_t bias = t->s.bias_s > 0 ? t->s.bias_s : REAL_C(0.25) * t->s.learn_s;
        real_t above = ABOVE_BIAS / bias;
        hi = GRID_HI / t->h_s;
        lo = GRID_LO / t->h_s;
        lo = above > lo && above < REAL_C(0.5) * hi ? above : lo;
    }
    real_t step = real_log(hi / lo) / (real_t)(FEEDFORWARD_POINTS - 1u);
    t->points = FEEDFORWARD_POINTS;
    for (unsigned i = 0; i < t->points; i++)
        t->omega[i] = lo * real_exp(step * (real_t)i);
}

void tune_ask_look(struct tune *t, bool look_only)
{
    t->look_only = look_only;
    t->work = WORK_RESPONSES;
    t->work_at = 0;
    t->computing = t->reading = true;
    t->outcome = TUNE_NONE;
    t->moved = t->size = 0;
    t->since_look = 0;
}

/* ---- responses ---- */

static struct cplx element_at(const struct tune *t, real_t omega)
{
    const struct feedforward_shape f = {
        .k = t->s.k, .lead = t->s.lead_s, .lag = t->s.lag_s, .dead = t->s.dead_s};
    return feedforward_response(&f, t->tick_s, omega);
}

static struct loop_response loop_at(const struct tune *t, real_t omega)
{
    struct loop_response l;
    loop_response_of_pi(&l, t->s.gain, t->s.ti_s, t->s.b, true, t->tick_s, omega * t->tick_s);
    l.feedforward = element_at(t, omega);
    return l;
}

/* By how much it has moved since the last look, weighted as J is. */
static void compare_looks(struct tune *t, unsigned i, struct cplx before, struct cplx now)
{
    real_t weight = ONE / t->omega[i];
    t->moved += weight * cplx_abs(cplx_sub(now, before));
    t->size += weight * cplx_abs(now);
}

static enum err look_at_point(struct tune *t, unsigned i)
{
    const struct high_order *h = tune_model(t);
    real_t omega_h = t->omega[i] * t->h_s;
    struct tune_responses *to = t->stage == TUNE_LOOP ? &t->loop
                                : tune_is_staged(t)   ? &t->disturbance
                                                      : &t->ratio;
    struct cplx before = to->at[i].is;
    enum err err;
    if (tune_is_staged(t)) {
        err = high_order_response(h, 0, omega_h, &to->at[i]);
    } else {
        err = high_order_ratio(h, omega_h, &to->at[i]);
        if (!err)
            err = high_order_response(h, 0, omega_h, &t->loop.at[i]);
    }
    if (!err)
        compare_looks(t, i, before, to->at[i].is);
    return err;
}

/* ---- the ratio, and where it counts ---- */

/* The process stands in process[] then; of A and B it is what was identified. */
static enum err ratio_at_point(struct tune *t, unsigned i, struct high_order_point *process,
                               struct high_order_point *sensitivity)
{
    struct loop_response l = loop_at(t, t->omega[i]);
    const struct high_order_point *loop = &t->loop.at[i], *of_d = &t->disturbance.at[i];
    enum err err = ERR_OK;
    *process = *loop;
    switch (t->s.method) {
    case TUNE_SENSITIVITY:
        err = ratio_from_process(loop, of_d, &l, &t->ratio.at[i]);
        break;
    case TUNE_TRACKING:
        err = ratio_from_tracking(loop, of_d, &l, &t->ratio.at[i]);
        break;
    case TUNE_INPUT:
        err = ratio_from_input(loop, of_d, &l, &t->ratio.at[i]);
        break;
    default:
        break;
    }
    if (!err && (t->s.method == TUNE_TRACKING || t->s.method == TUNE_INPUT))
        err = process_from_tracking(loop, &l, process);
    return err ? err : sensitivity_from_ratio(process, &t->ratio.at[i], &l, sensitivity);
}

/* 3.2: where the disturbance comes through the loop stronger than it is, without feedforward. Contiguous, about the largest
 * that is known. */
static enum tune_verdict find_band(struct tune *t, const struct high_order_point *sensitivity)
{
    real_t largest = 0;
    unsigned at = 0;
    for (unsigned i = 0; i < t->points; i++) {
        real_t size = cplx_abs(sensitivity[i].is);
        if (tune_is_known(t, &sensitivity[i]) && size > largest) {
            largest = size;
            at = i;
        }
    }
    if (!(largest > 0))
        return TUNE_UNSURE;
    t->band_from = 0;
    t->band_to = t->points;
    if (t->s.band_lo > 0)
        return TUNE_NONE;
    real_t level = largest > ONE ? ONE : BELOW_PEAK * largest;
    unsigned from = at, to = at + 1u;
    while (from > 0 && cplx_abs(sensitivity[from - 1u].is) > level)
        from--;
    while (to < t->points && cplx_abs(sensitivity[to].is) > level)
        to++;
    t->band_from = (uint8_t)from;
    t->band_to = (uint8_t)to;
    return to - from < TUNE_POINTS_LEAST ? TUNE_NO_BAND : TUNE_NONE;
}

/* What the shadow can test. */
static real_t most_dead(const struct tune *t)
{
    real_t reach = tune_dead_reach(t);
    return t->s.dead_most_s < reach ? t->s.dead_most_s : reach;
}

/* What the search is to fit: a frequency at which the ratio is not known counts nothing. */
static enum tune_verdict want_ratio(struct tune *t)
{
    struct feedforward_wanted *w = &t->wanted;
    real_t doubted = 0, all = 0;
    unsigned known = 0;
    *w = (struct feedforward_wanted){.points = (uint8_t)(t->band_to - t->band_from),
                                     .h_s = t->tick_s,
                                     .kick = t->s.kick,
                                     .lag_most = t->s.lag_most_s,
                                     .dead_most = most_dead(t)};
    for (unsigned k = 0; k < w->points; k++) {
        unsigned i = t->band_from + k;
        const struct high_order_point *r = &t->ratio.at[i];
        real_t weight = ONE / (t->omega[i] * t->h_s), size = cplx_abs(r->is);
        bool is_known = tune_is_known(t, r);
        w->omega[k] = t->omega[i];
        w->ratio[k] = r->is;
        w->weight[k] = is_known ? weight : 0;
        known += is_known ? 1u : 0u;
        doubted += weight * t->s.doubt * r->sd;
        all += weight * size;
    }
    t->spread = all > 0 ? doubted / all : ONE;
    t->unsure = !(t->spread <= t->s.confident / 100);
    return known >= TUNE_POINTS_LEAST ? TUNE_NONE : TUNE_UNSURE;
}

/* ---- pieces ---- */

static void end_work(struct tune *t, enum tune_verdict outcome)
{
    t->outcome = (uint8_t)outcome;
    t->work = WORK_NONE;
}

static void response_piece(struct tune *t)
{
    if (look_at_point(t, t->work_at)) {
        end_work(t, TUNE_UNSURE);
        return;
    }
    if (++t->work_at < t->points)
        return;
    t->change = t->size > 0 ? t->moved / t->size : ONE;
    t->work = t->look_only ? WORK_NONE : WORK_RATIO;
}

static void ratio_piece(struct tune *t)
{
    struct high_order_point sensitivity[FEEDFORWARD_POINTS];
    enum tune_verdict verdict = TUNE_NONE;
    t->rule.there = t->by_rule = false;
    t->fitting = false;
    for (unsigned i = 0; i < t->points && verdict == TUNE_NONE; i++)
        if (ratio_at_point(t, i, &t->process[i], &sensitivity[i]))
            verdict = TUNE_UNSURE;
    if (verdict == TUNE_NONE)
        verdict = find_band(t, sensitivity);
    if (verdict == TUNE_NONE)
        verdict = want_ratio(t);
    if (verdict != TUNE_NONE)
        end_work(t, verdict);
    else
        t->work = WORK_PROCESS;
}

static void process_piece(struct tune *t)
{
    bool more;
    enum tune_verdict verdict = tune_process_piece(t, &more);
    if (verdict != TUNE_NONE)
        end_work(t, verdict);
    else if (!more)
        t->work = WORK_PATH;
}

/* Where the ratio is in too much doubt for a search the rule is what is left. */
static void path_piece(struct tune *t)
{
    bool more;
    tune_path_piece(t, &more);
    if (more)
        return;
    if (!t->unsure) {
        feedforward_search_begin(&t->search, &t->wanted);
        if (t->rule.there)
            feedforward_search_near(&t->search, &t->wanted, &t->rule.shape);
        t->work = WORK_SEARCH;
        return;
    }
    t->search.j0 = feedforward_objective(&t->wanted, &(const struct feedforward_shape){0});
    t->search.j = t->rule.j;
    bool falls_back = tune_falls_back(t);
    if (falls_back)
        tune_take_rule(t);
    end_work(t, falls_back ? TUNE_NONE : TUNE_UNSURE);
}

static void search_piece(struct tune *t)
{
    if (feedforward_search_piece(&t->search, &t->wanted))
        return;
    t->candidate = t->search.best;
    end_work(t, TUNE_NONE);
}

bool tune_work(void *state)
{
    struct tune *t = state;
    switch (t->work) {
    case WORK_RESPONSES:
        response_piece(t);
        break;
    case WORK_RATIO:
        ratio_piece(t);
        break;
    case WORK_PROCESS:
        process_piece(t);
        break;
    case WORK_PATH:
        path_piece(t);
        break;
    case WORK_SEARCH:
        search_piece(t);
        break;
    default:
        return false;
    }
    t->pieces = (uint16_t)(t->pieces > 0 ? t->pieces - 1u : 0);
    return t->work != WORK_NONE && t->pieces > 0;
}

#include "kinds/ff_tune/tune_search.h"

#include "base/assertion.h"
#include "kinds/ff_tune/tune_search_state.h"

#define ONE REAL_C(1.0)

/* ---- in the tick ---- */

void tune_search_ask(struct tune_search *s, bool look_only)
{
    s->look_only = look_only;
    s->work = WORK_RESPONSES;
    s->point = 0;
    s->computing = s->reading = true;
    s->outcome = TUNE_NONE;
}

void tune_search_cancel(struct tune_search *s)
{
    s->computing = s->reading = false;
}

bool tune_search_step(struct tune_search *s, const struct tune_context *c, struct block_io *io)
{
    s->idle = !io->requests.work_wanted;
    if (!s->computing || !s->idle)
        return false;
    s->reading = s->work == WORK_RESPONSES;
    if (s->work == WORK_NONE) {
        tune_search_cancel(s);
        return true;
    }
    s->pieces = c->pieces;
    io->requests.ask_work = 1;
    return false;
}

bool tune_search_computes(const struct tune_search *s)
{
    return s->computing;
}

bool tune_search_is_idle(const struct tune_search *s)
{
    return s->idle;
}

bool tune_search_reads(const struct tune_search *s)
{
    return s->reading;
}

bool tune_search_was_look(const struct tune_search *s)
{
    return s->look_only;
}

enum tune_verdict tune_search_outcome(const struct tune_search *s)
{
    return (enum tune_verdict)s->outcome;
}

/* ---- the candidate ---- */

const struct feedforward_shape *tune_candidate(const struct tune_search *s)
{
    return &s->candidate;
}

bool tune_candidate_is_rule(const struct tune_search *s)
{
    return s->by_rule;
}

real_t tune_search_spread(const struct tune_search *s)
{
    return s->spread;
}

const struct feedforward_search *tune_search_result(const struct tune_search *s)
{
    return &s->search;
}

bool tune_search_falls_back(const struct tune_search *s, const struct tune_context *c,
                            const struct tune_rule *rule)
{
    return c->s.rules && rule->valid && !s->by_rule && rule->j < s->search.j0;
}

void tune_search_take_rule(struct tune_search *s, const struct tune_rule *rule)
{
    s->candidate = rule->shape;
    s->by_rule = true;
}

/* ---- between ticks ---- */

/* The dead time that the shadow can test. */
static real_t most_dead(const struct tune_context *c)
{
    real_t reach = tune_dead_reach(c);
    return c->s.dead_most_s < reach ? c->s.dead_most_s : reach;
}

/* Sets what the search is to fit: a frequency at which the ratio is not known counts nothing. */
static enum tune_verdict want_ratio(struct tune_search *s, const struct tune_context *c,
                                    const struct tune_band *b)
{
    REFLUX_ASSERT(b->from <= b->to && b->to <= FEEDFORWARD_POINTS);
    struct feedforward_wanted *w = &s->wanted;
    real_t doubted = 0, all = 0;
    unsigned known = 0;
    *w = (struct feedforward_wanted){.points = (uint8_t)(b->to - b->from),
                                     .h_s = c->tick_s,
                                     .kick = c->s.kick,
                                     .lag_most = c->s.lag_most_s,
                                     .dead_most = most_dead(c)};
    for (unsigned k = 0; k < w->points; k++) {
        unsigned i = b->from + k;
        const struct high_order_point *r = &b->ratio[i];
        real_t weight = ONE / (b->omega[i] * c->h_s), size = cplx_abs(r->value);
        bool is_known = tune_is_known(c, r);
        w->omega[k] = b->omega[i];
        w->ratio[k] = r->value;
        w->weight[k] = is_known ? weight : 0;
        known += is_known ? 1u : 0u;
        doubted += weight * c->s.doubt * r->sd;
        all += weight * size;
    }
    s->spread = all > 0 ? doubted / all : ONE;
    s->unsure = !(s->spread <= c->s.confident / 100);
    return known >= TUNE_POINTS_LEAST ? TUNE_NONE : TUNE_UNSURE;
}

static void end_work(struct tune_search *s, enum tune_verdict outcome)
{
    s->outcome = (uint8_t)outcome;
    s->work = WORK_NONE;
}

static void response_piece(struct tune_search *s, const struct tune_context *c,
                           struct tune_responses *r, const struct high_order *estimator,
                           bool of_loop)
{
    if (s->point == 0)
        tune_responses_look(r);
    if (tune_responses_point(r, c, estimator, s->point, of_loop)) {
        end_work(s, TUNE_UNSURE);
        return;
    }
    if (++s->point < tune_responses_band(r)->points)
        return;
    tune_responses_looked(r);
    s->work = s->look_only ? WORK_NONE : WORK_RATIO;
}

static void ratio_piece(struct tune_search *s, const struct tune_context *c,
                        struct tune_responses *r, struct tune_paths *paths)
{
    s->by_rule = false;
    tune_paths_begin(paths);
    enum tune_verdict verdict = tune_responses_ratio(r, c);
    if (verdict == TUNE_NONE)
        verdict = want_ratio(s, c, tune_responses_band(r));
    if (verdict != TUNE_NONE)
        end_work(s, verdict);
    else
        s->work = WORK_PROCESS;
}

static void process_piece(struct tune_search *s, const struct tune_context *c,
                          const struct tune_band *band, struct tune_paths *paths)
{
    bool more;
    enum tune_verdict verdict = tune_process_piece(paths, c, band, &more);
    if (verdict != TUNE_NONE)
        end_work(s, verdict);
    else if (!more)
        s->work = WORK_PATH;
}

/* If the ratio is in too much doubt for a search, only the rule is left. */
static void path_piece(struct tune_search *s, const struct tune_context *c,
                       const struct tune_band *band, struct tune_paths *paths)
{
    const struct tune_rule *rule = tune_paths_rule(paths);
    bool more;
    tune_path_piece(paths, c, band, &s->wanted, &more);
    if (more)
        return;
    if (!s->unsure) {
        feedforward_search_begin(&s->search, &s->wanted);
        if (rule->valid)
            feedforward_search_near(&s->search, &s->wanted, &rule->shape);
        s->work = WORK_SEARCH;
        return;
    }
    feedforward_search_skip(&s->search, &s->wanted, rule->j);
    bool falls_back = tune_search_falls_back(s, c, rule);
    if (falls_back)
        tune_search_take_rule(s, rule);
    end_work(s, falls_back ? TUNE_NONE : TUNE_UNSURE);
}

static void search_piece(struct tune_search *s)
{
    if (feedforward_search_piece(&s->search, &s->wanted))
        return;
    s->candidate = s->search.best;
    end_work(s, TUNE_NONE);
}

bool tune_search_piece(struct tune_search *s, const struct tune_context *c,
                       struct tune_responses *r, struct tune_paths *paths,
                       const struct high_order *estimator, bool of_loop)
{
    const struct tune_band *band = tune_responses_band(r);
    switch (s->work) {
    case WORK_RESPONSES:
        response_piece(s, c, r, estimator, of_loop);
        break;
    case WORK_RATIO:
        ratio_piece(s, c, r, paths);
        break;
    case WORK_PROCESS:
        process_piece(s, c, band, paths);
        break;
    case WORK_PATH:
        path_piece(s, c, band, paths);
        break;
    case WORK_SEARCH:
        search_piece(s);
        break;
    default:
        return false;
    }
    s->pieces = (uint16_t)(s->pieces > 0 ? s->pieces - 1u : 0);
    return s->work != WORK_NONE && s->pieces > 0;
}

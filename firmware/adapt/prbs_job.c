/* The model of the kind `experiment` from its record, output by output, in pieces of the main loop. From the first two thirds: for every order
 * of A the best lags of B by the criterion, and parameters by the method. Then each simulates the last third, which it has not
 * seen, and the lowest order is taken that does about as well as the best: noise draws the criterion, which compares least squares, to
 * orders that are too high, whose other models may not even be stable. In the end its parameters from all of the record, or, where that
 * gives no stable model, those that were judged. */
#include "adapt/prbs_inside.h"

#if CONFIG_BLOCKS

#include <string.h>

/* Samples of a piece. */
#define PIECE 16u

static void begin_orders(struct experiment_block *b)
{
    struct experiment_work *w = b->work;
    w->phase = PHASE_ORDERS;
    arx_select_begin(&w->selecting, &w->data, w->output, (uint8_t)b->s.na, (uint8_t)b->s.nb, true,
                     (enum arx_criterion)b->s.criterion, 0, b->samples / 3u * 2u, &w->search);
}

static void begin_fit(struct experiment_block *b, enum experiment_phase phase, uint32_t to)
{
    struct experiment_work *w = b->work;
    w->phase = (uint8_t)phase;
    arx_fit_begin(&w->fitting, &w->data, w->output, &w->orders, (enum arx_method)b->s.method, 0, to,
                  &w->search.work, &w->fit[w->output]);
}

/* An output is over. */
static void next_output(struct experiment_block *b, enum experiment_doubt doubt)
{
    struct experiment_work *w = b->work;
    if (doubt)
        w->found[w->output].doubt = (uint8_t)doubt;
    w->output++;
    if (w->output < b->outputs)
        begin_orders(b);
    else
        w->phase = PHASE_OVER;
}

void experiment_begin_finding(struct experiment_block *b)
{
    struct experiment_work *w = b->work;
    memset(w->found, 0, sizeof w->found);
    w->output = 0;
    begin_orders(b);
}

/* 1: all of it; 0: no better than its mean. */
static float explained(real_t squares, const struct arx_judgement *j)
{
    return j->squares > 0 ? (float)(REAL_C(1.0) - real_sqrt(squares / j->squares)) : 0;
}

/* ---- one candidate after the other ---- */

/* Of that na the best by the criterion, if any could be told. */
static bool find_trial(const struct arx_search *search, uint8_t na, uint16_t *best)
{
    bool found = false;
    for (uint16_t t = 0; t < search->trials; t++) {
        const struct arx_trial *trial = &search->trial[t];
        if (trial->err || trial->orders.na != na ||
            (found && !(trial->criterion < search->trial[*best].criterion)))
            continue;
        *best = t;
        found = true;
    }
    return found;
}

static void take_orders(struct experiment_block *b, uint8_t na)
{
    struct experiment_work *w = b->work;
    w->orders = w->search.trial[w->trial[na]].orders;
    if (b->s.method == ARX_ELS)
        w->orders.nc = w->orders.na < ARX_C_MOST ? w->orders.na : ARX_C_MOST;
}

/* The lowest order within a twentieth of the least squares of simulation. Past na: none stands. */
static uint8_t best_candidate(const struct experiment_block *b)
{
    const struct experiment_work *w = b->work;
    real_t least = REAL_C(-1.0);
    uint8_t na = 0;
    for (uint8_t k = 0; k <= b->s.na; k++)
        if (w->stands[k] && (least < 0 || w->did[k].simulated_squares < least))
            least = w->did[k].simulated_squares;
    while (na <= b->s.na &&
           !(w->stands[na] && w->did[na].simulated_squares <= REAL_C(1.05) * least))
        na++;
    return na;
}

static void choose_orders(struct experiment_block *b)
{
    struct experiment_work *w = b->work;
    struct experiment_found *found = &w->found[w->output];
    uint8_t na = best_candidate(b);
    if (na > b->s.na) {
        next_output(b, w->unstable ? DOUBT_UNSTABLE : DOUBT_STILL);
        return;
    }
    const struct arx_judgement *did = &w->did[na];
    take_orders(b, na);
    found->na = na;
    memcpy(found->first, w->orders.first, sizeof found->first);
    memcpy(found->last, w->orders.last, sizeof found->last);
    found->fit = explained(did->simulated_squares, did);
    found->step = explained(did->step_squares, did);
    if (!(found->fit >= b->s.fit_least))
        next_output(b, DOUBT_UNEXPLAINED);
    else
        begin_fit(b, PHASE_WHOLE, b->samples);
}

/* The next order of A of which there is a trial, or the choice. */
static void next_candidate(struct experiment_block *b)
{
    struct experiment_work *w = b->work;
    while (w->candidate <= b->s.na &&
           !find_trial(&w->search, w->candidate, &w->trial[w->candidate]))
        w->candidate++;
    if (w->candidate > b->s.na) {
        choose_orders(b);
        return;
    }
    take_orders(b, w->candidate);
    begin_fit(b, PHASE_TWO_THIRDS, b->samples / 3u * 2u);
}

static void end_of_orders(struct experiment_block *b)
{
    struct experiment_work *w = b->work;
    if (w->selecting.err) {
        next_output(b, DOUBT_STILL);
        return;
    }
    memset(w->stands, 0, sizeof w->stands);
    w->unstable = false;
    w->candidate = 0;
    next_candidate(b);
}

static void end_of_a_fit(struct experiment_block *b)
{
    struct experiment_work *w = b->work;
    enum err err = w->fitting.err;
    if (w->phase == PHASE_WHOLE && err) {
        begin_fit(b, PHASE_AGAIN, b->samples / 3u * 2u);
        return;
    }
    if (w->phase != PHASE_TWO_THIRDS) {
        next_output(b, err ? DOUBT_UNSTABLE : DOUBT_NONE);
        return;
    }
    w->phase = PHASE_LAST_THIRD;
    if (!err)
        err = arx_judge_begin(&w->judging, &w->data, w->output, &w->fit[w->output],
                              b->samples / 3u * 2u, b->samples);
    if (!err)
        return;
    w->unstable = w->unstable || err == ERR_STATE;
    w->candidate++;
    next_candidate(b);
}

static void end_of_judging(struct experiment_block *b)
{
    struct experiment_work *w = b->work;
    arx_judge_take(&w->judging, &w->did[w->candidate]);
    w->stands[w->candidate] = true;
    w->candidate++;
    next_candidate(b);
}

bool experiment_find_piece(struct experiment_block *b)
{
    struct experiment_work *w = b->work;
    switch (w->phase) {
    case PHASE_ORDERS:
        if (!arx_select_piece(&w->selecting, PIECE))
            end_of_orders(b);
        break;
    case PHASE_TWO_THIRDS:
    case PHASE_WHOLE:
    case PHASE_AGAIN:
        if (!arx_fit_piece(&w->fitting, PIECE))
            end_of_a_fit(b);
        break;
    case PHASE_LAST_THIRD:
        if (!arx_judge_piece(&w->judging, PIECE))
            end_of_judging(b);
        break;
    default:
        break;
    }
    return w->phase != PHASE_OVER;
}

enum experiment_doubt experiment_take_model(struct experiment_block *b, uint8_t *output)
{
    struct experiment_work *w = b->work;
    memcpy(b->found, w->found, sizeof b->found);
    for (uint8_t i = 0; i < b->outputs; i++) {
        *output = (uint8_t)(i + 1u);
        if (b->found[i].doubt)
            return (enum experiment_doubt)b->found[i].doubt;
    }
    *output = 0;
    arx_model(w->fit, b->outputs, b->mvs, (real_t)(b->interval_s * (float)b->ratio), &b->model);
    return difference_gain(&b->model, b->gain) ? DOUBT_UNSTABLE : DOUBT_NONE;
}

#endif

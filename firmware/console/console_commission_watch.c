/* `commission watch`: the loops that the trial has kept, watched for a day, and what they did. */
#include "commission/commission.h"
#include "commission/kept_watch.h"
#include "commission/kept_watch_state.h"
#include "console/commission_listings.h"
#include "console/phrases.h"
#include "hal/tick.h"

#define HOURS 24.0f /* where none are given */

void commission_watch_command(struct client *c, unsigned n, char **word)
{
    struct answer a;
    float hours = HOURS;
    if (n > 1 && text_parse_float(word[1], &hours) != ERR_OK) {
        reply_err_about(c, ERR_PARSE, word[1], "hours, a number");
        return;
    }
    reply_answer(c, operate_watch(&c->session, hours, &a), &a);
}

void watch_progress_line(struct client *c, struct text *line)
{
    const struct commission *m = c->service->commission;
    hal_tick_lock();
    bool watching = status_phase(&m->status) == COMMISSION_WATCHING;
    uint32_t left = watching ? kept_watch_left(&m->work->analysis.work.after.watch) : 0;
    hal_tick_unlock();
    if (!watching)
        return;
    text_named_float(line, "the kept loops are watched, left",
                     (float)left * service_plan(c->service)->tick_s / 3600.0f);
    text_str(line, " h");
}

bool commission_watched_line(struct client *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct config *config = client_settings(c);
    const struct kept_watch *w = &m->work->analysis.work.after.watch;
    hal_tick_lock();
    enum commission_phase phase = status_phase(&m->status);
    bool watched = (phase == COMMISSION_WATCHING || phase == COMMISSION_KEPT) &&
                   commission_had_results(m) && w->ticks > 0 && n < adoption_loops(&m->adoption);
    struct watched_loop l = {.samples = 0};
    real_t sd = REAL_C(0.0);
    if (watched) {
        l = *kept_watch_loop(w, n);
        sd = kept_watch_sd(w, (uint8_t)n);
    }
    hal_tick_unlock();
    if (!watched && n == 0)
        text_str(line, "no loop has been watched: `commission watch` after a trial that kept them");
    if (!watched)
        return n == 0;
    const struct measurement_config *y =
        &config->measurement[adoption_channel(&m->adoption, n)->measurement];
    text_str(line, "watched ");
    text_str(line, config->loop[adoption_loop(&m->adoption, n)->loop].name);
    text_named_float(line, "largest", (float)l.largest * (y->hi - y->lo));
    text_named_float(line, "sd", (float)sd * (y->hi - y->lo));
    put_word(line, y->unit);
    text_named_float(line, "moves", (float)l.moves);
    text_str(line, " spans samples ");
    text_u32(line, l.samples);
    text_str(line, " manual ");
    text_u32(line, l.manual);
    return true;
}

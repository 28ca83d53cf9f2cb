#include "kinds/gmv/gmv_lambda.h"

#include <string.h>

#include "kinds/gmv/gmv_lambda_state.h"
#include "kinds/gmv/gmv_settings.h"

/* Steps after which the result of a trial is taken. */
#define TRIAL_STEPS 20u

void gmv_lambda_configure(struct gmv_lambda_search *s, const struct block_setup *setup,
                          const struct gmv_config *c)
{
    const struct gmv_settings *from = setup->settings;
    s->relative = from->weight == GMV_WORD_RELATIVE;
    s->margin = from->margin;
    s->most = s->relative ? from->detune : 1;
    memcpy(s->lambda, c->lambda, sizeof s->lambda);
    for (unsigned i = 0; i < c->shape.loops; i++)
        s->pi[i] = (struct gmv_trial_pi){.gain = from->tune_gain[i],
                                         .integral = from->tune_ti_s[i] > 0
                                                         ? from->tune_gain[i] * setup->interval_s /
                                                               from->tune_ti_s[i]
                                                         : 0};
}

void gmv_lambda_cancel(struct gmv_lambda_search *s)
{
    s->trial_running = s->trial_wanted = false;
}

void gmv_lambda_reset(struct gmv_lambda_search *s)
{
    gmv_lambda_cancel(s);
    s->times = 1;
}

void gmv_lambda_apply(const struct gmv_lambda_search *s, struct gmv *g)
{
    for (unsigned i = 0; i < gmv_shape(g)->loops && s->relative; i++)
        gmv_set_lambda(g, i, num_from_float(s->lambda[i] * s->times * gmv_own_gain(g, i)));
}

/* Searches lambda anew while tuning; tries a law that acts, or that has no lambda, as it is. */
static void begin_lambda_trial(struct gmv_lambda_search *s, struct gmv *g, uint8_t acting,
                               bool searches, float better, const struct gmv_record *record)
{
    if (searches)
        s->times = 1;
    gmv_lambda_apply(s, g);
    searches = searches && (s->lambda[0] > 0 || s->lambda[1] > 0);
    gmv_detune_begin(&s->search, s->times, searches ? s->most : s->times, better, record);
    gmv_trial_take(&s->trial, g, acting, s->margin, s->pi);
}

void gmv_lambda_ask(struct gmv_lambda_search *s, struct gmv *g, struct block_io *io, bool wanted,
                    bool searches, float better, const struct gmv_record *record)
{
    if (wanted) {
        s->trial_wanted = true;
        s->trial_running = false;
    }
    if (!s->trial_wanted || io->requests.work_wanted)
        return;
    begin_lambda_trial(s, g, io->members.acting, searches, better, record);
    io->requests.ask_work = TRIAL_STEPS;
    s->trial_running = true;
    s->trial_wanted = false;
}

bool gmv_lambda_take(struct gmv_lambda_search *s, const struct block_io *io,
                     struct gmv_outcome *outcome)
{
    if (!s->trial_running || !io->requests.work_done)
        return false;
    *outcome = *gmv_detune_best(&s->search);
    s->times = outcome->times;
    s->trial_running = false;
    return true;
}

/* Texts that the listings of `commission` share. */
#include "console/commission_words.h"
#include "console/phrases.h"

#include "commission/commission.h"

const struct measurement_config *commission_measurement(const struct client *c, unsigned j)
{
    return &client_settings(c)
                ->measurement[outputs_measurement(&c->service->commission->outputs, j)];
}

const struct mv_config *commission_output(const struct client *c, unsigned k)
{
    return &client_settings(c)->mv[inputs_get(&c->service->commission->inputs, k)->output];
}

void commission_unit(struct text *t, const char *unit)
{
    text_str(t, unit[0] ? unit : "-");
}

void commission_flags(struct text *t, unsigned bits)
{
    static const char *const names[] = {
        "no_gain",     "negative_T", "negative_radicand", "negative_L", "short",   "not_settled",
        "integrating", "inverse",    "oscillatory",       "slow",       "unknown", "integrates"};
    text_str(t, " flags");
    if (bits == 0)
        text_str(t, " -");
    for (unsigned i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (!(bits >> i & 1u))
            continue;
        put_word(t, names[i]);
    }
}

bool commission_has_nothing(struct client *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    if (commission_has_results(m) && !by_relay_is_latest(&m->by_relay)) {
        if (n == 0)
            operate_startup_shown(&c->session);
        return false;
    }
    if (n == 0)
        text_str(line, by_relay_is_latest(&m->by_relay)
                           ? "the latest test was by relay: `commission relay`"
                       : commission_had_results(m) ? RESULTS_DISCARDED
                                                   : "nothing yet: `commission begin` first");
    return true;
}

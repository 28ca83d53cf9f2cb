#include "design/robust_config.h"

#include <stddef.h>

void robust_config_default(struct robust_config *config)
{
    *config = (struct robust_config){
        .s_most = REAL_C(2.0), .t_most = REAL_C(1.5), .t_nominal = REAL_C(1.3)};
    for (size_t k = 0; k < INTERACT_MAX; k++)
        config->gain_most[k] = ROBUST_GAIN_MOST;
}

static enum err refuse_robust(struct interact_refusal *reason, const char *field,
                              const char *wanted)
{
    *reason = (struct interact_refusal){field, wanted, INTERACT_NONE, INTERACT_NONE};
    return ERR_RANGE;
}

enum err robust_config_check(const struct robust_config *c, const struct loops *start,
                             struct interact_refusal *reason)
{
    const struct interact_range ranges[] = {
        {c->s_most, REAL_C(1.2), REAL_C(10.0), "s_most", "1.2 to 10"},
        {c->t_most, REAL_C(1.05), REAL_C(10.0), "t_most", "1.05 to 10"},
        {c->t_nominal, REAL_C(1.05), c->t_most, "t_nominal", "1.05 to t_most"}};
    enum err err = interact_check_ranges(ranges, sizeof ranges / sizeof ranges[0], reason);
    if (err)
        return err;
    if (c->members > 1000 || (c->members > 0 && !c->draw))
        return refuse_robust(reason, "members", "0 to 1000, and a function that draws them");
    for (size_t k = 0; k < start->pairs.n; k++) {
        if (!real_within(c->gain_most[k], ROBUST_GAIN_LEAST, ROBUST_GAIN_MOST))
            return refuse_robust(reason, "gain_most", "1e-6 to 100");
        if (start->tuning[k].td_s > REAL_C(0.0))
            return refuse_robust(reason, "td_s", "0: a PI");
    }
    return ERR_OK;
}

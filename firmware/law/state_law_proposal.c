#include "law/state_law_proposal.h"

#include "base/assertion.h"

/* The p-th of all values: id of its parameter, what it is in the settings and what it should be. False past the end. */
static bool nth_of_law(const struct state_law_settings *s, const struct state_law_found *f,
                       unsigned loops, unsigned p, struct proposed_value *wanted, float *present)
{
    unsigned of_g = loops * loops, i, k;
    if (p < of_g) {
        i = p / loops;
        k = p % loops;
        wanted->id = STATE_LAW_ID_G + i * STATE_LAW_LOOPS + k;
        wanted->value = f->g[i][k];
        *present = s->g[i][k];
        return true;
    }
    p -= of_g;
    i = p / STATE_FEEDBACK_INPUTS;
    k = p % STATE_FEEDBACK_INPUTS;
    if (i >= STATE_LAW_LOOPS)
        return false;
    wanted->id = STATE_LAW_ID_F + i * STATE_FEEDBACK_INPUTS + k;
    wanted->value = f->f[i][k];
    *present = s->f[i][k];
    return true;
}

void state_law_put_values(const struct state_law_settings *settings,
                          const struct state_law_found *wanted, float made_s, unsigned loops,
                          uint8_t block, struct block_proposal *room)
{
    REFLUX_ASSERT(room->n == 0 && loops <= STATE_LAW_LOOPS);
    struct proposed_value value;
    float present;
    if (settings->made_s != made_s)
        room->value[room->n++] =
            (struct proposed_value){proposed_in_row(block, STATE_LAW_ID_MADE, 0, 0), made_s};
    for (unsigned p = 0; nth_of_law(settings, wanted, loops, p, &value, &present); p++)
        if (value.value != present)
            room->value[room->n++] = (struct proposed_value){
                proposed_in_row(block, (uint8_t)value.id, 0, 0), value.value};
}
_Static_assert(1 + STATE_LAW_LOOPS * (STATE_LAW_LOOPS + STATE_FEEDBACK_INPUTS) <= PROPOSAL_MAX,
               "a law is one proposal");

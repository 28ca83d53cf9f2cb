/* What a block of the kind `ff_tune` proposes: its candidate for the element, or a gain of 0. The same numbers are settings of the block, so that it
 * knows what the element has. */
#include "kinds/ff_tune/feedforward_tune_block.h"

/* Times what a step of the disturbance takes that a proposal waits for it to be over. */
#define CALLS 4u
/* Of `check`: one that makes the loop worse waits no longer. */
#define WORSE_WAITS 0.0625f

#define OFF_VALUES 2

/* Gain, lead, lag, dead time of the element. */
static uint32_t setting_of_element(const struct tune *t, unsigned k)
{
    static const enum proposed of_ff[4] = {PROPOSED_FF_GAIN, PROPOSED_FF_LEAD, PROPOSED_FF_LAG,
                                           PROPOSED_FF_DEAD};
    uint8_t element = (uint8_t)(t->s.element - 1u);
    return t->s.block
               ? proposed_in_row((uint8_t)(t->s.block - 1u), (uint8_t)(TERM_GAIN + k), 0, element)
               : proposed_setting(of_ff[k], element);
}

static void put_gain_off(const struct tune *t, struct proposed_value value[OFF_VALUES])
{
    value[0] = (struct proposed_value){proposed_own(TUNE_ID_K), 0};
    value[1] = (struct proposed_value){setting_of_element(t, 0), 0};
}
_Static_assert(OFF_VALUES <= SWITCH_OFF_MAX, "they fit");

/* Needs nobody: off at the next tick, whatever is open. */
static bool is_off_at_once(const struct tune *t)
{
    return t->s.protect || t->s.adopt == TUNE_ADOPT_AT_ONCE;
}

static void ask_gain_off(const struct tune *t, struct block_io *io)
{
    if (is_off_at_once(t)) {
        io->switch_off->n = OFF_VALUES;
        uint8_t element = (uint8_t)(t->s.element - 1u);
        io->switch_off->element = t->s.block ? switch_off_term((uint8_t)(t->s.block - 1u), element)
                                             : switch_off_element(element);
        put_gain_off(t, io->switch_off->value);
        return;
    }
    io->proposal->n = OFF_VALUES;
    put_gain_off(t, io->proposal->value);
}

static void put_candidate(const struct tune *t, struct block_proposal *room)
{
    const struct feedforward_shape *c = &t->candidate;
    const float value[4] = {(float)c->k, (float)c->lead, (float)c->lag, (float)c->dead};
    room->n = 8;
    room->manner = t->s.adopt == TUNE_ADOPT_AT_ONCE ? PROPOSAL_AT_ONCE : PROPOSAL_WHEN_ACCEPTED;
    for (size_t k = 0; k < 4; k++) {
        room->value[2 * k] =
            (struct proposed_value){proposed_own((uint8_t)(TUNE_ID_K + k)), value[k]};
        room->value[2 * k + 1] =
            (struct proposed_value){setting_of_element(t, (unsigned)k), value[k]};
    }
}

/* Settings that come into force while a step of the disturbance is under way would keep what the element just gives, which the loop
 * makes room for. A disturbance that never rests is not waited for. */
static bool is_calm(struct tune *t)
{
    uint32_t wanted = (uint32_t)((t->s.lead_s + t->s.lag_s + t->s.dead_s) / (float)t->h_s);
    wanted = 2u * wanted + 4u;
    uint32_t most = CALLS * (wanted + 4u), least = tune_samples(t, WORSE_WAITS * t->s.check_s);
    if (t->silencing && most > least)
        most = least;
    bool calm = t->d_rests > wanted || t->calls > most * t->ticks;
    bool wants =
        t->silencing || (!t->handed && (t->stage == TUNE_SILENCES || t->stage == TUNE_PROPOSES));
    t->calls = wants && !calm ? t->calls + 1u : 0;
    return calm || !wants;
}

/* With room again and other settings in force it was refused, or rejected. */
void tune_propose_on(struct tune *t, struct block_io *io)
{
    bool wants_off = t->silencing || t->stage == TUNE_SILENCES;
    io->withdraws = t->stage != TUNE_PROPOSES && t->stage != TUNE_SILENCES && !t->off_waits;
    bool off_room = is_off_at_once(t) ? io->switch_off != NULL : io->proposal != NULL;
    if (off_room)
        t->off_waits = false;
    if (!(wants_off ? off_room : io->proposal != NULL) || !is_calm(t))
        return;
    if (t->silencing || (t->stage == TUNE_SILENCES && !t->handed)) {
        ask_gain_off(t, io);
        t->silencing = false;
        t->off_waits = true;
        t->handed = true;
        return;
    }
    if (t->stage != TUNE_PROPOSES && t->stage != TUNE_SILENCES)
        return;
    if (t->handed) {
        tune_end_with(t, TUNE_REJECTED);
        return;
    }
    put_candidate(t, io->proposal);
    t->handed = true;
}

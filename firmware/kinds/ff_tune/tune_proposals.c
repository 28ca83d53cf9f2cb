#include "kinds/ff_tune/tune_proposals.h"

#include "base/assertion.h"
#include "kinds/ff_tune/tune_proposals_state.h"

/* A proposal waits until a step of the disturbance is over, at most so many times what that takes. */
#define CALLS 4u
/* One that makes the loop worse waits no longer than this part of `check`. */
#define WORSE_WAITS 0.0625f

#define OFF_VALUES 2

void tune_proposals_begin(struct tune_proposals *p)
{
    p->handed = false;
}

void tune_proposals_forget(struct tune_proposals *p)
{
    p->silencing = p->off_waits = false;
}

void tune_silence(struct tune_proposals *p)
{
    p->silencing = true;
}

bool tune_is_silencing(const struct tune_proposals *p)
{
    return p->silencing;
}

bool tune_off_waits(const struct tune_proposals *p)
{
    return p->off_waits;
}

/* k: gain, lead, lag, dead time of the element. */
static uint32_t setting_of_element(const struct tune_context *c, unsigned k)
{
    REFLUX_ASSERT(k < 4 && c->s.element >= 1);
    static const enum proposed of_ff[4] = {PROPOSED_FF_GAIN, PROPOSED_FF_LEAD, PROPOSED_FF_LAG,
                                           PROPOSED_FF_DEAD};
    uint8_t element = (uint8_t)(c->s.element - 1u);
    return c->s.block
               ? proposed_in_row((uint8_t)(c->s.block - 1u), (uint8_t)(TERM_GAIN + k), 0, element)
               : proposed_setting(of_ff[k], element);
}

static void put_gain_off(const struct tune_context *c, struct proposed_value value[OFF_VALUES])
{
    value[0] = (struct proposed_value){proposed_own(TUNE_ID_K), 0};
    value[1] = (struct proposed_value){setting_of_element(c, 0), 0};
}
_Static_assert(OFF_VALUES <= SWITCH_OFF_MAX, "they fit");

/* Nobody is asked: the element is off at the next tick, whatever is open. */
static bool is_off_at_once(const struct tune_context *c)
{
    return c->s.protect || c->s.adopt == TUNE_ADOPT_AT_ONCE;
}

static void ask_gain_off(const struct tune_context *c, struct block_io *io)
{
    if (is_off_at_once(c)) {
        io->requests.switch_off->n = OFF_VALUES;
        uint8_t element = (uint8_t)(c->s.element - 1u);
        io->requests.switch_off->element =
            c->s.block ? switch_off_term((uint8_t)(c->s.block - 1u), element)
                       : switch_off_of_ff(element);
        put_gain_off(c, io->requests.switch_off->value);
        return;
    }
    io->requests.proposal->n = OFF_VALUES;
    put_gain_off(c, io->requests.proposal->value);
}

static void put_candidate(const struct tune_context *c, const struct feedforward_shape *f,
                          struct block_proposal *room)
{
    const float value[4] = {(float)f->k, (float)f->lead, (float)f->lag, (float)f->dead};
    room->n = 8;
    room->manner = c->s.adopt == TUNE_ADOPT_AT_ONCE ? PROPOSAL_AT_ONCE : PROPOSAL_WHEN_ACCEPTED;
    for (size_t k = 0; k < 4; k++) {
        room->value[2 * k] =
            (struct proposed_value){proposed_own((uint8_t)(TUNE_ID_K + k)), value[k]};
        room->value[2 * k + 1] =
            (struct proposed_value){setting_of_element(c, (unsigned)k), value[k]};
    }
}

/* Settings that come into force while a step of the disturbance is under way would keep what the element just gives, which the loop
 * makes room for. Nobody waits for a disturbance that never rests. */
static bool is_calm(struct tune_proposals *p, const struct tune_context *c, bool in_stage,
                    uint16_t rests)
{
    uint32_t wanted = (uint32_t)((c->s.lead_s + c->s.lag_s + c->s.dead_s) / (float)c->h_s);
    wanted = 2u * wanted + 4u;
    uint32_t most = CALLS * (wanted + 4u), least = tune_samples_in(c, WORSE_WAITS * c->s.check_s);
    if (p->silencing && most > least)
        most = least;
    bool calm = rests > wanted || p->calls > most * c->ticks;
    bool wants = p->silencing || (!p->handed && in_stage);
    p->calls = wants && !calm ? p->calls + 1u : 0;
    return calm || !wants;
}

/* With room again and other settings in force the proposal was refused, or rejected. */
bool tune_propose(struct tune_proposals *p, const struct tune_context *c, struct block_io *io,
                  enum tune_stage stage, const struct feedforward_shape *candidate, uint16_t rests)
{
    bool silences = stage == TUNE_SILENCES, in_stage = silences || stage == TUNE_PROPOSES;
    bool wants_off = p->silencing || silences;
    io->requests.withdraws = !in_stage && !p->off_waits;
    bool off_room =
        is_off_at_once(c) ? io->requests.switch_off != NULL : io->requests.proposal != NULL;
    if (off_room)
        p->off_waits = false;
    if (!(wants_off ? off_room : io->requests.proposal != NULL) || !is_calm(p, c, in_stage, rests))
        return true;
    if (p->silencing || (silences && !p->handed)) {
        ask_gain_off(c, io);
        p->silencing = false;
        p->off_waits = true;
        p->handed = true;
        return true;
    }
    if (!in_stage)
        return true;
    if (p->handed)
        return false;
    put_candidate(c, candidate, io->requests.proposal);
    p->handed = true;
    return true;
}

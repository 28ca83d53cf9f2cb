#include "kinds/gmv/gmv_events.h"

enum gmv_event {
    EVENT_ADOPTED,
    EVENT_REFUSED,
    EVENT_FROZEN,
    EVENT_SIGN,
    EVENT_POLES,
    EVENT_WORSE,
    EVENT_BURST,
    EVENT_SINGULAR,
    EVENT_RECORD
};

const struct block_event gmv_event_rows[GMV_EVENTS] = {
    [EVENT_ADOPTED] = {"adopted", BLOCK_INFO, "the law computes; decay per step"},
    [EVENT_REFUSED] = {"refused", BLOCK_INFO,
                       "model not adopted: 1 prediction, 2 gain, 3 poles, 4 by hand, 5 PI"},
    [EVENT_FROZEN] = {"frozen", BLOCK_INFO,
                      "not learning: 1 asked, 2 quiet, 3 still, 4 reading, 5 manual"},
    [EVENT_SIGN] = {"sign", BLOCK_ALARM, "PI acts: wrong sign or size of g0, span/span"},
    [EVENT_POLES] = {"poles", BLOCK_ALARM, "PI acts: unstable, growth per step"},
    [EVENT_WORSE] = {"worse", BLOCK_ALARM,
                     "PI acts: predictions fail, or an MV stuck the wrong way; spans"},
    [EVENT_BURST] = {"burst", BLOCK_ALARM, "PI acts: the MV or PV swings, spans r.m.s."},
    [EVENT_SINGULAR] = {"singular", BLOCK_INFO, "loops solved one by one"},
    [EVENT_RECORD] = {"pi_wins", BLOCK_ALARM,
                      "PI acts: it did better; law's moves or errors over the PI's"},
};

void gmv_events_raise(const struct gmv_status *s, struct block_io *io, unsigned loops, uint8_t wish,
                      bool singular)
{
    uint8_t rest = GMV_LEARNS;
    bool law = s->state == GMV_SELF_TUNING, learns = false;
    unsigned raised = 0;
    for (unsigned i = 0; i < loops; i++) {
        learns = learns || s->rest[i] == GMV_LEARNS;
        if ((io->members.acting & (1u << i)) && s->rest[i] > rest)
            rest = s->rest[i];
    }
    raised |= law ? 1u << EVENT_ADOPTED : 0;
    raised |= !learns ? 1u << EVENT_FROZEN : 0;
    raised |= wish & GMV_WISH_REFUSED ? 1u << EVENT_REFUSED : 0;
    raised |= law && singular ? 1u << EVENT_SINGULAR : 0;
    raised |= (s->alarms & (GMV_ALARM_RECORD - 1u)) << EVENT_SIGN;
    raised |= s->alarms & GMV_ALARM_RECORD ? 1u << EVENT_RECORD : 0;
    io->requests.raised = (uint16_t)raised;
    for (unsigned k = 0; k < GMV_EVENTS; k++)
        io->requests.event_value[k] = s->alarm_value;
    io->requests.event_value[EVENT_ADOPTED] = s->outcome.decay;
    io->requests.event_value[EVENT_REFUSED] = s->refusal;
    io->requests.event_value[EVENT_FROZEN] = rest;
    io->requests.event_value[EVENT_SINGULAR] = (float)loops;
}

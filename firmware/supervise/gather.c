#include "supervise/gather.h"

uint8_t input_quality(const struct supervisor *s, uint8_t input, bool measured)
{
    if (input & INPUT_IS_MV)
        return s->mv[input & ~INPUT_IS_MV].bound ? QUALITY_GOOD : QUALITY_MISSING;
    const struct measurement_state *m = &s->measurement[input];
    if (!m->bound || !m->seen)
        return QUALITY_MISSING;
    /* A value that stands in for a reading tells an estimator nothing. */
    return measured && m->fault != MEASUREMENT_FINE ? QUALITY_BAD : (uint8_t)m->quality;
}

void gather(const struct supervisor *s, uint8_t block, struct gathered *g)
{
    plan_links(s->plan, block, &g->links);
    if (g->links.members > s->placed[PLACED_LOOPS]) /* the decoupler has rows without a loop */
        g->links.members = s->placed[PLACED_LOOPS];
    g->io = (struct block_io){.members.in = g->in, .members.out = g->out};
    for (uint8_t k = 0; k < g->links.inputs; k++) {
        uint8_t input = g->links.input[k];
        g->input[k] =
            input & INPUT_IS_MV ? s->mv[input & ~INPUT_IS_MV].applied : s->measurement[input].value;
    }
}

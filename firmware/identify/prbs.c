#include "identify/prbs.h"

#include <stddef.h>
#include <string.h>

#include "base/assertion.h"
#include "identify/common.h"

/* Feedback of registers of 3 to 15 bits that shift to the right, the bits that change when a 1 leaves: exponents of primitive
 * polynomials, each less 1 (W. Stahnke, Math. Comp. 27 (1973) 977, in the reciprocal form). */
static const uint16_t feedback[PRBS_BITS_MOST - PRBS_BITS_LEAST + 1] = {
    0x6, 0xC, 0x14, 0x30, 0x60, 0xB8, 0x110, 0x240, 0x500, 0xE08, 0x1C80, 0x3802, 0x6000};

static unsigned longest_register(const struct prbs_settings *s)
{
    return s->independence == PRBS_REGISTERS ? s->bits + s->inputs - 1u : s->bits;
}

static uint32_t sequence_length(unsigned bits)
{
    return (UINT32_C(1) << bits) - 1u;
}

enum err prbs_check(const struct prbs_settings *s, const char **field, const char **wanted)
{
    const char *unused;
    field = field ? field : &unused;
    wanted = wanted ? wanted : &unused;
    *field = "inputs";
    *wanted = "1 to 4";
    if (s->inputs < 1 || s->inputs > PRBS_INPUTS)
        return ERR_RANGE;
    *field = "independence";
    *wanted = PRBS_INDEPENDENCE_WORDS;
    if (s->independence > PRBS_REGISTERS)
        return ERR_RANGE;
    *field = "bits";
    *wanted = "3 to 15, the longest register as well";
    if (s->bits < PRBS_BITS_LEAST || longest_register(s) > PRBS_BITS_MOST)
        return ERR_RANGE;
    *field = "clock";
    *wanted = "1 to 10000 samples";
    if (s->clock < 1 || s->clock > 10000)
        return ERR_RANGE;
    *field = "amplitude";
    *wanted = "0 to 1e6";
    for (size_t j = 0; j < s->inputs; j++) {
        enum err err = check_real(s->amplitude[j], ZERO, REAL_C(1e6));
        if (err)
            return err;
    }
    return ERR_OK;
}

static uint16_t next_state(uint16_t state, uint16_t taps)
{
    unsigned next = (unsigned)state >> 1;
    return (uint16_t)(state & 1u ? next ^ taps : next);
}

void prbs_init(struct prbs *p, const struct prbs_settings *s)
{
    REFLUX_ASSERT(s->inputs >= 1 && s->inputs <= PRBS_INPUTS && s->bits >= PRBS_BITS_LEAST &&
                  s->bits <= PRBS_BITS_MOST);
    memset(p, 0, sizeof *p);
    p->inputs = s->inputs;
    p->clock = s->clock;
    uint32_t apart = sequence_length(s->bits) / s->inputs;
    uint16_t state = 1;
    for (size_t j = 0; j < s->inputs; j++) {
        bool own = s->independence == PRBS_REGISTERS;
        p->amplitude[j] = s->amplitude[j];
        p->taps[j] = feedback[s->bits - PRBS_BITS_LEAST + (own ? j : 0u)];
        p->state[j] = state;
        for (uint32_t k = 0; k < apart && !own; k++)
            state = next_state(state, p->taps[j]);
    }
}

void prbs_step(struct prbs *p, real_t *u)
{
    REFLUX_ASSERT(p->inputs <= PRBS_INPUTS);
    for (size_t j = 0; j < p->inputs; j++)
        u[j] = p->state[j] & 1u ? p->amplitude[j] : -p->amplitude[j];
    if (++p->waited < p->clock)
        return;
    p->waited = 0;
    for (size_t j = 0; j < p->inputs; j++)
        p->state[j] = next_state(p->state[j], p->taps[j]);
}

uint32_t prbs_period(const struct prbs_settings *s)
{
    return sequence_length(s->bits) * s->clock;
}

uint32_t prbs_memory(const struct prbs_settings *s)
{
    uint32_t steps = sequence_length(s->bits);
    return (s->independence == PRBS_SHIFTS ? steps / s->inputs : steps) * s->clock;
}

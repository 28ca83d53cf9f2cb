/* The static decoupler as a kind of block: a compensator. Member k is loop k. */
#include "kinds/decoupler/decoupler.h"

#include "base/assertion.h"

struct decoupler_state {
    struct decoupler decoupler;
    /* Selected members, a bit each. */
    uint8_t mask;
    /* The next back-calculation gets differences from the step's outputs. */
    bool stepped;
};

/* Above this, in spans, num_t may have cut off a command, and values come instead of differences. */
#define DIFFERENCES_UP_TO 64.0f

static uint32_t decoupler_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct decoupler_state);
}

static bool decoupler_holds(const struct decoupler *k, const float d[DECOUPLER_MAX][DECOUPLER_MAX])
{
    for (uint8_t i = 0; i < k->n; i++)
        for (uint8_t j = 0; j < k->n; j++)
            if (!num_eq(k->d[i][j], num_from_float(d[k->member[i]][k->member[j]])))
                return false;
    return true;
}

static enum err decoupler_check_parts(const struct block_setup *setup, struct block_fault *fault)
{
    uint8_t worst = 0;
    if (decoupler_check(setup, &worst) == ERR_OK)
        return ERR_OK;
    for (fault->member = 0; !(worst & (1u << fault->member));)
        fault->member++;
    fault->field = "d1";
    fault->wanted = "needs a matrix whose every part (with other loops in manual) has an inverse "
                    "with rows that add up to 127 at most, signs and feedforward left aside";
    return ERR_SINGULAR;
}

static enum err decoupler_configure(void *state, const struct block_setup *setup, bool retune)
{
    const struct matrix_settings *matrix = setup->settings;
    struct decoupler_state *s = state;
    if (!retune || !decoupler_holds(&s->decoupler, matrix->d)) /* select again at the next tick */
        s->mask = s->decoupler.n = 0;
    return ERR_OK;
}

static bool decoupler_select_members(void *state, const void *settings, uint8_t acting)
{
    struct decoupler_state *s = state;
    const struct matrix_settings *matrix = settings;
    if (acting == s->mask)
        return false;
    if (decoupler_select(&s->decoupler, matrix->d, acting) != ERR_OK)
        s->decoupler.n = 0; /* every part was checked with the plan */
    s->mask = acting;
    return true;
}

static void decoupler_step(void *state, struct block_io *io)
{
    struct decoupler_state *s = state;
    REFLUX_ASSERT(s->decoupler.n <= DECOUPLER_MAX);
    decoupler_forward(&s->decoupler, io->members.in, io->members.out);
    s->stepped = true;
    for (uint8_t i = 0; i < s->decoupler.n; i++)
        if (num_lt(num_from_float(DIFFERENCES_UP_TO),
                   num_abs(io->members.out[s->decoupler.member[i]])))
            s->stepped = false;
}

static void decoupler_back_calculate(void *state, struct block_io *io)
{
    struct decoupler_state *s = state;
    if (s->stepped)
        decoupler_give_way(&s->decoupler, io->members.in, io->members.out);
    else
        decoupler_back(&s->decoupler, io->members.in, io->members.out);
    s->stepped = false;
}

const struct block_kind decoupler_kind = {
    .name = "decoupler",
    .stage = STAGE_COMPENSATE,
    .bytes = decoupler_bytes,
    .check = decoupler_check_parts,
    .configure = decoupler_configure,
    .select = decoupler_select_members,
    .step = decoupler_step,
    .back_calculate = decoupler_back_calculate,
};

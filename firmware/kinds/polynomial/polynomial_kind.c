/* u = G(z^-1) v. The first coefficients act in every base tick, the others on v as it was at the end of the periods before. */
#include "kinds/polynomial/polynomial.h"

#include <string.h>

#include "base/assertion.h"
#include "block/refuse.h"
#include "block/step_period.h"

#define LOOPS POLYNOMIAL_LOOPS

struct polynomials {
    uint8_t loops, taps, limits;
    /* Loops that took part when it last followed. */
    uint8_t mask;
    /* Loops that give way alone where their MV is limited, with POLYNOMIAL_SCALE. */
    uint8_t alone;
    /* The loops act without G. */
    bool incomplete;
    /* `tick` and the past are those of the next step already. */
    bool begun;
    /* Ticks of a period, and the number of this one, from 0 on. */
    uint16_t ticks, tick;
    /* Ticks since an input has moved, `ticks` at most. */
    uint16_t unchanged;
    /* v in effect, in this tick or the last one, and in the tick before that. */
    num_t v[LOOPS], v_before[LOOPS];
    /* u that the last step gave, then what took effect of it; what took effect a tick before. */
    num_t u[LOOPS], u_before[LOOPS];
    /* G, by loops, loops and coefficients; then taps - 1 samples of v, the newest first. */
    num_t data[];
};

#define FIELD(field) offsetof(struct polynomial_settings, field)

static const struct block_parameter polynomial_parameters[] = {
    {POLYNOMIAL_ID_PERIOD, BLOCK_FLOAT, FIELD(period_s), 1, 1, "period", "s",
     "of a step of z; 0: a base tick", 0, 1e5f, 0},
    {POLYNOMIAL_ID_G, BLOCK_FLOAT, FIELD(g), LOOPS *LOOPS, POLYNOMIAL_TAPS, "g", "-",
     "row i n + j + 1: of MV i to the output of loop j, from z^0 on", -100, 100, 0},
    {POLYNOMIAL_ID_LIMITS, BLOCK_WORD, FIELD(limits), 1, 1, "limits", "recurse|scale|incomplete",
     "where an MV is limited: into the past, or the whole move is shortened; or G is not whole", 0,
     2, POLYNOMIAL_RECURSE},
};

static const struct block_event polynomial_events[] = {
    {"partial", BLOCK_INFO,
     "the loops act without their decoupler because a part of its G is missing, -"},
};

static num_t *coefficient(struct polynomials *s, unsigned i, unsigned j)
{
    REFLUX_ASSERT(i < s->loops && j < s->loops);
    return &s->data[((size_t)i * s->loops + j) * s->taps];
}

static num_t *past_of(struct polynomials *s, unsigned k)
{
    REFLUX_ASSERT(k + 1u < s->taps);
    unsigned of_g = (unsigned)s->loops * s->loops * s->taps;
    return &s->data[of_g + k * s->loops];
}

/* ---- settings ---- */

static unsigned used_taps(const struct polynomial_settings *c, unsigned loops)
{
    unsigned taps = 1;
    if (c->limits == POLYNOMIAL_INCOMPLETE)
        return taps;
    for (unsigned row = 0; row < loops * loops; row++)
        for (unsigned k = taps; k < POLYNOMIAL_TAPS; k++)
            if (c->g[row][k] != 0.0f)
                taps = k + 1;
    return taps;
}

static uint32_t polynomial_bytes(const struct block_setup *setup)
{
    unsigned loops = setup->members, taps = used_taps(setup->settings, loops);
    size_t numbers = loops * loops * taps + loops * (taps - 1);
    return (uint32_t)((sizeof(struct polynomials) + numbers * sizeof(num_t) + 7u) & ~(size_t)7u);
}

static float period_ticks(const struct block_setup *setup)
{
    const struct polynomial_settings *c = setup->settings;
    return step_period_ticks(c->period_s, setup->interval_s);
}

static enum err refuse_singular(struct block_fault *fault, unsigned member, const char *field,
                                const char *wanted)
{
    (void)block_refuse(fault, member, field, wanted);
    return ERR_SINGULAR;
}

/* Puts G into a: its first coefficients for loops whose past goes on, their sums for others, which are at rest. */
static void matrix_of(const struct polynomial_settings *c, unsigned loops, unsigned members,
                      unsigned going_on, float a[LOOPS][LOOPS])
{
    REFLUX_ASSERT(loops <= LOOPS);
    unsigned row = 0;
    for (unsigned i = 0; i < loops; i++) {
        unsigned col = 0;
        if (!(members & (1u << i)))
            continue;
        for (unsigned j = 0; j < loops; j++) {
            const float *g = c->g[i * loops + j];
            if (!(members & (1u << j)))
                continue;
            a[row][col] = g[0];
            for (unsigned k = 1; k < POLYNOMIAL_TAPS && !(going_on & (1u << j)); k++)
                a[row][col] += g[k];
            col++;
        }
        row++;
    }
}

/* The matrix has an inverse, with elements that num_t holds. *reach: how far v can be when the outputs are where they may be. */
static bool has_inverse(const struct block_setup *setup, unsigned members, unsigned going_on,
                        float *reach)
{
    float a[LOOPS][LOOPS], most[LOOPS] = {0};
    unsigned n = 0, col = 0;
    matrix_of(setup->settings, setup->members, members, going_on, a);
    for (unsigned k = 0; k < setup->members; k++)
        n += (members >> k) & 1u;
    for (unsigned k = 0; k < setup->members; k++) {
        float unit[LOOPS] = {0}, x[LOOPS];
        if (!(members & (1u << k)))
            continue;
        unit[col++] = 1;
        if (!polynomial_solve(n, a, unit, x))
            return false;
        for (unsigned i = 0; i < n; i++) {
            float size = x[i] < 0 ? -x[i] : x[i];
            if (!(size <= NUM_MAX_MAGNITUDE))
                return false;
            most[i] += size * setup->member[k].out_reach;
        }
    }
    *reach = 0;
    for (unsigned i = 0; i < n; i++)
        if (most[i] > *reach)
            *reach = most[i];
    return true;
}

static enum err check_part(const struct block_setup *setup, unsigned members,
                           struct block_fault *fault)
{
    const struct polynomial_settings *c = setup->settings;
    unsigned first = 0;
    float reach;
    while (!(members & (1u << first)))
        first++;
    if (!has_inverse(setup, members, 0, &reach) || !(reach <= NUM_MAX_MAGNITUDE))
        return refuse_singular(
            fault, first, "g",
            "needs sums of coefficients whose every part (with other loops in manual) has an "
            "inverse with rows that add up to 127 at most, signs and feedforward left aside");
    if (c->limits != POLYNOMIAL_RECURSE)
        return ERR_OK;
    for (unsigned going_on = 1; going_on <= members; going_on++)
        if ((going_on & members) == going_on && !has_inverse(setup, members, going_on, &reach))
            return refuse_singular(fault, first, "limits",
                                   "must be scale: the first coefficients have no inverse");
    if (!polynomial_forgets(c, setup->members, used_taps(c, setup->members), members))
        return block_refuse(fault, first, "limits",
                            "must be scale: what G is run backwards would not die away");
    return ERR_OK;
}

static enum err polynomial_check_settings(const struct block_setup *setup,
                                          struct block_fault *fault)
{
    const struct polynomial_settings *c = setup->settings;
    float ticks = period_ticks(setup);
    if (setup->members < 1 || setup->members > LOOPS)
        return block_refuse(fault, 0, "loops", "needs one to four");
    if (!(ticks >= 0.999f && ticks <= 65000.0f))
        return block_refuse(fault, 0, "period", "must be 1 to 65000 base ticks");
    if (!step_period_is_whole(ticks))
        return block_refuse(fault, 0, "period", "must be a whole number of base ticks");
    if (c->limits == POLYNOMIAL_INCOMPLETE)
        return ERR_OK; /* nothing computes with G */
    for (unsigned part = 1; part < (1u << setup->members); part++) {
        enum err err = part & ~(unsigned)setup->present ? ERR_OK : check_part(setup, part, fault);
        if (err)
            return err;
    }
    return ERR_OK;
}

/* The identity in place of a G that is not whole. */
static void take_coefficients(struct polynomials *s, const struct polynomial_settings *c)
{
    for (unsigned i = 0; i < s->loops; i++)
        for (unsigned j = 0; j < s->loops; j++)
            for (unsigned k = 0; k < s->taps; k++)
                coefficient(s, i, j)[k] = s->incomplete ? (i == j ? num_one() : num_zero())
                                                        : num_from_float(c->g[i * s->loops + j][k]);
}

/* Other settings bump nothing: follow sees to that. */
static enum err polynomial_configure(void *state, const struct block_setup *setup, bool retune)
{
    REFLUX_ASSERT(setup->members <= LOOPS);
    struct polynomials *s = state;
    const struct polynomial_settings *c = setup->settings;
    if (!retune)
        memset(s, 0, polynomial_bytes(setup));
    unsigned taps = used_taps(c, setup->members);
    uint16_t ticks = (uint16_t)step_period_rounded(period_ticks(setup));
    if (s->taps != taps || s->loops != setup->members || s->ticks != ticks)
        s->mask = 0; /* there is no past of this kind */
    s->loops = setup->members;
    s->taps = (uint8_t)taps;
    s->incomplete = c->limits == POLYNOMIAL_INCOMPLETE;
    s->limits = s->incomplete ? (uint8_t)POLYNOMIAL_RECURSE : c->limits;
    s->alone = 0;
    for (unsigned i = 0; i < s->loops && c->limits == POLYNOMIAL_SCALE; i++)
        if (polynomial_forgets(c, s->loops, taps, 1u << i))
            s->alone = (uint8_t)(s->alone | 1u << i);
    s->ticks = ticks;
    take_coefficients(s, c);
    return ERR_OK;
}

/* ---- the past ---- */

/* A period ends: the v in effect in it is past. */
static void shift_past(struct polynomials *s)
{
    for (unsigned k = s->taps - 1u; k-- > 0;)
        memcpy(past_of(s, k), k ? past_of(s, k - 1) : s->v, s->loops * sizeof(num_t));
    s->tick = 0;
}

static void rest_past(struct polynomials *s, unsigned j, num_t v)
{
    for (unsigned k = 0; k + 1u < s->taps; k++)
        past_of(s, k)[j] = v;
}

/* Adds what the loops in `from` have under way for MV i. */
static num_wide_t from_past(struct polynomials *s, unsigned i, unsigned from, num_wide_t sum)
{
    for (unsigned j = 0; j < s->loops; j++)
        for (unsigned k = 1; k < s->taps && (from & (1u << j)); k++)
            sum = num_wide_add(sum, coefficient(s, i, j)[k], past_of(s, k - 1)[j]);
    return sum;
}

static bool inputs_moved(const struct polynomials *s, const struct block_io *io)
{
    for (unsigned j = 0; j < s->loops; j++)
        if ((io->members.acting & (1u << j)) && !num_eq(io->members.in[j], s->v[j]))
            return true;
    return false;
}

/* Periods end by count. But controllers with a period of their own move together after a period of rest: then a period ends there,
 * because their moves would come up to a period late otherwise. */
static void pass_time(struct polynomials *s, const struct block_io *io)
{
    bool moved = inputs_moved(s, io), rested = s->unchanged + 1u >= s->ticks;
    if (s->begun)
        s->begun = false;
    else if (s->tick + 1u >= s->ticks || (moved && rested))
        shift_past(s);
    else
        s->tick++;
    s->unchanged = moved ? 0 : (uint16_t)(rested ? s->ticks : s->unchanged + 1u);
}

/* ---- steps ---- */

static void polynomial_step(void *state, struct block_io *io)
{
    struct polynomials *s = state;
    REFLUX_ASSERT(s->loops <= LOOPS && s->taps >= 1 && s->taps <= POLYNOMIAL_TAPS);
    io->requests.raised = s->incomplete ? 1u : 0u;
    pass_time(s, io);
    for (unsigned j = 0; j < s->loops; j++) {
        s->v_before[j] = s->v[j];
        s->u_before[j] = s->u[j];
        if (io->members.acting & (1u << j))
            s->v[j] = io->members.in[j];
    }
    for (unsigned i = 0; i < s->loops; i++) {
        num_wide_t sum = num_wide_zero();
        if (!(io->members.acting & (1u << i)))
            continue;
        for (unsigned j = 0; j < s->loops; j++)
            if (io->members.acting & (1u << j))
                sum = num_wide_add(sum, coefficient(s, i, j)[0], s->v[j]);
        s->u[i] = io->members.out[i] = num_from_wide(from_past(s, i, io->members.acting, sum));
    }
}

/* The part of the move that the MV shortened most could make, 0 to 1. */
static num_t part_made(const struct polynomials *s, const struct block_io *io)
{
    num_t least = num_one();
    for (unsigned i = 0; i < s->loops; i++) {
        if (!(io->members.acting & (1u << i)) || num_eq(io->members.in[i], num_zero()))
            continue;
        num_t wanted = num_sub(s->u[i], s->u_before[i]);
        if (num_eq(wanted, num_zero()))
            return num_zero();
        num_t part = num_div(num_add(wanted, io->members.in[i]), wanted);
        least = num_min(least, num_clamp(part, num_zero(), num_one()));
    }
    return least;
}

/* Puts G of the loops that act into a, as it is at first or at rest. */
static unsigned matrix_in_force(struct polynomials *s, unsigned members, unsigned going_on,
                                uint8_t member[LOOPS], float a[LOOPS][LOOPS])
{
    REFLUX_ASSERT(s->loops <= LOOPS && s->taps <= POLYNOMIAL_TAPS);
    unsigned n = 0;
    for (unsigned k = 0; k < s->loops; k++)
        if (members & (1u << k))
            member[n++] = (uint8_t)k;
    for (unsigned i = 0; i < n; i++)
        for (unsigned j = 0; j < n; j++) {
            const num_t *g = coefficient(s, member[i], member[j]);
            a[i][j] = num_to_float(g[0]);
            for (unsigned k = 1; k < s->taps && !(going_on & (1u << member[j])); k++)
                a[i][j] += num_to_float(g[k]);
        }
    return n;
}

/* Only the loops whose MVs were limited give way, to where these MVs stand while the others ask for what they ask for. If all of v
 * were solved from what took effect, a loop at its limit would push the others a little in every tick, and they would rest
 * beside their setpoints. */
static void give_way(struct polynomials *s, const struct block_io *io, unsigned limited,
                     num_t dv[LOOPS])
{
    uint8_t member[LOOPS];
    float a[LOOPS][LOOPS], less[LOOPS], x[LOOPS] = {0};
    unsigned n = matrix_in_force(s, limited, limited, member, a);
    for (unsigned i = 0; i < n; i++)
        less[i] = num_to_float(io->members.in[member[i]]);
    if (n == 0 || !polynomial_solve(n, a, less, x))
        return; /* every part was checked with the plan */
    for (unsigned i = 0; i < n; i++)
        dv[member[i]] = num_from_float(x[i]);
}

/* Shortens the moves of all loops to the part that could be made. */
static void shorten(struct polynomials *s, const struct block_io *io, num_t dv[LOOPS])
{
    num_t left = num_sub(part_made(s, io), num_one());
    for (unsigned j = 0; j < s->loops; j++)
        dv[j] = num_mul(left, num_sub(s->v[j], s->v_before[j]));
}

static unsigned limited_loops(const struct polynomials *s, const struct block_io *io)
{
    unsigned limited = 0;
    for (unsigned i = 0; i < s->loops; i++)
        if ((io->members.acting & (1u << i)) && !num_eq(io->members.in[i], num_zero()))
            limited |= 1u << i;
    return limited;
}

/* One loop alone needs no more than its own element of G to be run backwards. */
static bool gives_way_alone(const struct polynomials *s, unsigned limited)
{
    return (limited & (limited - 1u)) == 0 && (limited & s->alone) == limited;
}

static void polynomial_back_calculate(void *state, struct block_io *io)
{
    struct polynomials *s = state;
    unsigned limited = limited_loops(s, io);
    num_t dv[LOOPS];
    for (unsigned j = 0; j < LOOPS; j++)
        dv[j] = num_zero();
    if (s->limits == POLYNOMIAL_SCALE && !gives_way_alone(s, limited))
        shorten(s, io, dv);
    else
        give_way(s, io, limited, dv);
    for (unsigned j = 0; j < s->loops; j++)
        if (io->members.acting & (1u << j)) {
            s->u[j] = num_add(s->u[j], io->members.in[j]);
            s->v[j] = num_add(s->v[j], dv[j]);
            io->members.out[j] = dv[j];
        }
}

/* ---- who comes and goes ---- */

static void polynomial_follow(void *state, struct block_io *io)
{
    struct polynomials *s = state;
    /* If the past may not be run backwards, all begin at rest where the MVs are. */
    unsigned going_on = s->limits == POLYNOMIAL_RECURSE ? io->members.going_on & s->mask : 0u;
    uint8_t member[LOOPS];
    float a[LOOPS][LOOPS], wanted[LOOPS], v[LOOPS] = {0};
    unsigned n = matrix_in_force(s, io->members.acting, going_on, member, a);
    if (!going_on)
        s->tick = 0;
    else if (!s->begun && s->tick + 1u >= s->ticks)
        shift_past(s);
    else if (!s->begun)
        s->tick++;
    s->begun = true;
    s->unchanged = 0;
    for (unsigned i = 0; i < n; i++) {
        num_t under_way = num_from_wide(from_past(s, member[i], going_on, num_wide_zero()));
        wanted[i] = num_to_float(num_sub(io->members.in[member[i]], under_way));
    }
    if (!polynomial_solve(n, a, wanted, v)) {
        io->requests.gives_up = "singular"; /* every part was checked with the plan */
        return;
    }
    for (unsigned j = 0; j < s->loops; j++)
        s->u[j] = io->members.in[j];
    for (unsigned i = 0; i < n; i++) {
        unsigned j = member[i];
        s->v[j] = io->members.out[j] = num_from_float(v[i]);
        if (!(going_on & (1u << j)))
            rest_past(s, j, s->v[j]);
    }
    s->mask = io->members.acting;
}

static const char *polynomial_describe(const void *state, size_t i, float *value)
{
    static const char *const name[LOOPS] = {"in_1", "in_2", "in_3", "in_4"};
    const struct polynomials *s = state;
    if (i > s->loops)
        return NULL;
    *value = i < s->loops ? num_to_float(s->v[i]) : (float)s->tick;
    return i < s->loops ? name[i] : "ticks";
}

const struct block_kind polynomial_kind = {
    .name = "polynomial",
    .stage = STAGE_COMPENSATE,
    .parameter = polynomial_parameters,
    .parameters = sizeof polynomial_parameters / sizeof polynomial_parameters[0],
    .settings_bytes = sizeof(struct polynomial_settings),
    .members_most = LOOPS,
    .event = polynomial_events,
    .events = sizeof polynomial_events / sizeof polynomial_events[0],
    .bytes = polynomial_bytes,
    .check = polynomial_check_settings,
    .configure = polynomial_configure,
    .step = polynomial_step,
    .back_calculate = polynomial_back_calculate,
    .follow = polynomial_follow,
    .describe = polynomial_describe,
};

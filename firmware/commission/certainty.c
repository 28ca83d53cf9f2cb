#include "commission/certainty.h"

#include "base/assertion.h"
#include "commission/analysis_structure.h"

#define DETERMINANT_SDS REAL_C(2.0) /* nearer to 0 its sign is not known */
#define SEEN_SDS        REAL_C(3.0) /* a gain nearer to 0 may not be there, or have the other sign */

static bool is_seen(const struct analysis *a, uint8_t j, uint8_t i)
{
    REFLUX_ASSERT(j < a->plant.outputs && i < a->plant.inputs);
    /* A gain that only a direction tells has no times. */
    return !(a->flags[j][i] & IDENTIFIED_NO_GAIN) &&
           real_abs(a->plant.element[j][i].gain) >= SEEN_SDS * a->plant.gain_sd[j][i] &&
           real_abs(a->plant.element[j][i].gain) > REAL_C(0.0);
}

static bool is_used(const struct analysis *a, uint8_t j, uint8_t i)
{
    REFLUX_ASSERT(j < a->plant.outputs && i < a->plant.inputs);
    return (a->certainty.used[j] & (1u << i)) != 0u;
}

/* Notes the elements that a pair, or the inner loop below one, uses. */
static void find_used(struct analysis *a)
{
    for (uint8_t k = 0; k < a->pairs.n; k++) {
        uint8_t j = a->pairs.output[k], inner = analysis_inner_of(a, k);
        uint16_t input = (uint16_t)(1u << a->pairs.input[k]);
        a->certainty.used[j] = (uint16_t)(a->certainty.used[j] | input);
        if (inner != INTERACT_NONE)
            a->certainty.used[inner] = (uint16_t)(a->certainty.used[inner] | input);
    }
}

uint16_t certainty_flags(const struct analysis *a, uint8_t j, uint8_t i)
{
    REFLUX_ASSERT(j < a->plant.outputs && i < a->plant.inputs);
    return (uint16_t)(a->flags[j][i] & CERTAINTY_OPEN_FLAGS);
}

/* A relative gain may be certain where the gain is not: if one input alone seems to move an output, and only a little. */
bool certainty_sign_is_unsure(const struct analysis *a, uint8_t k)
{
    REFLUX_ASSERT(k < a->pairs.n);
    return !is_seen(a, a->pairs.output[k], a->pairs.input[k]);
}

static void doubt_output(struct analysis *a, unsigned reason, uint8_t j)
{
    a->certainty.doubts = (uint8_t)(a->certainty.doubts | reason);
    a->certainty.ambiguous_outputs = (uint16_t)(a->certainty.ambiguous_outputs | 1u << j);
}

static void doubt_elements(struct analysis *a)
{
    for (uint8_t k = 0; k < a->pairs.n; k++)
        if (certainty_sign_is_unsure(a, k))
            doubt_output(a, DOUBT_SIGN, a->pairs.output[k]);
    for (uint8_t j = 0; j < a->plant.outputs; j++)
        for (uint8_t i = 0; i < a->plant.inputs; i++) {
            if (certainty_flags(a, j, i)) {
                doubt_output(a, DOUBT_SHAPE, j);
                a->certainty.unsettled = (uint16_t)(a->certainty.unsettled | 1u << i);
            }
        }
}

/* Any doubt makes the pairing undetermined. */
static void conclude(const struct analysis *a, enum pairing_verdict *verdict)
{
    if (a->certainty.doubts && *verdict == PAIRING_DETERMINED)
        *verdict = PAIRING_UNDETERMINED;
}

void certainty_of_gains(struct analysis *a, enum pairing_verdict *verdict)
{
    find_used(a);
    bool others =
        !a->config.last && (a->channels < a->config.confidence || a->layout.hidden_cascade);
    if (a->probability < a->config.confidence)
        a->certainty.doubts |= DOUBT_DRAWS;
    if (others)
        a->certainty.doubts |= DOUBT_CHANNELS;
    if (!others && !(a->certainty.doubts & DOUBT_DRAWS))
        a->certainty.ambiguous_outputs = 0;
    if (a->determinant < DETERMINANT_SDS)
        a->certainty.doubts |= DOUBT_DETERMINANT;
    if (a->rank < a->pairs.n)
        a->certainty.doubts |= DOUBT_RANK;
    doubt_elements(a);
    conclude(a, verdict);
}

static enum left_over left_because(const struct analysis *a, bool seen, bool used)
{
    if (!seen && !(used && a->verdict == PAIRING_DETERMINED))
        return LEFT_UNSEEN;
    return used || a->verdict != PAIRING_DETERMINED ? LEFT_NOT : LEFT_OVER;
}

enum left_over certainty_output_left(const struct analysis *a, uint8_t j)
{
    bool seen = false, used = false;
    for (uint8_t i = 0; i < a->plant.inputs; i++) {
        seen = seen || is_seen(a, j, i);
        used = used || is_used(a, j, i);
    }
    return left_because(a, seen, used);
}

enum left_over certainty_input_left(const struct analysis *a, uint8_t i)
{
    bool seen = false, used = false;
    for (uint8_t j = 0; j < a->plant.outputs; j++) {
        seen = seen || is_seen(a, j, i);
        used = used || is_used(a, j, i);
    }
    return left_because(a, seen, used);
}

#include "commission/test_inputs.h"

#include "base/assertion.h"
#include "base/error.h"
#include "commission/test_inputs_state.h"

void inputs_begin(struct test_inputs *t)
{
    t->round = 1;
}

void inputs_add(struct test_inputs *t, uint8_t output, real_t test_base)
{
    REFLUX_ASSERT(t->n < CHANNEL_MAX);
    t->input[t->n].output = output;
    t->input[t->n++].test_base = test_base;
}

void inputs_line_up_direction(struct test_inputs *t, uint8_t largest)
{
    REFLUX_ASSERT(t->n < CHANNEL_MAX && largest < t->n && !t->direction);
    t->input[t->n] = (struct tested_input){.output = t->input[largest].output,
                                           .test_base = t->input[largest].test_base};
    t->order[t->n] = t->n;
    t->turn = t->n;
    t->direction = true;
}

NOT_INLINE static struct tested_input *present(struct test_inputs *t)
{
    REFLUX_ASSERT(t->turn < inputs_slots(t) && t->order[t->turn] < inputs_slots(t));
    return &t->input[t->order[t->turn]];
}

const struct tested_input *inputs_under_test(const struct test_inputs *t)
{
    REFLUX_ASSERT(t->turn < CHANNEL_MAX && t->order[t->turn] < CHANNEL_MAX);
    return &t->input[t->order[t->turn]];
}

bool inputs_is_due(const struct test_inputs *t, uint8_t k)
{
    REFLUX_ASSERT(k < inputs_slots(t));
    return !t->input[k].skipped && (t->input[k].unsettled || !t->only_unsettled);
}

uint8_t inputs_due_from(const struct test_inputs *t, uint8_t turn)
{
    uint8_t n = 0;
    for (; turn < inputs_slots(t); turn++)
        n = (uint8_t)(n + inputs_is_due(t, t->order[turn]));
    return n;
}

bool inputs_next(struct test_inputs *t)
{
    do
        t->turn++;
    while (t->turn < inputs_slots(t) && !inputs_is_due(t, t->order[t->turn]));
    return t->turn < inputs_slots(t);
}

bool inputs_next_round(struct test_inputs *t, bool only_unsettled)
{
    t->only_unsettled = only_unsettled;
    t->round++;
    t->turn = 0;
    return inputs_is_due(t, t->order[0]);
}

void inputs_repeat(struct test_inputs *t)
{
    REFLUX_ASSERT(t->turn > 0);
    t->turn--;
    struct tested_input *in = present(t);
    in->rounds = 0;
    in->skipped = false;
}

void inputs_skip(struct test_inputs *t)
{
    present(t)->skipped = true;
}

void inputs_note_test(struct test_inputs *t, const struct test_result *result)
{
    struct tested_input *in = present(t);
    in->amplitude = result->amplitude;
    in->half_s = result->half_s;
    t->tests++;
    t->tested_s += result->took_s;
    in->cut = result->cut;
    in->small = result->small;
    inputs_raise_worst(t, result->worst);
}

void inputs_note_cut(struct test_inputs *t, uint8_t culprit, real_t predicted)
{
    struct tested_input *in = present(t);
    in->cut_by = culprit;
    in->cut_predicted = predicted;
}

void inputs_note_worst(struct test_inputs *t, real_t worst)
{
    present(t)->worst = worst;
}

void inputs_raise_worst(struct test_inputs *t, real_t worst)
{
    struct tested_input *in = present(t);
    if (worst > in->worst)
        in->worst = worst;
}

void inputs_set_amplitude(struct test_inputs *t, real_t amplitude)
{
    present(t)->amplitude = amplitude;
}

void inputs_count_round(struct test_inputs *t)
{
    present(t)->rounds++;
}

uint8_t inputs_want_longer(struct test_inputs *t, uint32_t half)
{
    struct tested_input *in = present(t);
    in->half_wanted = half;
    return ++in->longer_retries;
}

void inputs_want_half(struct test_inputs *t, uint32_t half)
{
    struct tested_input *in = present(t);
    if (half > in->half_wanted)
        in->half_wanted = half;
}

uint8_t inputs_want_linear(struct test_inputs *t, real_t amplitude)
{
    struct tested_input *in = present(t);
    in->amplitude_wanted = amplitude;
    return ++in->linear_retries;
}

uint8_t inputs_want_uncut(struct test_inputs *t, real_t amplitude)
{
    struct tested_input *in = present(t);
    in->amplitude_most = amplitude;
    return ++in->cut_retries;
}

real_t inputs_small_step(const struct test_inputs *t)
{
    real_t least = REAL_C(0.0);
    for (uint8_t k = 0; k < inputs_slots(t); k++) {
        real_t wanted = t->input[k].amplitude_wanted;
        if (wanted > REAL_C(0.0) && (!(least > REAL_C(0.0)) || wanted < least))
            least = wanted;
    }
    return least;
}

real_t inputs_mean_test_s(const struct test_inputs *t)
{
    return t->tested_s / (real_t)t->tests;
}

/* Reasons of refusals in words. */
#include "console/refusal_words.h"

#include "console/block_words.h"
#include "console/parameter_words.h"
#include "console/phrases.h"
#include "console/startup_words.h"

void config_fault_words(const struct config_fault *fault, struct text *t)
{
    if (fault->subject[0]) {
        text_char(t, '\'');
        text_str(t, fault->subject);
        text_str(t, "' ");
    }
    text_str(t, names_range(fault) ? "must be " : "");
    text_str(t, fault->wanted);
}

/* Says which settings do not fit together. */
static void config_words(const struct config_fault *fault, struct text *t)
{
    service_fault_name(fault, t);
    text_str(t, ": ");
    config_fault_words(fault, t);
    if (fault->bytes) {
        text_str(t, ", bytes needed: ");
        text_u32(t, fault->bytes);
        text_str(t, ", there are: ");
        text_u32(t, PLAN_ARENA_BYTES);
    }
}

/* Says what values the parameter takes. */
static void value_words(enum err code, const struct answer *a, struct text *t)
{
    const struct parameter *p = &a->value.parameter;
    if (block_value_words(code, a, t))
        return;
    parameter_name(p, t);
    text_str(t, ": '");
    text_str(t, parameter_is_secret(p) ? PARAMETER_SECRET : a->value.text ? a->value.text : "");
    text_str(t, code == ERR_READ_ONLY ? "' refused, " : "' refused, allowed: ");
    parameter_range_words(p, t);
}

static void range_words(const struct answer *a, struct text *t)
{
    text_float(t, a->range.value);
    text_str(t, " refused, allowed: ");
    text_float(t, a->range.lo);
    text_str(t, " .. ");
    put_amount(t, a->range.hi, a->range.unit);
}

void refusal_words(enum err code, const struct answer *a, struct text *t)
{
    switch (a->more) {
    case ANSWER_CONFIG:
        config_words(&a->config, t);
        return;
    case ANSWER_VALUE:
        value_words(code, a, t);
        return;
    default:
        break;
    }
    if (a->subject && a->subject[0]) {
        text_str(t, a->subject);
        text_str(t, ": ");
    }
    if (a->more == ANSWER_RANGE) {
        range_words(a, t);
    } else if (a->more == ANSWER_WAIT) {
        text_str(t, "wrong key: wait ");
        text_u32(t, (a->wait_ms + 999u) / 1000u);
        text_str(t, " s before the next try");
    } else if (a->more == ANSWER_PLACES) {
        text_str(t, "this board has ");
        text_u32(t, a->value.parameter.group->count);
        text_str(t, ", bytes needed for each more: ");
        text_u32(t, (uint32_t)PLAN_BUFFERS * a->value.parameter.group->stride);
    } else if (!startup_answer_words(a, t) && !block_answer_words(a, t)) {
        text_str(t, a->words ? a->words : err_text(code));
    }
}

/* Why something was refused, in words: what follows the code of an error's line. */
#include "console/console.h"

#include "exchange/tables.h"
#include "settings/parameters.h"

/* Of a configuration that does not fit together. */
static void config_words(const struct config_fault *fault, struct text *t)
{
    service_fault_name(fault, t);
    text_str(t, ": ");
    if (fault->subject[0]) {
        text_char(t, '\'');
        text_str(t, fault->subject);
        text_str(t, "' ");
    }
#if CONFIG_BLOCKS
    text_str(t, fault->must_be ? "must be " : "");
#endif
    text_str(t, fault->wanted);
    if (fault->bytes) {
        text_str(t, ", bytes needed: ");
        text_u32(t, fault->bytes);
        text_str(t, ", there are: ");
        text_u32(t, PLAN_ARENA_BYTES);
    }
}

/* Of a parameter that does not take it. */
static void value_words(enum err code, const struct answer *a, struct text *t)
{
    const struct parameter *p = &a->value.parameter;
    parameter_name(p, t);
#if CONFIG_BLOCKS
    if (code == ERR_FULL && !a->value.needed) {
        text_str(t, ": " TABLES_TAKEN);
        return;
    }
#endif
    text_str(t, ": '");
    text_str(t, parameter_is_secret(p) ? PARAMETER_SECRET : a->value.text ? a->value.text : "");
#if CONFIG_BLOCKS
    if (code == ERR_CONFLICT) {
        text_str(t, "' refused, a name stands in it twice");
        return;
    }
    if (code == ERR_FULL || code == ERR_STATE || code == ERR_UNSUPPORTED) {
        text_str(t, code == ERR_FULL    ? "' refused, bytes needed: "
                    : code == ERR_STATE ? "' refused, the block has no kind; set that first"
                                        : "' refused, this build lacks the kind of the block");
        if (code == ERR_FULL) {
            text_u32(t, a->value.needed);
            text_str(t, ", there are: ");
            text_u32(t, a->value.free);
        }
        return;
    }
#endif
    text_str(t, code == ERR_READ_ONLY ? "' refused, " : "' refused, allowed: ");
    parameter_range(p, t);
    if (parameter_unit(p)[0]) {
        text_char(t, ' ');
        text_str(t, parameter_unit(p));
    }
}

static void range_words(const struct answer *a, struct text *t)
{
    text_float(t, a->range.value);
    text_str(t, " refused, allowed: ");
    text_float(t, a->range.lo);
    text_str(t, " .. ");
    text_float(t, a->range.hi);
    text_char(t, ' ');
    text_str(t, a->range.unit);
}

void console_refusal(enum err code, const struct answer *a, struct text *t)
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
    } else if (a->more == ANSWER_PLACES) {
        text_str(t, "this board has ");
        text_u32(t, a->value.parameter.group->count);
        text_str(t, ", bytes needed for each more: ");
        text_u32(t, (uint32_t)PLAN_BUFFERS * a->value.parameter.group->stride);
#if WORKSPACE_BYTES
    } else if (a->more == ANSWER_TAKEN) {
        workspace_refusal(a->workspace, t);
#endif
#if CONFIG_BLOCKS
    } else if (a->more == ANSWER_VERBS) {
        block_verbs_words(a->kind, t);
#endif
    } else {
        text_str(t, a->words ? a->words : err_text(code));
    }
    if (a->more == ANSWER_WAIT) {
        text_str(t, "; the next try is looked at in s ");
        text_u32(t, (a->wait_ms + 999u) / 1000u);
    }
}

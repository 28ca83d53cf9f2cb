/* Parameters as lines of text. */
#include "console/parameter_words.h"

#include "console/block_words.h"
#include "console/phrases.h"

static void unit_words(const struct parameter *p, struct text *line)
{
    if (!parameter_unit(p)[0])
        return;
    put_word(line, parameter_unit(p));
}

void parameter_range_words(const struct parameter *p, struct text *t)
{
    parameter_range(p, t);
    unit_words(p, t);
}

void parameter_value_line(const struct parameter *p, const struct config *config, struct text *line)
{
    parameter_name(p, line);
    text_str(line, " = ");
    parameter_value(p, config, line);
    unit_words(p, line);
    if (p->field->type == PARAMETER_KIND && is_of_unknown_block(p, config))
        text_str(line, " unknown");
}

void parameter_set_line(const struct parameter *p, const struct config *config, struct text *line)
{
    if (is_of_unknown_block(p, config))
        text_str(line, "# ");
    text_str(line, "set ");
    parameter_name(p, line);
    text_char(line, ' ');
    parameter_value(p, config, line);
}

bool parameter_help_line(const struct parameter *p, const struct config *config, unsigned n,
                         struct text *line)
{
    switch (n) {
    case 0:
        parameter_value_line(p, config, line);
        return true;
    case 1:
        text_str(line, "  ");
        text_str(line, parameter_about(p));
        return true;
    case 2:
        text_str(line, "  allowed: ");
        parameter_range_words(p, line);
        return true;
    case 3:
        text_str(line, "  default: ");
        parameter_default(p, config, line);
        text_str(line, "  id: 0x");
        text_hex(line, parameter_id(p), parameter_id(p) >> 16 ? 8 : 4);
        return true;
    default:
        return false;
    }
}

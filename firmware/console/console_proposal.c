/* Console command `proposal`: settings that blocks propose. */
#include <string.h>

#include "console/command_table.h"
#include "console/phrases.h"
#include "console/refusal_words.h"

static void proposer(const struct client *c, uint8_t block, const char *what, struct text *line)
{
    put_block(line, block);
    const char *kind = client_settings(c)->block[block].kind;
    if (kind[0]) { /* it may be gone since */
        text_char(line, ' ');
        text_str(line, kind);
    }
    text_str(line, what);
}

static void other_value(const char *what, float value, struct text *line)
{
    text_str(line, what);
    text_float(line, value);
}

static void present_value(const struct parameter *p, const struct config *config, struct text *line)
{
    float value;
    text_str(line, "  ");
    parameter_name(p, line);
    if (p->field->type != PARAMETER_ROW) {
        text_str(line, " = ");
        parameter_value(p, config, line);
        return;
    }
    text_str(line, " value ");
    text_u32(line, p->col + 1u);
    other_value(" = ", parameter_get_number(p, config, &value) == ERR_OK ? value : 0.0f, line);
}

/* Line n of the proposal that waits. */
static void waiting_line(const struct client *c, const struct proposal_reading *r, unsigned n,
                         struct text *line)
{
    struct parameter p;
    float value;
    if (n == 0) {
        proposer(c, r->block,
                 r->at_once ? " proposes, in force as soon as settings may be changed"
                 : r->state == PROPOSAL_OFFERED ? " proposes, to be accepted or rejected"
                                                : " proposes, not checked yet",
                 line);
    } else if (operate_proposed(&c->session, n - 1u, &p, &value)) {
        present_value(&p, operate_settings(&c->session), line);
        other_value(", proposed ", value, line);
    }
}

static void back_line(const struct client *c, const struct way_back *back, unsigned n,
                      struct text *line)
{
    struct parameter p;
    const struct config *config = operate_settings(&c->session);
    if (n == 0) {
        proposer(c, back->block, " proposed what is in force, `proposal back` undoes it", line);
    } else if (operate_find_proposed(config, back->value[n - 1u].id, &p) == ERR_OK) {
        present_value(&p, config, line);
        other_value(", before ", back->value[n - 1u].value, line);
    }
}

static void refused_line(const struct client *c, const struct refused_proposal *r,
                         struct text *line)
{
    proposer(c, r->block, " refused: ", line);
    service_fault_name(&r->fault, line);
    text_char(line, ' ');
    config_fault_words(&r->fault, line);
    if (r->fault.code == ERR_RANGE && !r->fault.subject[0])
        other_value(", ", r->value, line);
}

/* Line n of the elements that are switched off while the settings do not say so yet. *lines: how many there are. */
static bool switched_off_line(const struct client *c, unsigned n, unsigned *lines,
                              struct text *line)
{
    struct parameter p;
    float value;
    uint8_t block;
    for (*lines = 0; operate_switched_off(&c->session, false, *lines, &block, &p, &value);
         (*lines)++) {
        if (*lines != n)
            continue;
        proposer(c, block, " has switched off", line);
        present_value(&p, operate_settings(&c->session), line);
        other_value(", to be ", value, line);
        return true;
    }
    return false;
}

static bool proposal_line(struct client *c, unsigned n, struct text *line)
{
    struct proposal_reading r;
    unsigned off;
    if (switched_off_line(c, n, &off, line))
        return true;
    bool any = off > 0;
    n -= off;
    if (!operate_proposal(&c->session, &r)) {
        if (n == 0 && !any)
            text_str(line, "no block has proposed anything");
        return n == 0 && !any;
    }
    if (r.state != PROPOSAL_FREE) {
        if (n <= r.values) {
            waiting_line(c, &r, n, line);
            return true;
        }
        n -= r.values + 1u;
    }
    if (r.refused && n-- == 0) {
        refused_line(c, r.refused, line);
        return true;
    }
    if (!r.back || n > r.back->n)
        return false;
    back_line(c, r.back, n, line);
    return true;
}

void command_proposal(struct client *c, unsigned n, char **word)
{
    struct answer a;
    enum err err;
    if (n == 0) {
        reply_list(c, proposal_line, "");
        return;
    }
    if (strcmp(word[0], "accept") == 0) {
        err = operate_proposal_accept(&c->session, &a);
    } else if (strcmp(word[0], "reject") == 0) {
        err = operate_proposal_reject(&c->session, &a);
    } else if (strcmp(word[0], "back") == 0) {
        err = operate_proposal_back(&c->session, &a);
    } else {
        reply_usage(c, word[0], "proposal");
        return;
    }
    reply_answer(c, err, &a);
}

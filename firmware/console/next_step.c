#include "console/next_step.h"

static bool nothing_is_configured(const struct config *config)
{
    for (unsigned i = 0; i < CHANNEL_MAX; i++)
        if (config->measurement[i].name[0] || config->mv[i].name[0])
            return false;
    return true;
}

bool next_step_line(const struct client *c, unsigned n, struct text *line)
{
    const struct service *s = c->service;
    bool connected = s->io.state(s->io.context) == IO_READY;
    if (n >= 2 || client_is_machine(c) || !nothing_is_configured(operate_view(&c->session)))
        return false;
    if (n == 0)
        text_str(line, connected ? "next: paste a .conf file, or name the plant's channels "
                                   "(`commission plant` lists them) and loops:"
                                 : "next: connect a plant; `stats` shows what comes over its link");
    else if (connected)
        text_str(line,
                 "  begin, set meas1.name NAME, ..., set loop1.pv NAME, ..., apply; then `save`");
    return true;
}

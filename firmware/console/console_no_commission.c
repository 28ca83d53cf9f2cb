/* `commission`, on a board without automatic start-up. */
#include "console/command_table.h"

void command_commission(struct client *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    reply_err(c, ERR_UNSUPPORTED, "automatic start-up is left out of this board's build");
}

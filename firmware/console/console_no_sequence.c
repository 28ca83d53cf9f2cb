/* Console command on sequences, on a board without them. */
#include "console/command_table.h"

void command_seq(struct client *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    reply_err(c, ERR_UNSUPPORTED, "sequences are left out of this board's build");
}

/* reflux-host: the firmware as a process. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "host_port.h"
#include "line.h"

static const char usage[] =
    "usage: reflux-host [--console LINE] [--link LINE] [--nvm FILE] [--boot-id N]\n"
    "                   [--watchdog on|off]\n"
    "\n"
    "The firmware as a process of this computer. LINE is one of\n"
    "  pty          a new pseudo-terminal; its name is printed\n"
    "  pty:LINK     the same, and LINK is made a symbolic link to it\n"
    "  socket:PATH  a unix socket that is listened on\n"
    "  stdio        standard input and output\n"
    "\n"
    "  --console LINE  console for people and scripts (default stdio)\n"
    "  --link LINE     plant link (default pty)\n"
    "  --nvm FILE      keep the emulated flash in FILE (default: in memory)\n"
    "  --boot-id N     number of this start, 0..4294967295 (default: from the clock)\n"
    "  --watchdog on   a firmware that hangs, or a process that is held up, for 2 s is reset\n"
    "                  (default off)\n"
    "  --help\n";

static void on_signal(int number)
{
    (void)number;
    host_port_stop();
}

static bool parse_boot_id(const char *text, uint32_t *id)
{
    char *end;
    errno = 0;
    unsigned long long x = strtoull(text, &end, 10);
    if (text[0] < '0' || text[0] > '9' || *end || errno || x > UINT32_MAX)
        return false;
    *id = (uint32_t)x;
    return true;
}

int main(int argc, char **argv)
{
    struct host_port_options options = {.console = "stdio", .link = "pty"};
    char err[256];
    options.boot_id = (uint32_t)time(NULL) ^ ((uint32_t)getpid() << 16);
    for (int i = 1; i < argc; i += 2) {
        const char *name = argv[i], *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (strcmp(name, "--help") == 0) {
            (void)fputs(usage, stdout);
            return 0;
        }
        if (strcmp(name, "--console") != 0 && strcmp(name, "--link") != 0 &&
            strcmp(name, "--nvm") != 0 && strcmp(name, "--boot-id") != 0 &&
            strcmp(name, "--watchdog") != 0) {
            (void)fprintf(stderr, "reflux-host: unknown option %s; --help lists them\n", name);
            return 2;
        }
        if (!value) {
            (void)fprintf(stderr, "reflux-host: %s wants a value; see --help\n", name);
            return 2;
        }
        if (strcmp(name, "--console") == 0)
            options.console = value;
        else if (strcmp(name, "--link") == 0)
            options.link = value;
        else if (strcmp(name, "--nvm") == 0)
            options.nvm = value;
        else if (strcmp(name, "--watchdog") == 0) {
            options.watchdog = strcmp(value, "on") == 0;
            if (!options.watchdog && strcmp(value, "off") != 0) {
                (void)fprintf(stderr, "reflux-host: --watchdog %s: must be on or off\n", value);
                return 2;
            }
        } else if (!parse_boot_id(value, &options.boot_id)) {
            (void)fprintf(stderr, "reflux-host: --boot-id %s: must be 0 .. 4294967295\n", value);
            return 2;
        }
    }
    if (!line_known(options.console, err, sizeof err) ||
        !line_known(options.link, err, sizeof err)) {
        (void)fprintf(stderr, "reflux-host: %s\n", err);
        return 2;
    }
    if (strcmp(options.console, options.link) == 0 && strcmp(options.console, "pty") != 0) {
        (void)fprintf(stderr, "reflux-host: console and link cannot both be %s\n", options.link);
        return 2;
    }
    struct sigaction action = {.sa_handler = on_signal};
    (void)sigaction(SIGINT, &action, NULL);
    (void)sigaction(SIGTERM, &action, NULL);
    (void)signal(SIGPIPE, SIG_IGN);
    if (!host_port_open(&options, err, sizeof err)) {
        (void)fprintf(stderr, "reflux-host: %s\n", err);
        host_port_close();
        return 1;
    }
    host_port_run();
    host_port_close();
    return 0;
}

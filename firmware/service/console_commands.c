/* The table of commands, and those about the board as a whole. */
#include <string.h>

#include "hal/clock.h"
#include "hal/identity.h"
#include "hal/memory_use.h"
#include "hal/nvm.h"
#include "hal/uart.h"
#include "service/console.h"
#include "service/parameters.h"

static const char *const reset_names[] = {"power-on",  "requested", "watchdog",
                                          "reset pin", "fault",     "unknown"};

static bool help_line(struct console *c, unsigned n, struct text *line)
{
    (void)c;
    if (n >= console_command_count)
        return false;
    const struct console_command *command = &console_commands[n];
    text_str(line, command->name);
    text_char(line, ' ');
    text_str(line, command->arguments);
    while (line->n < 34)
        text_char(line, ' ');
    text_char(line, ' ');
    text_str(line, command->help);
    return true;
}

static bool one_command_line(struct console *c, unsigned n, struct text *line)
{
    for (unsigned i = 0; i < console_command_count; i++)
        if (strcmp(console_commands[i].name, c->argument) == 0)
            return n == 0 && help_line(c, i, line);
    return false;
}

static void command_help(struct console *c, unsigned n, char **word)
{
    struct parameter p;
    if (n == 0) {
        console_list(c, help_line, "");
        return;
    }
    for (unsigned i = 0; i < console_command_count; i++) {
        if (strcmp(console_commands[i].name, word[0]) == 0) {
            console_list(c, one_command_line, word[0]);
            return;
        }
    }
    if (parameter_find(word[0], &p) == ERR_OK)
        console_list(c, parameter_help, word[0]);
    else
        console_err_about(c, ERR_UNKNOWN, word[0], "neither a command nor a parameter");
}

static void pair(struct text *line, const char *name, uint32_t value)
{
    text_char(line, ' ');
    text_str(line, name);
    text_char(line, ' ');
    text_u32(line, value);
}

static bool version_line(struct console *c, unsigned n, struct text *line)
{
    struct hal_nvm_geometry nvm;
    switch (n) {
    case 0:
        text_str(line, "reflux " REFLUX_VERSION " on ");
        text_str(line, hal_board_name());
        text_str(line, ", numbers " NUM_FORMAT ", plant link version ");
        text_u32(line, LINK_VERSION);
        return true;
    case 1:
        text_str(line, hal_board_text());
        return true;
    case 2:
        text_str(line, "clock");
        pair(line, "Hz", hal_core_hz());
        text_str(line, ", ");
        text_str(line, hal_clock_source());
        return true;
    case 3:
        text_str(line, "limits:");
        pair(line, "channels", CHANNEL_MAX);
        pair(line, "loops", CONFIG_LOOPS);
        pair(line, "feedforwards", CONFIG_FEEDFORWARDS);
        pair(line, "interlocks", CONFIG_INTERLOCKS);
        pair(line, "dead-time bytes", PLAN_ARENA_BYTES);
        return true;
    case 4:
        hal_nvm_get_geometry(&nvm);
        text_str(line, c->service->watchdog ? "watchdog runs" : "no watchdog");
        text_str(line, ", flash for storage, bytes: ");
        text_u32(line, nvm.sectors * nvm.sector_size);
        return true;
    case 5:
        text_str(line, "started by: ");
        text_str(line, reset_names[hal_reset_cause()]);
        pair(line, "boot", hal_boot_id());
        return true;
    default:
        return false;
    }
}

static void command_version(struct console *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    console_list(c, version_line, "");
}

static bool status_line(struct console *c, unsigned n, struct text *line)
{
    static const char *const link_names[] = {"down", "greeting", "ready"};
    const struct service *s = c->service;
    const struct plan *plan = &s->plan[s->in_force];
    if (n == 0) {
        text_str(line, s->supervisor->state == SUPERVISOR_RUN ? "state run" : "state safe");
        text_str(line, ", plant link ");
        text_str(line, link_names[s->io.state(s->io.context)]);
        if (s->io.state(s->io.context) == IO_READY) {
            text_char(line, ' ');
            text_str(line, s->link->name);
        }
        text_str(line, ", plant time ");
        text_seconds(line, s->supervisor->time_ms);
        text_str(line, " s, base tick ");
        text_float(line, plan->tick_s);
        text_str(line, " s");
        pair(line, "ticks", s->supervisor->ticks);
        if (s->staging)
            text_str(line, ", transaction open");
        return true;
    }
    n -= 1;
    if (n < CHANNEL_MAX) {
        static const char *const qualities[] = {"good", "uncertain", "bad", "missing"};
        const struct measurement_config *m = &plan->config.measurement[n];
        if (!m->name[0])
            return true;
        text_str(line, m->name);
        text_str(line, " = ");
        text_float(line, span_to_eu(s->supervisor->measurement[n].value, m->lo, m->hi));
        text_char(line, ' ');
        text_str(line, m->unit);
        text_char(line, ' ');
        text_str(line, s->supervisor->measurement[n].bound
                           ? qualities[s->supervisor->measurement[n].quality]
                           : "not announced by the plant");
        return true;
    }
    n -= CHANNEL_MAX;
    if (n < CHANNEL_MAX) {
        const struct output_config *o = &plan->config.output[n];
        if (!o->name[0])
            return true;
        text_str(line, o->name);
        text_str(line, " = ");
        text_float(line, span_to_eu(s->supervisor->output[n].applied, o->lo, o->hi));
        text_char(line, ' ');
        text_str(line, o->unit);
        if (s->supervisor->output[n].forced)
            text_str(line, " forced by interlock");
        if (s->supervisor->output[n].not_following)
            text_str(line, " not following its command");
        if (!s->supervisor->output[n].bound)
            text_str(line, " not announced by the plant");
        return true;
    }
    return false;
}

static void command_status(struct console *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    console_list(c, status_line, "");
}

static void command_log(struct console *c, unsigned n, char **word)
{
    uint32_t every = 1;
    if (n == 1 && strcmp(word[0], "off") == 0) {
        c->service->telemetry.every = 0;
        console_ok(c);
        return;
    }
    if (strcmp(word[0], "on") != 0) {
        console_err_about(c, ERR_PARSE, word[0], "wanted: log on [TICKS] or log off");
        return;
    }
    if (n == 2 && (text_parse_u32(word[1], &every) != ERR_OK || every < 1 || every > 1000000)) {
        console_err_about(c, ERR_RANGE, word[1], "ticks between rows, 1 .. 1000000, are wanted");
        return;
    }
    c->service->telemetry.every = every;
    c->header_asked = true; /* `ok` follows the header */
}

void event_line(const struct event *e, struct text *line)
{
    text_seconds(line, e->time_ms);
    text_char(line, ' ');
    text_str(line, event_level_name(event_level(e->code)));
    text_char(line, ' ');
    text_str(line, event_name(e->code));
    text_char(line, ' ');
    text_str(line, e->subject[0] ? e->subject : "-");
    text_char(line, ' ');
    text_float(line, e->value);
    text_char(line, ' ');
    text_str(line, event_text(e->code));
}

static bool history_line(struct console *c, unsigned n, struct text *line)
{
    const struct service *s = c->service;
    uint32_t kept = s->history_count < EVENT_HISTORY ? s->history_count : EVENT_HISTORY;
    if (n >= kept)
        return false;
    text_str(line, "  ");
    event_line(&s->history[(s->history_count - kept + n) % EVENT_HISTORY], line);
    return true;
}

static void command_events(struct console *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    console_list(c, history_line, "");
}

/* What is wrong now, a line each: link, measurements, interlocks, outputs. */
static bool alarm_line(struct console *c, unsigned n, struct text *line)
{
    const struct service *s = c->service;
    const struct supervisor *sup = s->supervisor;
    const struct plan *plan = &s->plan[s->in_force];
    if (n == 0) {
        if (s->io.state(s->io.context) != IO_READY)
            text_str(line, "LINK_DOWN no plant is connected");
        return true;
    }
    n -= 1;
    if (n < CHANNEL_MAX) {
        if (sup->measurement[n].alarm) {
            text_str(line, "MEASUREMENT_BAD ");
            text_str(line, plan->config.measurement[n].name);
        }
        return true;
    }
    n -= CHANNEL_MAX;
    if (n < CHANNEL_MAX) {
        if (sup->output[n].not_following) {
            text_str(line, "NOT_FOLLOWING ");
            text_str(line, plan->config.output[n].name);
        }
        return true;
    }
    n -= CHANNEL_MAX;
    if (n < CONFIG_INTERLOCKS) {
        if (sup->interlock[n].active) {
            text_str(line, "INTERLOCK_ON lock");
            text_u32(line, n + 1u);
            text_str(line, " forces ");
            text_str(line, plan->config.interlock[n].output);
        }
        return true;
    }
    return false;
}

static void command_alarm(struct console *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    console_list(c, alarm_line, "");
}

static void uart_line(struct text *line, const char *name, enum hal_uart port)
{
    struct hal_uart_stats u;
    hal_uart_get_stats(port, &u);
    text_str(line, name);
    pair(line, "received", u.received);
    pair(line, "sent", u.sent);
    pair(line, "dropped", u.rx_dropped);
    pair(line, "line_errors", u.line_errors);
}

static bool stats_line(struct console *c, unsigned n, struct text *line)
{
    const struct service *s = c->service;
    const struct tick_cost *cost = &s->cost;
    const struct plant_link *link = s->link;
    switch (n) {
    case 0:
        text_str(line, "tick");
        pair(line, "n", cost->n);
        pair(line, "min", cost->lowest);
        pair(line, "mean", cost->n ? (uint32_t)(cost->sum / cost->n) : 0);
        pair(line, "max", cost->highest);
        pair(line, "last", cost->last);
        text_str(line, " unit ");
        text_str(line, hal_cycles_unit());
        return true;
    case 1:
        text_str(line, "link");
        pair(line, "samples", link->stats.samples);
        pair(line, "commands", link->stats.commands);
        pair(line, "good", link->decoder.count.good);
        pair(line, "bad_crc", link->decoder.count.bad_crc);
        pair(line, "malformed", link->decoder.count.malformed);
        pair(line, "overlong", link->decoder.count.overlong);
        return true;
    case 2:
        text_str(line, "link");
        pair(line, "lost_frames", link->stats.lost_frames);
        pair(line, "refused", link->stats.refused);
        pair(line, "congested", link->stats.congested);
        pair(line, "silences", link->stats.silences);
        return true;
    case 3:
        uart_line(line, "console_uart", HAL_UART_CONSOLE);
        return true;
    case 4:
        uart_line(line, "link_uart", HAL_UART_LINK);
        return true;
    case 5:
        text_str(line, "console");
        pair(line, "lines", c->stats.lines);
        pair(line, "errors", c->stats.errors);
        pair(line, "dropped", c->stats.dropped);
        pair(line, "telemetry_lost", s->telemetry.lost);
        pair(line, "events_lost", s->tick_events.lost + s->main_events.lost);
        return true;
    case 6:
        text_str(line, "memory");
        pair(line, "stack_bytes", hal_stack_size());
        pair(line, "stack_unused", hal_stack_unused());
        return true;
    case 7:
        text_str(line, "board");
        pair(line, "up_ms", (uint32_t)hal_clock_ms());
        return true;
    default:
        return false;
    }
}

static void command_stats(struct console *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    console_list(c, stats_line, "");
}

static void command_reboot(struct console *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    console_ok(c);
    c->reboot = true;
}

const struct console_command console_commands[] = {
    {"help", "[COMMAND|PARAMETER]", "this list, or one command or parameter", 0, 1, command_help},
    {"version", "", "firmware, board, limits, why it started", 0, 0, command_version},
    {"status", "", "state, measurements, outputs", 0, 0, command_status},
    {"loop", "[NAME]", "all loops, or one with its insides", 0, 1, command_loop},
    {"mode", "LOOP manual|auto|cascade", "change the mode; `mode machine|human` for this console",
     1, 2, command_mode},
    {"sp", "LOOP VALUE", "setpoint, in the measurement's unit", 2, 2, command_sp},
    {"out", "LOOP|MV VALUE", "output in manual, in the output's unit", 2, 2, command_out},
    {"list", "[PREFIX|all]", "parameters in use, those beginning with PREFIX, or all", 0, 1,
     command_list},
    {"get", "NAME", "one parameter", 1, 1, command_get},
    {"set", "NAME VALUE", "change a parameter, at once or within begin ... apply", 2, 2,
     command_set},
    {"diff", "[defaults]", "what the transaction changes, or differs from the defaults", 0, 1,
     command_diff},
    {"begin", "", "open a transaction: changes wait for apply", 0, 0, command_begin},
    {"apply", "", "check the changes whole and take them at the next tick", 0, 0, command_apply},
    {"abandon", "", "close the transaction without changes", 0, 0, command_abandon},
    {"tune", "LOOP RULE GAIN DEAD LAG [LAMBDA]",
     "settings from a model (EU/EU, s, s); RULE simc, cohen-coon, cohen-coon-pid", 5, 6,
     command_tune},
    {"log", "on [TICKS] | off", "telemetry rows on this console", 1, 2, command_log},
    {"alarm", "", "what is wrong now", 0, 0, command_alarm},
    {"events", "", "the last 100 events", 0, 0, command_events},
    {"stats", "", "cost of ticks, link and console counters", 0, 0, command_stats},
    {"reboot", "", "start again in the safe state", 0, 0, command_reboot},
};
const unsigned console_command_count = sizeof console_commands / sizeof console_commands[0];

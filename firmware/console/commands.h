/* The commands, a row each: name, arguments, help, and how many words may follow the name. command_NAME() in one of
 * console_*.c runs it. A new command also gets a note in docs/reference/notes/commands.toml, for tools/reference. In the arguments
 * capital words stand for names of a kind, the others for themselves (completion.c). */
#ifndef REFLUX_CONSOLE_COMMANDS_H
#define REFLUX_CONSOLE_COMMANDS_H

#include "exchange/config.h"
#include "hal/self_check.h"

/* clang-format off */
#if CONFIG_BLOCKS
#define BLOCK_COMMANDS(ROW) \
    ROW(block, "[BLOCK] [on|off|VERB] [NUMBER]", \
        "all blocks, or one with its inner values and verbs; switch it, or run a verb", 0, 3) \
    ROW(proposal, "[accept|reject|back]", \
        "settings that a block proposes; accept, reject, or restore the old ones", 0, 1)
#else
#define BLOCK_COMMANDS(ROW)
#endif
#if CONFIG_PEOPLE
#define EXIT_COMMAND(ROW) \
    ROW(exit, "", "close the engineer level; how to leave the terminal", 0, 0)
#define DIFF_WORDS "[defaults|saved]"
#define DIFF_HELP "changes of the transaction, or from defaults or saved settings"
#define START_UP_MORE "|advice|watch|watched] [LOOP|HOURS]"
#else
#define EXIT_COMMAND(ROW)
#define DIFF_WORDS "[defaults]"
#define DIFF_HELP "changes of the transaction, or from the defaults"
#define START_UP_MORE "] [LOOP]"
#endif
#if BOARD_CHECKS
#define SAVE_WORDS "[replace] [unsafe]"
#define SAVE_HELP "store the settings; replace: also over newer firmware's, unsafe: without brown-out reset"
#else
#define SAVE_WORDS "[replace]"
#define SAVE_HELP "store the settings in force; replace: also over newer firmware's"
#endif

#if CONFIG_LOOP_GUARD
#define ALARM_WORDS "[ack|shelve|release] [ALARM|all] [SECONDS]"
#define ALARM_HELP "active alarms; acknowledge, shelve for a time, or release an interlock"
#else
#define ALARM_WORDS "[ack|shelve] [ALARM|all] [SECONDS]"
#define ALARM_HELP "active alarms; acknowledge, or shelve for a time"
#endif

#define CONSOLE_COMMANDS(ROW) \
    ROW(help, "[COMMAND|PARAMETER]", "this list, or one command or parameter", 0, 1) \
    ROW(version, "", "firmware, board, limits, cause of the start", 0, 0) \
    ROW(status, "", "state, measurements, outputs", 0, 0) \
    ROW(loop, "[LOOP]", "all loops, or one with its inner values", 0, 1) \
    ROW(mode, "LOOP|machine|human [manual|auto|cascade]", \
        "change the mode; `mode machine|human` for this console", 1, 2) \
    ROW(sp, "LOOP VALUE", "setpoint, in the measurement's unit", 2, 2) \
    ROW(out, "LOOP|MV VALUE", "output in manual, in the output's unit", 2, 2) \
    BLOCK_COMMANDS(ROW) \
    ROW(list, "[PREFIX|all]", "parameters in use, those beginning with PREFIX, or all", 0, 1) \
    ROW(get, "PARAMETER", "one parameter", 1, 1) \
    ROW(set, "PARAMETER VALUE", "change a parameter, at once or within begin ... apply", 2, 2) \
    ROW(diff, DIFF_WORDS, DIFF_HELP, 0, 1) \
    ROW(begin, "", "open a transaction: changes wait for apply", 0, 0) \
    ROW(apply, "", "check the changes together, apply them at the next tick", 0, 0) \
    ROW(abandon, "", "close the transaction without changes", 0, 0) \
    ROW(save, SAVE_WORDS, SAVE_HELP, 0, 2) \
    ROW(load, "", "take the stored settings at the next tick; in a transaction, with apply", 0, 0) \
    ROW(defaults, "", "every parameter but the key to its default, like load", 0, 0) \
    ROW(dump, "", "the settings as commands that restore them", 0, 0) \
    ROW(tune, "LOOP RULE GAIN DEAD LAG [LAMBDA]", \
        "settings from a model (EU/EU, s, s); RULE simc, cohen-coon, cohen-coon-pid", 5, 6) \
    ROW(log, "on|off [TICKS]", "telemetry rows on this console", 1, 2) \
    ROW(commission, "[begin|pause|resume|skip|repeat|abort|accept|edit|reject|discard|relay|" \
        "plant|plan|model|gains|pairing|structure|proposal|trial" START_UP_MORE, \
        "automatic start-up: progress, results and requests", 0, 2) \
    ROW(alarm, ALARM_WORDS, ALARM_HELP, 0, 3) \
    ROW(seq, "[start|stop|hold|go|confirm|skip|abort|list]", \
        "progress of the sequence; start, stop, ...; list: its steps", 0, 1) \
    ROW(events, "", "the latest events and actions, also of earlier starts", 0, 0) \
    ROW(stats, "", "cost of ticks, link and console counters", 0, 0) \
    ROW(unlock, "KEY", "open the engineer level", 1, 1) \
    ROW(lock, "", "close the engineer level", 0, 0) \
    EXIT_COMMAND(ROW) \
    ROW(key, "NEW", "change the key of the engineer level; - for none", 1, 1) \
    ROW(reboot, "", "restart in the safe state", 0, 0)
/* clang-format on */

#endif

/* Restart after a reset that left the memory alone (restart.policy).
 *
 * Every tick keeps modes, setpoints and outputs in memory that survives a reset. After a reset, the safe command
 * goes out first. Then outputs return to their values, less a test signal, only if
 *     the reset was a warm one and the kept record is whole,
 *     the firmware was acting, with the very configuration that is in force now,
 *     plant time has gone on by no more than restart.limit, and not backwards,
 *     no sequence was under way,
 *     and fewer than RESTART_ATTEMPTS restarts in a row have failed to last.
 * Loops return in manual (hold), or with modes and setpoints (resume). A loop whose measurement is not usable stays
 * in manual, with the alarm of by_board.h. Interlocks that were active are active again, and end as always. Offsets of measurements are switched
 * on as they were. Otherwise the safe state stays, and events say which offsets are off again. A sequence never
 * goes on: it counts as aborted. */
#ifndef REFLUX_SUPERVISE_RESTART_H
#define REFLUX_SUPERVISE_RESTART_H

#include "supervise/restart_sequence.h"
#include "supervise/supervisor.h"

#define RESTART_ATTEMPTS 3  /* restarts in a row that did not last */
#define RESTART_LASTED   20 /* ticks after which a restart counts as having lasted */
_Static_assert(RESTART_ATTEMPTS <= 3 && CONFIG_INTERLOCKS <= 8, "as the record keeps them");

/* The record in retained memory; the firmware reads it only if its checksum is right. */
struct restart_record {
    uint32_t magic; /* identifies the format, and that of num_t */
    uint32_t crc;   /* checksum of all that follows */
    uint32_t identity;
    uint8_t acting : 1;
    uint8_t testing : 1; /* start-up was under way or its proposal waited; it does not go on */
    uint8_t attempts : 2;
    uint8_t interlocks;         /* active interlocks, a bit each */
    uint8_t mode[CONFIG_LOOPS]; /* with the alarm of by_board.h in the upper bits */
    uint64_t time_ms;
    num_t target[CONFIG_LOOPS], setpoint[CONFIG_LOOPS], v[CONFIG_LOOPS];
    num_t mv[CHANNEL_MAX];
    struct restart_sequence sequence;
};

struct restart {
    struct restart_record *record; /* NULL: the board has no such memory */
    bool pending;                  /* a record waits to be restored */
    bool damaged;                  /* there was one, and it is not whole */
    bool was_testing;              /* as the record says, when the board was reset */
    uint8_t attempts;
    uint32_t ticks; /* ticks since the start, up to RESTART_LASTED */
};

/* memory: sizeof(struct restart_record) bytes that survive a reset, or NULL. */
void restart_init(struct restart *r, void *memory, bool warm);
/* In the tick, between validation and control: restores the record, if that is due and allowed. */
void restart_try(struct restart *r, struct supervisor *s);
/* At the end of the tick, or of a turn without a plant: writes the record. */
void restart_keep(struct restart *r, const struct supervisor *s);

#endif

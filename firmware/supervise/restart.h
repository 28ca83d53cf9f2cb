/* What happens after a reset that left the memory alone (restart.policy).
 *
 * Every tick keeps modes, setpoints and outputs in memory that survives a reset. After one, the safe command
 * goes out first. Then, and only when
 *     the reset was a warm one and what was kept is whole,
 *     the firmware was acting, with the very configuration that is in force now, and
 *     plant time has gone on by no more than restart.limit, and not backwards,
 *     no sequence was under way,
 *     and this is not the fourth time in a row that it did not last,
 * outputs return to where they were, less a test signal: in manual (hold), or with modes and setpoints (resume). A loop whose
 * measurement is not usable stays in manual; interlocks that were active are so again, and end as always; offsets of measurements are switched on as they were. Otherwise the
 * safe state stays, and events say which offsets are off again. A sequence never goes on: it counts as aborted.
 */
#ifndef REFLUX_SUPERVISE_RESTART_H
#define REFLUX_SUPERVISE_RESTART_H

#include "supervise/restart_sequence.h"
#include "supervise/supervisor.h"

#define RESTART_ATTEMPTS 3  /* resets in a row, each soon after the one before */
#define RESTART_LASTED   20 /* ticks after which a restart counts as having lasted */
_Static_assert(RESTART_ATTEMPTS <= 3 && CONFIG_INTERLOCKS <= 8, "as the record keeps them");

/* In retained memory; looked at only when its checksum is right. */
struct restart_record {
    uint32_t magic; /* format, and that of num_t */
    uint32_t crc;   /* of all that follows */
    uint32_t identity;
    uint8_t acting : 1;
    uint8_t testing : 1; /* automatic start-up was under way: it does not go on */
    uint8_t attempts : 2;
    uint8_t interlocks; /* active, a bit for each */
    uint8_t mode[CONFIG_LOOPS];
    uint64_t time_ms;
    num_t target[CONFIG_LOOPS], setpoint[CONFIG_LOOPS], v[CONFIG_LOOPS];
    num_t mv[CHANNEL_MAX];
    struct restart_sequence sequence;
};

struct restart {
    struct restart_record *record; /* NULL: the board has no such memory */
    bool pending;                  /* there is something to return to */
    bool was_testing;              /* when the board was reset */
    uint8_t attempts;
    uint32_t ticks; /* since start, up to RESTART_LASTED */
};

/* memory: sizeof(struct restart_record) that survives a reset, or NULL. */
void restart_init(struct restart *r, void *memory, bool warm);
/* In the tick, between validation and control. */
void restart_try(struct restart *r, struct supervisor *s);
/* At the end of the tick, or of a turn without a plant. */
void restart_keep(struct restart *r, const struct supervisor *s);

#endif

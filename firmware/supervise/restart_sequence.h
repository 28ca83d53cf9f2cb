/* The part of the restart's record about sequences, and about the measurement offsets that they have switched on.
 * Within supervise only. */
#ifndef REFLUX_SUPERVISE_RESTART_SEQUENCE_H
#define REFLUX_SUPERVISE_RESTART_SEQUENCE_H

#include "exchange/state.h"

#if CONFIG_STEPS
struct restart_sequence {
    uint16_t offsets; /* offsets that are switched on, a bit for each measurement */
    uint8_t kind;     /* enum sequence_kind under way; SEQUENCE_NONE = none */
    uint8_t step;
};

/* Return true if a sequence was under way; true if offsets were on. */
bool restart_in_sequence(const struct restart_sequence *kept);
bool restart_with_offsets(const struct restart_sequence *kept);
/* Report with events that the sequence does not go on, and that the offsets are off again. same: the configuration
 * is the same, so the names are known. */
void restart_tell_interrupted(struct supervisor *s, const struct restart_sequence *kept);
void restart_offsets_gone(struct supervisor *s, const struct restart_sequence *kept, bool same);
/* Switches the offsets on again. */
void restart_offsets_back(struct supervisor *s, const struct restart_sequence *kept);
void restart_keep_sequence(struct restart_sequence *kept, const struct supervisor *s);
#else
struct restart_sequence {
};
#define restart_in_sequence(kept)           ((void)(kept), false)
#define restart_with_offsets(kept)          false
#define restart_tell_interrupted(s, kept)   ((void)0)
#define restart_offsets_gone(s, kept, same) ((void)0)
#define restart_offsets_back(s, kept)       ((void)0)
#define restart_keep_sequence(kept, s)      ((void)0)
#endif

#endif

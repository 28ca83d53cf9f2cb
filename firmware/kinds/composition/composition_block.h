/* The kind `composition` as its files share it. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_BLOCK_H
#define REFLUX_COMPOSITION_COMPOSITION_BLOCK_H

#include "base/channel.h"
#include "kinds/composition/composition.h"
#include "kinds/composition/composition_analysis.h"
#include "kinds/composition/composition_filter.h"

#if CONFIG_BLOCKS

#define COMPOSITION_PARAMETER_ROWS 36
extern const struct block_parameter composition_parameter_rows[COMPOSITION_PARAMETER_ROWS];

enum {
    EVENT_LOST,
    EVENT_ALONE,
    EVENT_PULL,
    EVENT_NIS,
    EVENT_APART,
    EVENT_NO_STATE,
    EVENT_NO_INPUT,
    EVENT_NO_BOIL,
    COMPOSITION_EVENTS
};

/* What is asked of the background. */
enum composition_work { WORK_NONE, WORK_SETTLE, WORK_GAINS };

struct composition_span {
    float lo, hi; /* EU */
};

/* The state of a block. Behind it stand the gains of complete innovation and the factors of a linear model. */
struct composition_block {
    struct composition c;
    struct composition_settings s;
    struct composition_span input[BLOCK_INPUTS_MAX], point[BLOCK_POINTS_MAX];
    const struct column_record *record; /* of the table */
    uint32_t checksum;                  /* of it */
    struct composition_analysis analysis[ANALYSES_MAX];
    struct composition_filter filter;
    real_t taken[ANALYSES_MAX]; /* of analyses that the job works in: by how much they were off */
    uint8_t work;               /* enum composition_work, while it is wanted */
    uint8_t analyses;
    uint8_t inputs, points;
    uint8_t missing;   /* number of the first input but temperatures that is, or 0 */
    bool begun;        /* it has had a tick */
    bool seen;         /* a temperature that moves, since then */
    bool settle;       /* asked for */
    uint16_t settling; /* steps of it */
    uint32_t without;  /* steps in a row without any temperature that moves, or vapour; saturates */
    uint32_t steps;    /* towards being settled; back in steps that see nothing */
    uint32_t dry;      /* steps that there has to be vapour before it counts as there */
};

MUST_CHECK enum err composition_check(const struct block_setup *setup, struct block_fault *fault);
bool composition_is_sensor(const struct composition_settings *s, unsigned k);
/* Standard deviation of the feed's flow, part of it; 0: it is taken as right. */
real_t composition_feed_f(const struct composition_settings *s, unsigned inputs);
/* How many extras these settings have with so many inputs and m mole fractions of a stage. */
size_t composition_extras(const struct composition_settings *s, unsigned inputs, size_t m);
/* [sensors][composition_moved()] */
real_t *composition_gain_memory(struct composition_block *b);
/* Everything but the column and the past. */
/* keep: sensors are those that there were, and keep their past. */
void composition_take_settings(struct composition *c, const struct block_setup *setup, bool keep);
/* The extra that is the offset of the model at the place of analysis i; NULL: there is none. */
real_t *composition_offset(struct composition_block *b, unsigned i);
/* Whether it has had the time to find its plant. */
bool composition_is_locked_on(const struct composition_block *b);
/* After each step: what was not seen for a while is found again as slowly as it was lost. */
void composition_count_step(struct composition_block *b, bool failed);
/* Whether a temperature moves anything in this step; remembered. */
bool composition_is_drawn(struct composition_block *b);
/* Whether nothing in the section of a point moves the model or is compared by an analysis. */
bool composition_point_is_unseen(const struct composition_block *b, unsigned k);
/* value 0: it does not hold. */
void composition_raise(struct block_io *io, unsigned event, unsigned value);
/* Events, and how good the estimates are. err: of the step. */
enum quality composition_judge(struct composition_block *b, struct block_io *io, enum err err);
/* Complete innovation: standard deviation of a point, with what innovations say of the covariances and what the model is off by for good. */
real_t composition_point_sd(const struct composition_block *b, unsigned k);
/* It is too large. */
bool composition_point_is_unsure(const struct composition_block *b, unsigned k);
const char *composition_describe(const void *state, size_t i, float *value);

#endif
#endif

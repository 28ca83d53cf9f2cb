/* The state of a block of the kind `composition`, allocated here. For composition_kind.c alone, and for tests. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_BLOCK_H
#define REFLUX_COMPOSITION_COMPOSITION_BLOCK_H

#include "kinds/column/column.h"
#include "kinds/composition/composition_analysis_state.h"
#include "kinds/composition/composition_filter_state.h"
#include "kinds/composition/composition_judge_state.h"
#include "kinds/composition/composition_model_state.h"
#include "kinds/composition/composition_sensors_state.h"
#include "kinds/composition/composition_watch_state.h"

#if CONFIG_BLOCKS

/* Work of the main loop. */
enum composition_work { WORK_NONE, WORK_SETTLE, WORK_GAINS };

/* Span of a signal, EU. */
struct composition_span {
    float lo, hi;
};

/* Behind it stand the gains of complete innovation and the numbers of a linear model. */
struct composition_block {
    struct composition_model model;
    struct composition_sensors sensors;
    struct composition_watch watch;
    struct composition_settings s;
    struct composition_span input[BLOCK_INPUTS_MAX], point[BLOCK_POINTS_MAX];
    const struct column_record *record; /* with the table */
    uint32_t checksum;                  /* of the table */
    struct composition_analyses analyses;
    struct composition_filter filter;
    struct composition_judge judge;
    uint8_t work; /* enum composition_work, while it is asked for */
    uint8_t inputs, points;
    bool begun;        /* there has been a tick */
    bool settle;       /* the operator has asked for it */
    uint16_t settling; /* steps of it */
};

#endif
#endif

/* The record of an experiment: of the measurements one reading in a control interval, of the MVs the mean of what took effect in each sample, both
 * as fractions of span about the operating point. The same rows go into recursive estimators of low orders as they come, to show how it gets on. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_RECORD_H
#define REFLUX_EXPERIMENT_EXPERIMENT_RECORD_H

#include "identify/arx.h"
#include "kinds/experiment/experiment_context.h"
#include "kinds/experiment/experiment_stage.h"

/* In the block. */
struct experiment_record;
/* In the workspace, with its rows and estimators behind it. */
struct experiment_rows;

/* Bytes of rows and estimators. */
uint32_t experiment_rows_bytes(unsigned n, uint32_t samples);
/* The rows are empty. memory: of these bytes. */
void experiment_rows_begin(struct experiment_rows *rows, const struct experiment_context *c,
                           void *memory);
/* The rows as data to identify from. */
struct arx_data experiment_rows_data(const struct experiment_rows *rows,
                                     const struct experiment_context *c);

/* No reading was missed yet. */
void experiment_record_start(struct experiment_record *r);
/* A stage begins. */
void experiment_record_stage(struct experiment_record *r);
/* Takes the readings of a tick. excites: a measurement may not leave its band. Returns why the experiment must end, *at_fault the input of the
 * block, from 1 on; or REASON_NONE. */
enum experiment_reason experiment_read(struct experiment_record *r,
                                       const struct experiment_context *c,
                                       const struct block_io *io, bool excites, uint8_t *at_fault);

/* The rest, and a tick of it. Returns true when it is over; *at_fault is the input that was not at rest, left alone where all were. */
void experiment_settling_begin(struct experiment_record *r, const struct experiment_context *c);
bool experiment_settle(struct experiment_record *r, const struct experiment_context *c,
                       const struct block_io *io, uint8_t *at_fault);

/* The signal, and a tick with it. Returns true when the record is whole. */
void experiment_signal_begin(struct experiment_record *r, const struct experiment_context *c);
bool experiment_record_tick(struct experiment_record *r, const struct experiment_context *c,
                            struct experiment_rows *rows, const struct block_io *io);
/* Returns true when it has asked for the signal. */
bool experiment_ask_signal(const struct experiment_record *r, const struct experiment_context *c,
                           struct block_io *io);

/* Samples of this stage. */
uint32_t experiment_record_samples(const struct experiment_record *r);
/* Part of the movement of MV j that the signal has not made. */
real_t experiment_others(const struct experiment_record *r, unsigned j);
/* Error of the recursive estimate of output i, % of the measurement's span. */
float experiment_live_error(const struct experiment_record *r, unsigned i);
/* Its gain at rest, EU per EU. */
float experiment_live_gain(const struct experiment_rows *rows, const struct experiment_context *c,
                           unsigned i, unsigned j);

#endif

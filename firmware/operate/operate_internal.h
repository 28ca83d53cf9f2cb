/* Functions that the files of operate.h share. */
#ifndef REFLUX_OPERATE_OPERATE_INTERNAL_H
#define REFLUX_OPERATE_OPERATE_INTERNAL_H

#include "exchange/tables.h"
#include "operate/operate.h"

#define QUEUE_FULL   "the request queue is full, try again"
#define NO_SUCH_LOOP "no such loop; `loop` lists them"
#define OPEN_ALREADY "a transaction is open already: apply or abandon it"

/* Puts subject and words into *answer; returns the code. */
MUST_CHECK enum err operate_refuse(struct answer *answer, enum err code, const char *subject,
                                   const char *words);
/* The same where a value is out of a range. */
MUST_CHECK enum err operate_refuse_range(struct answer *answer, const char *subject, float value,
                                         float lo, float hi, const char *unit);
/* Writes an action of this client into the history. */
void operate_record(const struct session *session, enum event_code code, const char *subject,
                    float value);
/* Queues it for the next tick. */
MUST_CHECK enum err operate_request(struct session *session, const struct request *request,
                                    struct answer *answer);
/* Returns the settings that a client may write: the open transaction, which is its own, or else a copy of those that apply to a request
 * made now. NULL: another client needs that place; ERR_BUSY. */
struct config *operate_stage(struct session *session, struct answer *answer);
/* No client has a transaction open, nothing is being saved or half printed, no sequence is under way: the main loop may
 * change settings of its own accord. */
bool operate_settings_are_free(const struct service *s);
/* The same, and no start-up is under way. */
bool operate_may_change_settings(const struct operate *door);

/* ---- what a board may lack ---- */

#if CONFIG_PEOPLE
/* Returns "loop2.gain" in *full, CHANNEL_NAME_SIZE characters, for a parameter that a client may have called "bottom.gain". */
static inline const char *operate_full_name(const struct parameter *p, const char *name, char *full)
{
    struct text t = text_on(full, CHANNEL_NAME_SIZE);
    (void)name;
    parameter_name(p, &t);
    return full;
}
#else
static inline const char *operate_full_name(const struct parameter *p, const char *name, char *full)
{
    (void)p;
    (void)full;
    return name;
}
#endif

#if CONFIG_BLOCKS
/* Tells that the open transaction, if there is one, has come into force, or is abandoned. */
void operate_transaction_over(struct operate *door, bool applied);
/* After ERR_FULL: how many bytes a block's settings need, and how many are free; both 0 where a table has no place. Returns ERR_FULL. */
MUST_CHECK enum err operate_block_figures(const struct parameter *p, struct config *staged,
                                          const char *text, struct answer *answer);
#else
static inline void operate_transaction_over(struct operate *door, bool applied)
{
    (void)applied;
    door->service->staging = false;
}
MUST_CHECK static inline enum err operate_block_figures(const struct parameter *p,
                                                        struct config *staged, const char *text,
                                                        struct answer *answer)
{
    (void)p;
    (void)staged;
    (void)text;
    (void)answer;
    return ERR_FULL;
}
#endif

#if COMMISSION_CHANNELS
/* The settings that a failed trial goes back to; NULL: no trial is running. */
static inline const struct config *operate_settings_before_trial(const struct service *s)
{
    return operate_start_up_on_trial(s) ? commission_old(s->commission) : NULL;
}
#else
static inline const struct config *operate_settings_before_trial(const struct service *s)
{
    (void)s;
    return NULL;
}
#endif

#if CONFIG_BLOCKS
/* Before settings are written without operate_stage(): keeps tables that start-up may go back to from being given to others. */
static inline void operate_watch_tables(const struct service *s)
{
    tables_watch(TABLES_TO_GO_BACK_TO, operate_settings_before_trial(s));
}
#else
static inline void operate_watch_tables(const struct service *s)
{
    (void)s;
}
#endif

#if CONFIG_STEPS
static inline bool operate_sequence_runs(const struct service *s)
{
    return sequence_active(&s->supervisor->sequence);
}
#else
static inline bool operate_sequence_runs(const struct service *s)
{
    (void)s;
    return false;
}
#endif

#if CONFIG_LOOP_GUARD
/* ERR_STATE where another configuration changes of a loop that acts its action, its PV or its MV, or their units, spans or calibration. */
MUST_CHECK enum err operate_keep_acting_loops(const struct service *s, const struct config *next,
                                              struct config_fault *fault);
#else
MUST_CHECK static inline enum err operate_keep_acting_loops(const struct service *s,
                                                            const struct config *next,
                                                            struct config_fault *fault)
{
    (void)s;
    (void)next;
    (void)fault;
    return ERR_OK;
}
#endif

/* ---- proposals of blocks ---- */

/* Checksum of all that the ids and values of a proposal go by: loops, elements and blocks by their places, and what fractions
 * are of. */
uint32_t proposed_shape(const struct config *c);
/* One value of that block into *config; *old gets what was there. */
MUST_CHECK enum err proposed_write(struct config *config, uint8_t block,
                                   const struct proposed_value *v, float *old,
                                   struct config_fault *fault);
/* n of them; *back, which may be NULL, gets the way back. *at: the one that is refused. */
MUST_CHECK enum err proposed_write_all(struct config *config, uint8_t block,
                                       const struct proposed_value *v, uint8_t n,
                                       struct way_back *back, uint8_t *at,
                                       struct config_fault *fault);
/* The staged settings, which have the values v, go into force, and the way back is kept. Nothing happens where they change nothing.
 * Errors as service_apply(). */
MUST_CHECK enum err proposed_adopt(struct operate *door, const struct proposed_value *v,
                                   const struct way_back *back, struct config_fault *fault);
/* Refuses a proposal for a reason that is none of its values. */
MUST_CHECK enum err proposed_refuse_whole(struct config_fault *fault, enum err code, uint8_t block,
                                          const char *wanted);
/* Keeps what was wrong with a proposal of a block, until the next is refused. */
void operate_keep_refusal(struct operate *door, uint8_t block, float value,
                          const struct config_fault *fault);
/* Once a turn, as operate_poll_proposals(). */
bool operate_poll_switch_offs(struct operate *door);

/* ---- settings into force ---- */

/* Puts the staged settings into force. */
MUST_CHECK enum err operate_activate(struct session *session, struct answer *answer);
/* The same, unless a transaction is open: then they wait for operate_apply(). */
MUST_CHECK enum err operate_activate_unless_open(struct session *session, struct answer *answer);

#endif

/* Texts on blocks (blockN). On a board without blocks every function is empty. */
#ifndef REFLUX_CONSOLE_BLOCK_WORDS_H
#define REFLUX_CONSOLE_BLOCK_WORDS_H

#include "operate/operate.h"

#if CONFIG_BLOCKS

/* Lines that `alarm` has for blocks: of each block that it has given up, then the events of its kind. */
#define BLOCK_ALARM_LINES (CONFIG_BLOCKS * (BLOCK_EVENTS_MAX + 1u))
void block_alarm_line(const struct session *session, unsigned n, struct text *line);
/* Writes ": the model has left the plant", the words of the kind for an event of a block, or why a proposal was refused. Writes nothing where
 * this build lacks the kind. */
void block_event_words(const struct event *e, struct text *line);

/* The text names a range. */
static inline bool names_range(const struct config_fault *fault)
{
    return fault->must_be;
}
/* Says why a parameter of a block does not take a value. False: the reason is one that every parameter has, and nothing is written. */
bool block_value_words(enum err code, const struct answer *a, struct text *t);
/* "its kind has no such verb, but: freeze tune", for ANSWER_VERBS. False: the answer is another. */
bool block_answer_words(const struct answer *a, struct text *t);

/* Puts the n-th choice for a word that stands for a block, a verb of block `name` or a kind into *word. Returns how many choices there are;
 * 0 also for other words. */
unsigned block_choice(const struct session *session, const char *word_kind, size_t size,
                      const char *name, unsigned n, struct text *word);
unsigned block_kind_choice(const struct parameter *p, unsigned n, struct text *word);

/* The block of this parameter has a kind that this build lacks. */
bool is_of_unknown_block(const struct parameter *p, const struct config *config);
/* The parameter is one of a block; the block has a kind. */
static inline bool is_in_block(const struct parameter *p)
{
    return p->group == &parameter_blocks;
}
static inline bool block_has_kind(const struct parameter *p, const struct config *config)
{
    return config->block[p->index].kind[0] != '\0';
}
/* The parameter is a row of a table, but not the first. */
static inline bool is_further_row(const struct parameter *p)
{
    return p->row > 0;
}
/* " block", behind the names of the other groups. */
void block_group_name(struct text *t);
/* "# switched off meanwhile: ff1.gain", the elements that blocks switched off while the transaction was open. False: none. */
bool switched_off_words(const struct session *session, struct text *t);

#else
#define BLOCK_ALARM_LINES 0u
static inline void block_alarm_line(const struct session *session, unsigned n, struct text *line)
{
    (void)session;
    (void)n;
    (void)line;
}
static inline void block_event_words(const struct event *e, struct text *line)
{
    (void)e;
    (void)line;
}
static inline bool names_range(const struct config_fault *fault)
{
    (void)fault;
    return false;
}
static inline bool block_value_words(enum err code, const struct answer *a, struct text *t)
{
    (void)code;
    (void)a;
    (void)t;
    return false;
}
static inline bool block_answer_words(const struct answer *a, struct text *t)
{
    (void)a;
    (void)t;
    return false;
}
static inline unsigned block_choice(const struct session *session, const char *word_kind,
                                    size_t size, const char *name, unsigned n, struct text *word)
{
    (void)session;
    (void)word_kind;
    (void)size;
    (void)name;
    (void)n;
    (void)word;
    return 0;
}
static inline unsigned block_kind_choice(const struct parameter *p, unsigned n, struct text *word)
{
    (void)p;
    (void)n;
    (void)word;
    return 0;
}
static inline bool is_of_unknown_block(const struct parameter *p, const struct config *config)
{
    (void)p;
    (void)config;
    return false;
}
static inline bool is_in_block(const struct parameter *p)
{
    (void)p;
    return false;
}
static inline bool block_has_kind(const struct parameter *p, const struct config *config)
{
    (void)p;
    (void)config;
    return false;
}
static inline bool is_further_row(const struct parameter *p)
{
    (void)p;
    return false;
}
static inline void block_group_name(struct text *t)
{
    (void)t;
}
static inline bool switched_off_words(const struct session *session, struct text *t)
{
    (void)session;
    (void)t;
    return false;
}
#endif

#endif

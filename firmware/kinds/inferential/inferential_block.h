/* Parts of the kind `inferential` that its files share. */
#ifndef REFLUX_INFERENTIAL_INFERENTIAL_BLOCK_H
#define REFLUX_INFERENTIAL_INFERENTIAL_BLOCK_H

#include "kinds/inferential/inferential.h"

#if CONFIG_BLOCKS

#define INFERENTIAL_PARAMETER_ROWS 20
#define INFERENTIAL_NONE           0xFFu
#define INFERENTIAL_INNER          15

struct inferential_block {
    uint8_t loops, seconds;            /* secondary temperatures among the inputs, the first ones */
    uint8_t second[INFERENTIAL_LOOPS]; /* which of them, INFERENTIAL_NONE: none */
    uint8_t acted;                     /* bit k: loop k acted in the last step */
    uint8_t alone[INFERENTIAL_LOOPS];  /* steps in a row without the secondary that its law has */
    uint8_t equal[INFERENTIAL_LOOPS];  /* steps in a row in which both temperatures were equal */
    uint8_t begun;                     /* bit k: loop k has followed */
    float lo[INFERENTIAL_LOOPS][2];    /* of the temperatures, EU */
    struct inferential loop[INFERENTIAL_LOOPS];
};

extern const struct block_parameter inferential_parameter_rows[INFERENTIAL_PARAMETER_ROWS];

enum err inferential_check(const struct block_setup *setup, struct block_fault *fault);

/* Settings of loop k that check() accepts. */
void inferential_config_of(const struct block_setup *setup, unsigned k,
                           struct inferential_config *out);

/* Which of the inputs is the secondary temperature of loop k, or INFERENTIAL_NONE. */
unsigned inferential_second(const struct block_setup *setup, unsigned k);

const char *inferential_describe(const void *state, size_t i, float *value);

#endif
#endif

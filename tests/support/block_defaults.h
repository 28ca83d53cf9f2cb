/* Settings of a block of any kind as they begin: every value of every parameter at its default. */
#ifndef REFLUX_TESTS_BLOCK_DEFAULTS_H
#define REFLUX_TESTS_BLOCK_DEFAULTS_H

#include <string.h>

#include "block/block.h"

/* settings: the struct that the kind's parameters fill; i: of the values of a table, row by row. */
static inline void block_put_value(void *settings, const struct block_parameter *p, unsigned i,
                                   float value)
{
    char *at = (char *)settings + p->offset;
    if (p->type == BLOCK_FLOAT)
        memcpy(at + i * sizeof(float), &value, sizeof value);
    else if (p->type == BLOCK_U16)
        memcpy(at + i * sizeof(uint16_t), &(uint16_t){(uint16_t)value}, sizeof(uint16_t));
    else
        ((uint8_t *)at)[i] = (uint8_t)value;
}

static inline void block_put_defaults(void *settings, const struct block_kind *kind)
{
    memset(settings, 0, kind->settings_bytes);
    for (unsigned k = 0; k < kind->parameters; k++) {
        const struct block_parameter *p = &kind->parameter[k];
        for (unsigned i = 0; i < (unsigned)p->rows * p->cols; i++)
            block_put_value(settings, p, i, p->initial);
    }
}

#endif

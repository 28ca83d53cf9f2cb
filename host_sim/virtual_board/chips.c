/* The one list of chips: another chip is a row here and a file of its own.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <string.h>
#include <strings.h>

#include "chip.h"

static const struct chip *const chips[] = {&chip_stm32f405, &chip_stm32f100};

const struct chip *chip_named_in(const char *text)
{
    for (; *text != '\0'; text++)
        for (size_t i = 0; i < sizeof(chips) / sizeof(chips[0]); i++)
            if (strncasecmp(text, chips[i]->name, strlen(chips[i]->name)) == 0)
                return chips[i];
    return NULL;
}

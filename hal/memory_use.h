/* Bytes of the stack that were never touched, for `version` and the acceptance tests. */
#ifndef REFLUX_HAL_MEMORY_USE_H
#define REFLUX_HAL_MEMORY_USE_H

#include <stdint.h>

/* Bytes set aside for the stack, all contexts together; 0 where the operating system manages it. */
uint32_t hal_stack_size(void);

/* Bytes of it that nothing has written since start; 0 where hal_stack_size() is 0. Takes longer the more
 * there are: for the console, not for the tick. */
uint32_t hal_stack_unused(void);

#endif

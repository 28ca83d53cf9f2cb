/* Functions of a board that a process has no hardware for: for the ports that run in one, the host's and the one in memory. */
#include "hal/clock.h"
#include "hal/identity.h"
#include "hal/image.h"
#include "hal/memory_use.h"
#include "hal/self_check.h"

#include <stddef.h>
#include <string.h>

#include "base/workspace.h"
#include "hal/workspace.h"

void *hal_workspace(void)
{
    static _Alignas(max_align_t) uint8_t memory[WORKSPACE_BYTES];
    return memset(memory, 0, sizeof memory);
}

uint32_t hal_core_hz(void)
{
    return 0;
}

uint32_t hal_stack_size(void)
{
    return 0;
}

uint32_t hal_stack_unused(void)
{
    return 0;
}

uint32_t hal_image_bytes(void)
{
    return 0;
}

uint32_t hal_image_crc(void)
{
    return 0;
}

const char *hal_supply_text(void)
{
    return "not watched";
}

const char *hal_protection_text(enum hal_protection what)
{
    (void)what;
    return NULL;
}

uint32_t hal_ram_failed_at(void)
{
    return 0;
}
